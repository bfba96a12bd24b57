#include "tracer/baselines/path_tracer.h"

#include <algorithm>

#include "kernels/kernel.h"
#include "tracer/vertex.h"

namespace nocturne::baselines {
namespace {

// Light that arrives straight from a luminaire: a direction towards one, and the nearest surface
// there.
template <BoundKernel Bound>
float direct_light(const Scene& scene, const Bound& kernel, const Frame& frame, const Hit& hit,
                   Vec3 wo, float wavelength_nm, const Uniform4& u, PhotonResult& result) {
  const auto direction = scene.luminaire_directions.sample(hit.position, u[0], u[1], u[2]);
  if (!direction) return 0.0f;
  const float value = kernel.value(wo, frame.to_local(*direction));
  if (value <= 0.0f) return 0.0f;
  const float pdf = scene.luminaire_directions.pdf(hit.position, *direction);
  if (!(pdf > 0.0f)) return 0.0f;
  ++result.rays;
  const auto met =
      scene.geometry.intersect({leave_surface(hit.position, hit.normal, *direction), *direction});
  if (!met) return 0.0f;
  return value / pdf * emitted(scene, *met, -*direction, wavelength_nm);
}

}  // namespace

PhotonResult trace_path(const Scene& scene, Ray ray, float wavelength_nm,
                        PhotonSequence& sequence) {
  PhotonResult result{0.0f, 0};
  float weight = 1.0f;
  for (std::uint32_t depth = 0;; ++depth) {
    ++result.rays;
    const auto hit = scene.geometry.intersect(ray);
    if (!hit) return result;
    if (depth == 0) result.radiance += emitted(scene, *hit, -ray.direction, wavelength_nm);
    if (depth == scene.options.maximum_depth) return result;

    const Frame frame = facing_frame(*hit, ray.direction);
    const Vec3 wo = frame.to_local(-ray.direction);
    const bool goes_on = std::visit(
        [&](const auto& any) {
          const auto kernel = any.bind(wavelength_nm);
          result.radiance += weight * direct_light(scene, kernel, frame, *hit, wo, wavelength_nm,
                                                   sequence.next(), result);
          const Uniform4 u = sequence.next();
          const float survival = std::min(1.0f, kernel.albedo(wo) * scene.options.h);
          const auto local = kernel.sample(wo, u[1], u[2]);
          if (u[0] >= survival || !local) return false;
          const float pdf = kernel.pdf(wo, *local);
          if (!(pdf > 0.0f)) return false;
          weight *= kernel.value(wo, *local) / (pdf * survival);
          const Vec3 direction = frame.to_world(*local);
          ray = {leave_surface(hit->position, hit->normal, direction), direction};
          return true;
        },
        scene.kernels[scene.materials[hit->surface].kernel]);
    if (!goes_on) return result;
  }
}

}  // namespace nocturne::baselines
