#include "luminaires/ray_set.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

namespace nocturne {

RaySet::RaySet(std::vector<Recorded> rays, Spectrum per_watt, std::uint32_t group)
    : light_group(group), rays_(std::move(rays)), per_watt_(std::move(per_watt)) {
  for (Recorded& ray : rays_) {
    const float norm = length(Vec3{ray.kx, ray.ky, ray.kz});
    if (!(std::isfinite(ray.x) && std::isfinite(ray.y) && std::isfinite(ray.z)) ||
        !(norm > 0.0f && std::isfinite(norm))) {
      throw std::invalid_argument("a ray without a place or a direction");
    }
    if (!(ray.watts >= 0.0f && std::isfinite(ray.watts))) {
      throw std::invalid_argument("a ray's power is negative or not finite");
    }
    ray.kx /= norm, ray.ky /= norm, ray.kz /= norm;
    watts_ += ray.watts;
  }
  if (!(watts_ > 0.0)) throw std::invalid_argument("rays without power");
  const auto count = static_cast<double>(rays_.size());
  std::vector<double> left(rays_.size());
  std::vector<std::uint32_t> small, large;
  for (std::uint32_t i = 0; i < rays_.size(); ++i) {
    left[i] = rays_[i].watts * (count / watts_);
    (left[i] < 1.0 ? small : large).push_back(i);
  }
  places_.assign(rays_.size(), {1.0f, 0});
  for (std::uint32_t i = 0; i < rays_.size(); ++i) places_[i].other = i;
  while (!small.empty() && !large.empty()) {
    const std::uint32_t low = small.back(), high = large.back();
    small.pop_back();
    places_[low] = {static_cast<float>(left[low]), high};
    left[high] -= 1.0 - left[low];
    if (left[high] >= 1.0) continue;
    large.pop_back();
    small.push_back(high);
  }
}

double RaySet::mean_flux() const { return watts_ * per_watt_.mean(); }

Ray RaySet::draw(float coarse, float fine, float which) const {
  constexpr double kSteps = 0x1p24;
  const double u = (std::floor(double{coarse} * kSteps) + double{fine}) / kSteps;
  const auto last = rays_.size() - 1;
  const auto place =
      std::min(static_cast<std::size_t>(u * static_cast<double>(rays_.size())), last);
  const Recorded& ray = rays_[which < places_[place].share ? place : places_[place].other];
  return {{ray.x, ray.y, ray.z}, {ray.kx, ray.ky, ray.kz}};
}

}  // namespace nocturne
