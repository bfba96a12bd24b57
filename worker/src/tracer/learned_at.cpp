#include "tracer/learned_at.h"

#include "tracer/pixel_sample.h"
#include "tracer/stages/travel.h"
#include "tracer/vertex.h"

namespace nocturne {
namespace {

/// A ray that goes on more often is caught between mirrors.
constexpr std::uint32_t kMaxInterfaces = 64;
/// Chooses the likelier part of a kernel: through clear glass, but for grazing directions.
constexpr KernelNumbers kMiddle{0.5f, 0.5f, 0.5f};

/// How a mirror or clear boundary sends a ray on, in the frame; empty for other surfaces.
std::optional<Vec3> sent_on(const Scene& scene, const Vertex<1>& vertex) {
  return visit_bound(scene.kernels, vertex.kernel, vertex.shading,
                     [&](const auto& kernel) -> std::optional<Vec3> {
                       const auto draw = kernel.sample(vertex.wo, kMiddle, 0);
                       if (!draw || !draw->delta) return std::nullopt;
                       const bool straight = draw->wi == -vertex.wo;
                       // Paint has a coat that mirrors, and is what is looked for.
                       if (kernel.smooth() && !straight) return std::nullopt;
                       return draw->wi;
                     });
}

}  // namespace

std::optional<LearnedAt> learned_at(const Scene& scene, Film film, std::uint32_t x,
                                    std::uint32_t y) {
  const auto sample = sample_pixel<1>(scene, film, x, y, {0.5f, 0.5f, 0.5f, 0.5f, 0.5f, 0.5f});
  const Start<1>& start = sample.start;
  PixelSequence numbers(scene.options.sequence, scene.options.seed, 0);
  Group<1> group{PhotonSequence(numbers, 0)};
  group.ray = start.ray;
  group.departure = start.departure;
  group.inside = start.inside;
  group.width = start.width;
  std::uint32_t passed = 0;
  for (std::uint32_t i = 0; i < kMaxInterfaces; ++i) {
    auto hit = scene.geometry.intersect(group.ray, start.time, group.departure);
    if (!hit) return std::nullopt;
    group.width += start.spread * hit->distance;
    const Contacts contacts = contacts_of(scene, group.ray, start.time, group.departure, *hit);
    const auto vertex = make_vertex(scene, *hit, contacts, group, start.wavelengths, start.time,
                                    Transport::kAdjoint);
    if (!vertex || sees_past(group, scene.hidden_from(hit->surface))) {
      pass_index_matched(scene, group, *hit, contacts, start.time);
      continue;
    }
    const auto wi = sent_on(scene, *vertex);
    if (!wi) {
      const LearnedLight& learned = scene.lights.learned();
      const std::uint32_t cell = learned.find(hit->position);
      LearnedAt found{vertex->frame.normal, group.ray.direction, passed, {}};
      if (cell != LearnedLight::kNone) found.cones = learned.cones(cell);
      return found;
    }
    ++group.depth;
    const bool straight = *wi == -vertex->wo;
    if (straight) ++group.passes;
    const bool bounds_body =
        scene.materials[hit->surface].medium_interface != SurfaceMaterial::kNone;
    if (!straight || bounds_body) ++passed;
    const Vec3 direction = vertex->to_world(*wi);
    if (dot(vertex->normal, direction) < 0.0f) group.inside = vertex->beyond;
    start_off(scene, group, *hit, direction, start.time);
  }
  return std::nullopt;
}

}  // namespace nocturne
