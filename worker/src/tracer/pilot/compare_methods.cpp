#include "tracer/pilot/compare_methods.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <tuple>

#include "math/functions.h"

namespace nocturne {
namespace {

/// Of a forward photon's ray with its connection to the camera and its place on the film, and of a
/// guided photon's, which looks up learned light and asks its cells, in rays of others: measured,
/// docs/decisions/0062 and 0104.
constexpr double kForwardCost = 1.5, kGuideCost = 1.1;
/// Standard errors of the logarithm of an error by which it may be estimated too small: with 0.2 to
/// 1 of them pilots chose as well (docs/decisions/0130).
constexpr double kCaution = 0.5;
/// Standard errors by which photons from the sensor alone must be better than those from both ends.
constexpr double kSurely = 3.0;
/// Ratios of forward photons that may be chosen, and the part of the time that each kind keeps at
/// least.
constexpr double kLeastRatio = 1.0 / 16, kMostRatio = 64.0, kLeastTime = 1.0 / 16;

double cost_of_ray(const PhotonKind& kind) {
  return (kind.from == PhotonKind::kLuminaires ? kForwardCost : 1.0) *
         (kind.guided ? kGuideCost : 1.0);
}

template <class F>
void for_each_kind(const PilotMethod& method, const F& f) {
  if (method.sensor) f(*method.sensor);
  if (method.luminaires) f(*method.luminaires);
}

/// Photons from the sensor alone look better than they are where they met too little of the rare
/// light.
void prefer_both_ends(std::vector<MethodFigures>& methods) {
  const MethodFigures& best = *std::ranges::min_element(methods, {}, [](const auto& each) {
    const bool from_both = each.comparable() && each.method.luminaires;
    return from_both ? each.merit() : std::numeric_limits<double>::infinity();
  });
  if (!best.comparable() || !best.method.luminaires) return;
  const GroupErrors errors = best.errors_of_groups();
  for (MethodFigures& each : methods) {
    if (each.method.luminaires) continue;
    const double error = error_of_log_ratio(each.errors_of_groups(), errors);
    each.handicap = std::min(kWorthIt, math::exp(kSurely * error));
  }
}

/// All that a method brings, of each image that all its kinds have.
std::vector<double> means_of_method(const PilotMethod& method, const ImagesOfKind& images) {
  std::vector<double> sum;
  for_each_kind(method, [&](const PhotonKind& kind) {
    const std::vector<double> means = means_of_images(images(kind));
    if (sum.empty()) sum.resize(means.size());
    sum.resize(std::min(sum.size(), means.size()));
    for (std::size_t i = 0; i < sum.size(); ++i) sum[i] += means[i];
  });
  return sum;
}

/// Y around each pixel, of all methods, weighted by how certain their means are.
std::vector<double> reference_light(const std::vector<MethodFigures>& methods,
                                    const ImagesOfKind& images) {
  double least = std::numeric_limits<double>::infinity();
  for (const MethodFigures& each : methods) {
    if (each.comparable() && each.mean.error > 0.0) least = std::min(least, each.mean.error);
  }
  std::vector<double> light;
  double weights = 0.0;
  for (const MethodFigures& each : methods) {
    if (!each.comparable()) continue;
    const double certain = each.mean.error > 0.0 ? least / each.mean.error : 1.0;
    weights += certain * certain;
    for_each_kind(each.method, [&](const PhotonKind& kind) {
      const std::vector<PixelLight> of_kind = light_of_pixels(images(kind));
      light.resize(of_kind.size());
      for (std::size_t i = 0; i < light.size(); ++i) {
        light[i] += certain * certain * of_kind[i].mean;
      }
    });
  }
  for (double& each : light) each /= weights;
  const PilotMethod& any = methods.front().method;
  return light_around(light, images(any.sensor ? *any.sensor : *any.luminaires));
}

}  // namespace

GroupErrors MethodFigures::errors_of_groups() const {
  GroupErrors both = sensor.of_groups;
  for (std::size_t i = 0; i < both.size(); ++i) both[i] += luminaires.of_groups[i] / ratio;
  return both;
}

double MethodFigures::merit() const {
  if (!(product() > 0.0)) return 0.0;
  return handicap * product() * math::exp(kCaution * error_of_log(errors_of_groups()));
}

bool is_better(const MethodFigures& one, const MethodFigures& other) {
  const auto rank = [](const MethodFigures& each) {
    return std::tuple(each.misses_light, each.uncertain, each.merit());
  };
  return rank(one) < rank(other);
}

bool is_more(const std::vector<double>& more, const std::vector<double>& less, double errors) {
  std::vector<double> differences;
  for (std::size_t i = 0; i < std::min(more.size(), less.size()); ++i) {
    differences.push_back(more[i] - less[i]);
  }
  const auto [mean, error] = mean_and_error(differences);
  // Student's t of so few numbers for the normal quantile (Abramowitz and Stegun 1964, equation
  // 26.7.5, first term).
  const double freedom = static_cast<double>(differences.size()) - 1.0;
  const double bound = errors + errors * (errors * errors + 1.0) / (4.0 * freedom);
  return mean > bound * error && mean > 0.0;
}

const PilotMethod& surest_from_luminaires(const std::vector<PilotMethod>& methods,
                                          const PhotonKind& sensor, const ImagesOfKind& images) {
  const auto rank = [&](const PilotMethod& each) {
    if (!each.luminaires) return std::tuple(false, false, 0.0);
    const auto [mean, error] = mean_and_error(images(*each.luminaires));
    return std::tuple(true, !each.sensor || each.sensor->guided == sensor.guided,
                      mean > 0.0 ? mean / error : 0.0);
  };
  return *std::ranges::max_element(methods, {}, rank);
}

double best_forward_ratio(const PilotFigures& sensor, const PilotFigures& luminaires,
                          double about) {
  MethodFigures both;
  both.sensor = sensor;
  both.luminaires = luminaires;
  const auto product = [&](double ratio) {
    both.ratio = ratio;
    return both.product();
  };
  double least = std::numeric_limits<double>::infinity();
  std::vector<double> ratios;
  for (double ratio = kLeastRatio; ratio <= kMostRatio; ratio *= 2.0) {
    const double of_luminaires = ratio * luminaires.cost, all = sensor.cost + of_luminaires;
    if (of_luminaires < kLeastTime * all || sensor.cost < kLeastTime * all) continue;
    ratios.push_back(ratio);
    least = std::min(least, product(ratio));
  }
  double best = 1.0;
  for (const double ratio : ratios) {
    if (product(ratio) <= about * least) best = ratio;
  }
  return best;
}

std::vector<MethodFigures> figures_of_methods(const std::vector<PilotMethod>& methods,
                                              const ImagesOfKind& images,
                                              std::optional<double> given_ratio) {
  std::vector<MethodFigures> found;
  std::vector<std::vector<double>> means;
  for (const PilotMethod& method : methods) {
    means.push_back(means_of_method(method, images));
    MethodFigures& each = found.emplace_back();
    each.method = method;
    each.mean = mean_and_error(means.back());
    if (!method.luminaires) continue;
    const auto [mean, error] = mean_and_error(images(*method.luminaires));
    each.uncertain = !(mean > 0.0 && mean >= kCertain * error);
  }
  for (std::size_t i = 0; i < found.size(); ++i) {
    for (std::size_t other = 0; other < found.size(); ++other) {
      if (!found[other].uncertain && is_more(means[other], means[i])) found[i].misses_light = true;
    }
  }
  if (std::ranges::none_of(found, &MethodFigures::comparable)) return found;
  const std::vector<double> shown = reference_light(found, images);
  for (MethodFigures& each : found) {
    const auto figures = [&](const PhotonKind& kind) {
      return figures_of(kind, images(kind), shown, cost_of_ray(kind));
    };
    const auto& [sensor, luminaires] = each.method;
    if (sensor) each.sensor = figures(*sensor);
    if (luminaires) each.luminaires = figures(*luminaires);
    if (sensor && luminaires) {
      each.ratio = given_ratio ? *given_ratio : best_forward_ratio(each.sensor, each.luminaires);
    }
  }
  prefer_both_ends(found);
  return found;
}

}  // namespace nocturne
