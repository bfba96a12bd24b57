#include "media/altitude_density.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <stdexcept>
#include <string>
#include <utility>

#include "math/functions.h"

namespace nocturne {
namespace {

constexpr double kLowest = -80.0, kHighest = 100.0;  // scale heights
// So that no rounding puts the density there above a bound.
constexpr float kRoundedUp = 1.000001f;
constexpr std::size_t kMaxKnots = 10'000, kMaxLayers = 64;

[[noreturn]] void refuse(const std::string& what) { throw std::invalid_argument(what); }

bool finite(Double3 v) { return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z); }

}  // namespace

AltitudeDensity::AltitudeDensity(const Ground& ground) : ground_(ground) {
  const double size = length(ground.up);
  if (!finite(ground.base) || !(size > 0.0) || !std::isfinite(size)) {
    refuse("a ground that is nowhere");
  }
  if (!(ground.radius >= 0.0) || !std::isfinite(ground.radius)) {
    refuse("a ground with a negative or infinite radius");
  }
  ground_.up = (1.0 / size) * ground.up;
}

// On top of the last one; layers of nothing become one.
void AltitudeDensity::add_layer(float majorant, double upper_edge) {
  if (!majorant_.empty() && majorant == 0.0f && majorant_.back() == 0.0f) {
    edges_.back() = upper_edge;
    return;
  }
  majorant_.push_back(majorant);
  edges_.push_back(upper_edge);
}
void AltitudeDensity::add_space_above() {
  if (majorant_.back() == 0.0f) {
    edges_.pop_back();
  } else {
    majorant_.push_back(0.0f);
  }
}

AltitudeDensity AltitudeDensity::exponential(const Ground& ground, double scale_height) {
  if (!(scale_height > 0.0) || !std::isfinite(scale_height)) {
    refuse("a scale height that is not positive and finite");
  }
  AltitudeDensity d(ground);
  d.scale_height_ = scale_height;
  const auto majorant = [](double heights) {
    return static_cast<float>(math::exp(-heights) * 1.000001);
  };
  // Half a scale height each up to the ground; above it they grow, as ever less is met there.
  // Majorants on a vertical ray are half again as much as there is.
  double low = kLowest, step = 0.5;
  d.add_layer(majorant(low), low * scale_height);
  for (; low < kHighest; low += step) {
    if (low > 0.0) step *= 1.5;
    d.add_layer(majorant(low), std::min(low + step, kHighest) * scale_height);
  }
  d.add_space_above();
  return d;
}

AltitudeDensity AltitudeDensity::table(const Ground& ground, std::vector<double> altitudes,
                                       std::vector<float> densities) {
  AltitudeDensity d(ground);
  if (altitudes.size() < 2 || altitudes.size() > kMaxKnots) {
    refuse("a table without 2 to " + std::to_string(kMaxKnots) + " altitudes");
  }
  if (densities.size() != altitudes.size()) refuse("a table without one density for each altitude");
  if (!std::ranges::all_of(altitudes, [](double x) { return std::isfinite(x); }) ||
      std::ranges::adjacent_find(altitudes, std::greater_equal<>{}) != altitudes.end()) {
    refuse("a table whose altitudes do not increase");
  }
  if (!std::ranges::all_of(densities, [](float x) { return std::isfinite(x) && x >= 0.0f; })) {
    refuse("a table with a density that is negative or not finite");
  }
  d.altitudes_ = std::move(altitudes);
  d.densities_ = std::move(densities);
  // Few layers with bounds that are not much too high.
  double tolerance = 0.01;
  std::vector<std::size_t> ends = d.layers_of_table(tolerance);
  while (ends.size() > kMaxLayers) ends = d.layers_of_table(tolerance *= 2.0);
  d.add_layer(0.0f, d.altitudes_.front());
  std::size_t first = 0;
  for (const std::size_t last : ends) {
    const float majorant = *std::max_element(&d.densities_[first], &d.densities_[last] + 1);
    d.add_layer(majorant * kRoundedUp, d.altitudes_[last]);
    first = last;
  }
  d.add_space_above();
  return d;
}

