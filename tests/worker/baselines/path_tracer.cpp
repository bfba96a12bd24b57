#include "baselines/path_tracer.h"

#include <algorithm>

#include "math/frame.h"
#include "math/functions.h"

namespace nocturne::baselines {
namespace {

float power_share(float drawn, float other) {
  return drawn * drawn / (drawn * drawn + other * other);
}

class Path {
 public:
  Path(const Scene& scene, const Start<1>& start, const PhotonSequence& sequence)
      : scene_(scene), start_(start), sequence_(sequence), ray_(start.ray) {}

  PathResult run() {
    for (std::uint32_t depth = 0; bounce(depth); ++depth) {
    }
    return {radiance_, rays_};
  }

 private:
  std::optional<Hit> cast(const Ray& ray) {
    ++rays_;
    return scene_.geometry.intersect(ray, start_.time);
  }

  // What the ray sees by itself.
  float light(const std::optional<Hit>& hit, Vec3 direction) const {
    if (!hit) return scene_.distant_radiance<1>(direction, start_.wavelengths)[0];
    const std::uint32_t luminaire = scene_.materials[hit->surface].luminaire;
    if (luminaire == SurfaceMaterial::kNone) return 0.0f;
    return scene_.emitted(scene_.luminaires[luminaire], *hit, -direction, start_.time,
                          start_.wavelengths)[0];
  }

  bool bounce(std::uint32_t depth) {
    const auto hit = cast(ray_);
    const float seen = light(hit, ray_.direction);
    // Light that the last vertex could have asked for itself counts in part.
    if (seen > 0.0f) {
      const float share = kernel_pdf_ > 0.0f
                              ? power_share(kernel_pdf_, scene_.lights.pdf(from_, ray_.direction))
                              : 1.0f;
      radiance_ += weight_ * share * seen;
    }
    if (!hit || depth == scene_.options.max_depth) return false;
    const SurfaceMaterial& material = scene_.materials[hit->surface];
    const bool front = dot(hit->normal, ray_.direction) < 0.0f;
    Shading<1> shading{.wavelengths = start_.wavelengths, .point = {}};
    const Interior* entered = nullptr;
    if (material.interior != SurfaceMaterial::kNone) {
      entered = &scene_.interiors[material.interior];
      (front ? shading.index_to : shading.index_from) = entered->index(start_.wavelengths);
      if (!front && entered->absorbs) {
        weight_ *= math::exp(-entered->absorption(start_.wavelengths)[0] * hit->distance);
      }
    }
    return visit_bound<1>(scene_.kernels, front ? material.front_kernel : material.back_kernel,
                          shading,
                          [&](const auto& kernel) { return scatter(*hit, front, kernel); });
  }

  template <class Kernel>
  bool scatter(const Hit& hit, bool front, const Kernel& kernel) {
    const Frame frame(front ? hit.normal : -hit.normal);
    const Vec3 wo = frame.to_local(-ray_.direction);
    from_ = {hit.position, frame.normal, kernel.transmits(), start_.time};
    if (kernel.smooth() && !scene_.lights.empty()) ask_lights(hit, frame, wo, kernel);
    const Uniform4 u = sequence_.next();
    const float survival = std::min(1.0f, kernel.albedo(wo)[0] * scene_.options.h);
    const auto draw = kernel.sample(wo, {u[3], u[0], u[1]}, 0);
    if (u[2] >= survival || !draw) return false;
    if (draw->delta) {
      kernel_pdf_ = 0.0f;
      weight_ *= draw->factor[0] / survival;
    } else {
      const float pdf = kernel.pdf(wo, draw->wi)[0];
      if (!(pdf > 0.0f)) return false;
      kernel_pdf_ = scene_.lights.empty() ? 0.0f : pdf;
      weight_ *= kernel.value(wo, draw->wi)[0] / (pdf * survival);
    }
    const Vec3 direction = frame.to_world(draw->wi);
    ray_ = {leave_surface(hit, direction), direction};
    return weight_ > 0.0f;
  }

  template <class Kernel>
  void ask_lights(const Hit& hit, const Frame& frame, Vec3 wo, const Kernel& kernel) {
    const Uniform4 u = sequence_.next();
    const auto drawn = scene_.lights.sample(from_, u[2], u[0], u[1]);
    if (!drawn) return;
    const Vec3 direction = drawn->direction;
    const Vec3 wi = frame.to_local(direction);
    const float value = kernel.value(wo, wi)[0];
    if (!(value > 0.0f)) return;
    const auto met = cast({leave_surface(hit, direction), direction});
    const float seen = light(met, direction);
    const float pdf = scene_.lights.pdf(from_, *drawn);
    if (!(seen > 0.0f && pdf > 0.0f)) return;
    radiance_ += weight_ * value * seen / pdf * power_share(pdf, kernel.pdf(wo, wi)[0]);
  }

  const Scene& scene_;
  const Start<1>& start_;
  PhotonSequence sequence_;
  Ray ray_;
  LightSamplingContext from_{};
  // Of the last draw; zero where no light could have been asked for in its place.
  float kernel_pdf_ = 0.0f;
  float weight_ = 1.0f, radiance_ = 0.0f;
  std::uint32_t rays_ = 0;
};

}  // namespace

PathResult trace_path(const Scene& scene, const Start<1>& start, const PhotonSequence& sequence) {
  return Path(scene, start, sequence).run();
}

}  // namespace nocturne::baselines
