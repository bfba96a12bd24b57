#include "baselines/ray_marcher.h"

#include <utility>

#include "math/frame.h"
#include "math/functions.h"
#include "tracer/vertex/vertex.h"

namespace nocturne::baselines {
namespace {

class March {
 public:
  March(const Scene& scene, const Start<1>& start, const PhotonSequence& sequence,
        std::uint32_t steps)
      : scene_(scene), start_(start), sequence_(sequence), steps_(steps) {}

  PathResult run() {
    const float offset = sequence_.next()[0];
    const float radiance = follow(
        start_.ray, start_.inside,
        [&](const Ray& ray, const InteriorList& inside, float length) {
          return gather(ray, inside, length, offset);
        },
        [&](const Hit& hit, const Ray& ray, const InteriorList& inside) {
          return reflected(hit, ray, inside);
        });
    return {radiance, rays_};
  }

 private:
  // What a piece of a ray adds and lets pass.
  struct Piece {
    float added, passed;
  };

  // From boundary to boundary up to the visible surface: its radiance, and that of the pieces.
  template <class OnPiece, class OnSurface>
  float follow(Ray ray, InteriorList inside, const OnPiece& on_piece, const OnSurface& on_surface) {
    float radiance = 0.0f, left = 1.0f;
    for (;;) {
      ++rays_;
      auto hit = scene_.geometry.intersect(ray, start_.time);
      if (!hit)
        return radiance + left * scene_.distant_radiance<1>(ray.direction, start_.wavelengths)[0];
      const Contacts contacts = contacts_of(scene_, ray, start_.time, {}, *hit);
      const Piece piece = on_piece(ray, inside, hit->distance);
      radiance += left * piece.added;
      left *= piece.passed;
      const SurfaceMaterial& material = scene_.materials[hit->surface];
      if (material.luminaire != SurfaceMaterial::kNone) {
        radiance += left * scene_.emitted(scene_.luminaires[material.luminaire], *hit,
                                          -ray.direction, start_.time, start_.wavelengths)[0];
      }
      if (!material.index_matched_only) return radiance + left * on_surface(*hit, ray, inside);
      const bool front = dot(hit->normal, ray.direction) < 0.0f;
      inside = boundary_at(scene_, *hit, contacts, inside, front).beyond;
      ray.origin = leave_surface(*hit, ray.direction);
    }
  }

  // f(index, density x extinction at p) for all media there, 1/m.
  template <class F>
  void at(const InteriorList& inside, Vec3 p, const F& f) const {
    inside.for_each_present(scene_.interiors, [&](const Interior& body) {
      for (const std::uint32_t index : body.media) {
        const Medium& medium = scene_.media[index];
        const float density = std::visit(
            [p]<class Density>(const Density& d) {
              return typename Density::Majorants(d, {p, {0.0f, 0.0f, 1.0f}}, 1.0f).density(0.0f);
            },
            medium.density);
        f(index, density * medium.extinction(start_.wavelengths)[0]);
      }
    });
  }

  Piece gather(const Ray& ray, const InteriorList& inside, float length, float offset) {
    Piece piece{0.0f, scene_.transmittance(inside, length, start_.wavelengths)[0]};
    const float step = length / static_cast<float>(steps_);
    float left = 1.0f;
    for (std::uint32_t i = 0; i < steps_ && !inside.empty(); ++i) {
      const Vec3 p = ray.origin + (static_cast<float>(i) + offset) * step * ray.direction;
      float extinction = 0.0f, source = 0.0f;
      at(inside, p, [&](std::uint32_t index, float sigma) {
        if (!(sigma > 0.0f)) return;
        extinction += sigma;
        source += sigma * (scene_.media[index].source(p, start_.wavelengths)[0] +
                           scattered(scene_.surface_of(index), p, ray.direction, inside));
      });
      if (!(extinction > 0.0f)) continue;
      const float passed = math::exp(-extinction * step);
      piece.added += left * (1.0f - passed) / extinction * source;
      left *= passed;
    }
    piece.passed *= left;
    return piece;
  }

  float scattered(std::uint32_t surface, Vec3 p, Vec3 direction, const InteriorList& inside) {
    const Hit hit{.position = p,
                  .normal = -direction,
                  .surface = surface,
                  .distance = 0.0f,
                  .clearance = 0.0f,
                  .instance = Hit::kNoInstance,
                  .primitive = 0,
                  .u = 0.0f,
                  .v = 0.0f};
    return reflected(hit, {p, direction}, inside);
  }

  // Direct light that a surface or a medium sends back along the ray.
  float reflected(const Hit& hit, const Ray& ray, const InteriorList& inside) {
    const bool front = dot(hit.normal, ray.direction) < 0.0f;
    const SurfaceMaterial& material = scene_.materials[hit.surface];
    const Shading<1> shading{.wavelengths = start_.wavelengths, .point = {}};
    return visit_bound<1>(
        scene_.kernels, front ? material.front_kernel : material.back_kernel, shading,
        [&](const auto& kernel) {
          if (!kernel.smooth() || scene_.lights.empty()) return 0.0f;
          const Frame frame(front ? hit.normal : -hit.normal);
          const LightSamplingContext from{hit.position, frame.normal, kernel.transmits(),
                                          start_.time};
          const Uniform4 u = sequence_.next();
          const auto drawn = scene_.lights.sample(from, u[2], u[0], u[1]);
          if (!drawn) return 0.0f;
          const Vec3 direction = drawn->direction;
          const float value =
              kernel.value(frame.to_local(-ray.direction), frame.to_local(direction))[0];
          const float pdf = scene_.lights.pdf(from, *drawn);
          if (!(value > 0.0f && pdf > 0.0f)) return 0.0f;
          return value / pdf * arriving({leave_surface(hit, direction), direction}, inside);
        });
  }

  // Light that comes straight from a lamp.
  float arriving(const Ray& ray, const InteriorList& inside) {
    return follow(
        ray, inside,
        [&](const Ray& piece, const InteriorList& in, float length) {
          const float step = length / static_cast<float>(steps_);
          float depth = 0.0f;
          for (std::uint32_t i = 0; i < steps_ && !in.empty(); ++i) {
            at(in, piece.origin + (static_cast<float>(i) + 0.5f) * step * piece.direction,
               [&](std::uint32_t, float sigma) { depth += sigma * step; });
          }
          return Piece{0.0f,
                       math::exp(-depth) * scene_.transmittance(in, length, start_.wavelengths)[0]};
        },
        [](const Hit&, const Ray&, const InteriorList&) { return 0.0f; });
  }

  const Scene& scene_;
  const Start<1>& start_;
  PhotonSequence sequence_;
  const std::uint32_t steps_;
  std::uint32_t rays_ = 0;
};

}  // namespace

PathResult march_ray(const Scene& scene, const Start<1>& start, const PhotonSequence& sequence,
                     std::uint32_t steps) {
  return March(scene, start, sequence, steps).run();
}

}  // namespace nocturne::baselines