// The knots at which layers end. A layer's bound is too high by no more than this share of the
// whole column, or a third, or it has but two knots.
std::vector<std::size_t> AltitudeDensity::layers_of_table(double tolerance) const {
  const auto column = [&](std::size_t i) {
    return 0.5 * (altitudes_[i + 1] - altitudes_[i]) *
           (static_cast<double>(densities_[i]) + static_cast<double>(densities_[i + 1]));
  };
  double total = 0.0;
  for (std::size_t i = 0; i + 1 < altitudes_.size(); ++i) total += column(i);
  std::vector<std::size_t> ends;
  std::size_t first = 0;
  double here = 0.0;
  float majorant = densities_[0];
  for (std::size_t i = 0; i + 1 < altitudes_.size(); ++i) {
    const float more = std::max(majorant, densities_[i + 1]);
    const double bound = static_cast<double>(more) * (altitudes_[i + 1] - altitudes_[first]);
    const double with = here + column(i);
    // Empty space stays by itself.
    const bool joins = i == first || (here == 0.0) == (column(i) == 0.0);
    if (i > first && !(joins && bound - with <= std::max(tolerance * total, with / 3.0))) {
      ends.push_back(i);
      first = i;
      here = column(i);
      majorant = std::max(densities_[i], densities_[i + 1]);
    } else {
      here = with;
      majorant = more;
    }
  }
  ends.push_back(altitudes_.size() - 1);
  return ends;
}

float AltitudeDensity::at(double altitude) const {
  if (scale_height_ > 0.0) {
    const double heights = altitude / scale_height_;
    return heights > kHighest ? 0.0f : static_cast<float>(math::exp(-std::max(kLowest, heights)));
  }
  if (!(altitude >= altitudes_.front() && altitude <= altitudes_.back())) return 0.0f;
  const auto above = std::upper_bound(altitudes_.begin() + 1, altitudes_.end() - 1, altitude);
  const auto i = static_cast<std::size_t>(above - altitudes_.begin());
  const double t = (altitude - altitudes_[i - 1]) / (altitudes_[i] - altitudes_[i - 1]);
  const double low = static_cast<double>(densities_[i - 1]);
  return static_cast<float>(low + t * (static_cast<double>(densities_[i]) - low));
}

float AltitudeDensity::majorant_between(double low, double high) const {
  if (scale_height_ > 0.0) return at(low) * kRoundedUp;
  // A ray that leaves an edge has left the layer on the other side; one that is level is in both.
  const bool level = low == high;
  const auto first =
      level ? std::ranges::lower_bound(edges_, low) : std::ranges::upper_bound(edges_, low);
  auto i = static_cast<std::size_t>(first - edges_.begin());
  float majorant = majorant_[i];
  const auto reaches = [&](double edge) { return edge < high || (edge == high && level); };
  for (; i < edges_.size() && reaches(edges_[i]); ++i)
    majorant = std::max(majorant, majorant_[i + 1]);
  return majorant;
}

AltitudeMajorants::AltitudeMajorants(const AltitudeDensity& density, const Ray& ray, float end)
    : density_(&density), altitude_(density.ground_, ray.origin, ray.direction), end_(end) {
  const auto above = std::ranges::upper_bound(density.edges_, altitude_(0.0));
  layer_ = static_cast<std::size_t>(above - density.edges_.begin());
}

bool AltitudeMajorants::advance(MajorantSegment& segment) {
  if (!(at_ < end_)) return false;
  const float to = way_out();
  segment = {to, majorant_between(at_, to)};
  at_ = to;
  return true;
}

// Out of the layer; on to the next one.
float AltitudeMajorants::way_out() {
  const std::vector<double>& edges = density_->edges_;
  for (;;) {
    double out = AltitudeAlong::kNever;
    std::size_t next = layer_;
    if (!rising_) {
      if (layer_ > 0) out = altitude_.falls_to(edges[layer_ - 1]);
      if (out == AltitudeAlong::kNever) {
        rising_ = true;
        continue;
      }
      next = layer_ - 1;
    } else if (layer_ < edges.size()) {
      out = altitude_.rises_to(edges[layer_]);
      next = layer_ + 1;
    }
    if (!(out < static_cast<double>(end_))) return end_;
    layer_ = next;
    // Layers that are thinner than distances are rounded are left together.
    if (static_cast<float>(out) > at_) return std::min(static_cast<float>(out), end_);
  }
}

float AltitudeMajorants::majorant_between(float from, float to) const {
  constexpr double kFar = 1e18;
  const double t0 = static_cast<double>(from), t1 = std::fmin(static_cast<double>(to), kFar);
  const double middle = std::clamp(altitude_.lowest(), t0, std::fmax(t0, t1));
  const double h0 = altitude_(t0), h1 = altitude_(t1);
  return density_->majorant_between(std::min({h0, altitude_(middle), h1}), std::max(h0, h1));
}

}  // namespace nocturne
