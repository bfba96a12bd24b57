#include "tracer/learning/aims_around.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "math/functions.h"

namespace nocturne {
namespace {

/// Above 16 elements a direction's density takes a walk through a tree (area_light_sampler.h).
constexpr std::size_t kMaxAims = 16;
/// Places that make a ball; fewer are left to photons that are not aimed.
constexpr std::size_t kEnough = 16;
/// A ball is divided where that leaves so much of the cost, and loses at most one place of so
/// many.
constexpr double kWorthDividing = 0.8;
constexpr std::size_t kFew = 50;

using Places = std::vector<Vec3>;

std::array<double, 3> coordinates(Vec3 place) { return {place.x, place.y, place.z}; }

struct Cluster {
  Places places;
  std::array<double, 3> mean{};
  double radius = 0.0;
  std::size_t longest = 0;

  explicit Cluster(Places those) : places(std::move(those)) {
    if (places.empty()) return;
    std::array<double, 3> squares{};
    const auto count = static_cast<double>(places.size());
    for (const Vec3 place : places) {
      const auto at = coordinates(place);
      for (std::size_t i = 0; i < 3; ++i) {
        mean[i] += at[i] / count;
        squares[i] += at[i] * at[i] / count;
      }
    }
    radius = radius_of_most() * (1.0 + 1.0 / std::sqrt(count));  // few do not reach the edge
    for (std::size_t i = 0; i < 3; ++i) squares[i] -= mean[i] * mean[i];
    longest = static_cast<std::size_t>(std::ranges::max_element(squares) - squares.begin());
  }

  /// Neither too few places nor, but for rounding, all the same.
  bool good() const {
    constexpr double kRounding = 1e-6;
    return places.size() >= kEnough && radius > kRounding * math::hypot(mean[0], mean[1], mean[2]);
  }

  /// Photons that fall evenly on balls of areas A_i, n_i of them worth it, have the least variance
  /// if a part in proportion to the root of n_i A_i is sent to each; and it is the square of the
  /// sum of these roots.
  double cost() const { return std::sqrt(static_cast<double>(places.size())) * radius; }

  std::array<Cluster, 2> halves() const {
    Places lower, upper;
    for (const Vec3 place : places) {
      (coordinates(place)[longest] < mean[longest] ? lower : upper).push_back(place);
    }
    return {Cluster(std::move(lower)), Cluster(std::move(upper))};
  }

 private:
  /// Around the mean, without one place of a hundred: photons that are not aimed find those.
  double radius_of_most() const {
    std::vector<double> distances;
    for (const Vec3 place : places) {
      const auto at = coordinates(place);
      distances.push_back(math::hypot(at[0] - mean[0], at[1] - mean[1], at[2] - mean[2]));
    }
    const auto most =
        distances.begin() + static_cast<std::ptrdiff_t>((distances.size() - 1) * 99 / 100);
    std::ranges::nth_element(distances, most);
    return *most;
  }
};

}  // namespace

std::vector<Aim> aims_around(const Places& places) {
  if (places.size() < kEnough) return {};
  std::vector<Cluster> clusters{Cluster(places)};
  // One that is not worth dividing stays; those that came of another are looked at, too.
  for (std::size_t i = 0; i < clusters.size() && clusters.size() < kMaxAims;) {
    auto [larger, smaller] = clusters[i].halves();
    if (larger.places.size() < smaller.places.size()) std::swap(larger, smaller);
    const bool both = smaller.good();
    const double cost = larger.cost() + (both ? smaller.cost() : 0.0);
    const bool may_divide = larger.good() && (both || smaller.places.size() * kFew < places.size());
    if (!may_divide || !(cost < kWorthDividing * clusters[i].cost())) {
      ++i;
      continue;
    }
    clusters[i] = std::move(larger);
    if (both) clusters.push_back(std::move(smaller));
  }
  std::vector<Aim> aims;
  for (const Cluster& cluster : clusters) {
    if (!cluster.good()) continue;  // the first, where all came to one point
    aims.push_back({{static_cast<float>(cluster.mean[0]), static_cast<float>(cluster.mean[1]),
                     static_cast<float>(cluster.mean[2])},
                    static_cast<float>(cluster.radius),
                    cluster.cost()});
  }
  return aims;
}

}  // namespace nocturne
