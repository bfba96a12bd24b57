#include "tracer/learning/learned_at.h"

#include "tracer/line_of_sight.h"
#include "tracer/pixel_sample.h"

namespace nocturne {
namespace {

/// Chooses the likelier part of a kernel: through clear glass, but for grazing directions.
constexpr KernelNumbers kMiddle{0.5f, 0.5f, 0.5f};

/// How a mirror or clear boundary sends a ray on, in the frame; empty for other surfaces.
std::optional<Vec3> sent_on(const Scene& scene, const Vertex<1>& vertex) {
  return visit_bound(scene.kernels, vertex.kernel, vertex.shading,
                     [&](const auto& kernel) -> std::optional<Vec3> {
                       const auto draw = kernel.sample(vertex.wo, kMiddle, 0);
                       if (!draw || !draw->delta) return std::nullopt;
                       const bool straight = draw->wi == -vertex.wo;
                       // Paint has a coat that mirrors, and is itself looked for.
                       if (kernel.smooth() && !straight) return std::nullopt;
                       return draw->wi;
                     });
}

}  // namespace

std::optional<LearnedAt> learned_at(const Scene& scene, Film film, std::uint32_t x,
                                    std::uint32_t y) {
  const auto sample = sample_pixel<1>(scene, film, x, y, {0.5f, 0.5f, 0.5f, 0.5f, 0.5f, 0.5f});
  PixelSequence numbers(scene.options.sequence, scene.options.seed, 0);
  LineOfSight line(scene, sample.start, PhotonSequence(numbers, 0));
  std::uint32_t passed = 0;
  while (const Vertex<1>* vertex = line.next()) {
    const auto wi = sent_on(scene, *vertex);
    if (!wi) {
      const LearnedLight& learned = scene.lights.learned();
      const std::uint32_t cell = learned.find(vertex->hit.position);
      LearnedAt found{vertex->frame.normal, line.direction(), passed, {}};
      if (cell != LearnedLight::kNone) found.cones = learned.cones(cell);
      return found;
    }
    const SurfaceMaterial& material = scene.materials[vertex->hit.surface];
    const bool is_boundary =
        material.interior != SurfaceMaterial::kNone || material.boundary != SurfaceMaterial::kNone;
    if (*wi != -vertex->wo || is_boundary) ++passed;
    line.continue_along(*wi);
  }
  return std::nullopt;
}

}  // namespace nocturne
