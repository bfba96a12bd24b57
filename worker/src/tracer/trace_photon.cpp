#include "tracer/trace_photon.h"

#include <algorithm>

#include "tracer/mixture.h"
#include "tracer/vertex.h"

namespace nocturne {
namespace {

struct Scattered {
  Vec3 direction;
  /// rho cos / (q x survival probability).
  float factor;
};

// One vertex: roulette, then a direction from the mixture. The same number decides survival and,
// stretched over what is left of it, the part of the mixture. The paper's survival probability is H
// h; times the weight that the photon carries (1 under plain kernel sampling) light photons die and
// heavy ones stay, which keeps the variance finite in bright enclosures, where a mixture makes
// weights vary (docs/decisions/0004-roulette-by-weight.md).
template <BoundKernel Bound>
std::optional<Scattered> scatter(const Scene& scene, const Bound& kernel, const Frame& frame,
                                 const Hit& hit, Vec3 incoming, float weight,
                                 PhotonSequence& sequence) {
  const Vec3 wo = frame.to_local(-incoming);
  const float carried = scene.options.roulette_by_weight ? weight : 1.0f;
  const float survival = std::min(1.0f, kernel.albedo(wo) * scene.options.h * carried);
  const Uniform4 u = sequence.next();
  if (u[0] >= survival) return std::nullopt;
  const auto drawn = sample_mixture(scene, kernel, frame, hit.position, wo, u[0] / survival, u);
  if (!drawn) return std::nullopt;
  const float value = kernel.value(wo, drawn->local);
  if (value <= 0.0f) return std::nullopt;
  return Scattered{drawn->world, value / (drawn->pdf * survival)};
}

}  // namespace

PhotonResult trace_photon(const Scene& scene, Ray ray, float wavelength_nm,
                          PhotonSequence& sequence) {
  PhotonResult result{0.0f, 0};
  float weight = 1.0f;
  for (std::uint32_t depth = 0;; ++depth) {
    ++result.rays;
    const auto hit = scene.geometry.intersect(ray);
    if (!hit) return result;
    result.radiance += weight * emitted(scene, *hit, -ray.direction, wavelength_nm);
    if (depth == scene.options.maximum_depth) return result;

    const Frame frame = facing_frame(*hit, ray.direction);
    const auto scattered = std::visit(
        [&](const auto& kernel) {
          return scatter(scene, kernel.bind(wavelength_nm), frame, *hit, ray.direction, weight,
                         sequence);
        },
        scene.kernels[scene.materials[hit->surface].kernel]);
    if (!scattered) return result;
    weight *= scattered->factor;
    ray = {leave_surface(hit->position, hit->normal, scattered->direction), scattered->direction};
  }
}

}  // namespace nocturne
