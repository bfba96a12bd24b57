// Where photons meet a surface: everything that follows from the hit alone.
#pragma once

#include <optional>

#include "math/frame.h"
#include "scene/contacts.h"
#include "scene/scene.h"
#include "surfaces/shading_normal.h"
#include "tracer/group.h"

namespace nocturne {

template <int N>
struct Vertex {
  const Hit& hit;
  /// The kernel's frame: its normal, which may be a shading normal, on the side that the photons
  /// came from.
  Frame frame;
  /// The geometric normal on that side.
  Vec3 normal;
  /// Where they came from, in the frame.
  Vec3 wo;
  std::uint32_t kernel;
  /// Met from the side that is out.
  bool front;
  /// Seen from behind the shading normal, so that the kernel's is the surface's own.
  bool own_normal = false;
  Shading<N> shading;
  /// The bodies they are in once through; as before where the surface bounds no body.
  InteriorList beyond;
  /// The cell of learned light that photons from here are guided by, or none.
  std::uint32_t learned = LearnedLight::kNone;
  /// The cell of the visible sky, or none.
  std::uint32_t visible_sky = VisibleSky::kNone;

  Vec3 to_local(Vec3 direction) const { return frame.to_local(direction); }
  Vec3 to_world(Vec3 direction) const { return frame.to_world(direction); }
};

/// Index of the kernel on the side that is met.
inline std::uint32_t kernel_at(const Scene& scene, const Hit& hit, Vec3 direction) {
  const SurfaceMaterial& material = scene.materials[hit.surface];
  return dot(hit.normal, direction) < 0.0f ? material.front_kernel : material.back_kernel;
}

/// What a photon finds that goes through the surface of a hit and all that touches it.
inline Boundary boundary_at(const Scene& scene, const Hit& hit, const Contacts& contacts,
                            const InteriorList& inside, bool front) {
  const std::uint32_t body = scene.materials[hit.surface].interior;
  std::optional<Crossing> own;
  if (body != SurfaceMaterial::kNone) own = {body, front};
  return cross_boundary(inside, scene.interiors, own, contacts);
}

/// The bodies present have this index of refraction.
template <int N>
Spectral<N> index_in(const Scene& scene, std::uint32_t body, const Spectral<N>& wavelengths) {
  if (body == InteriorList::kOutside) return 1.0f;
  return scene.interiors[body].index(wavelengths);
}

/// Indices of refraction before and behind a surface that bounds a body or touches one; false where
/// they are the same, because it lies inside a body of higher priority or is matched.
template <int N>
bool enter_boundary(const Scene& scene, const Contacts& contacts, bool front, Vertex<N>& vertex) {
  const Boundary boundary = boundary_at(scene, vertex.hit, contacts, vertex.beyond, front);
  vertex.beyond = boundary.beyond;
  Shading<N>& shading = vertex.shading;
  shading.index_from = index_in(scene, boundary.from, shading.wavelengths);
  shading.index_to = boundary.from == boundary.to
                         ? shading.index_from
                         : index_in(scene, boundary.to, shading.wavelengths);
  return boundary.from != boundary.to;
}

/// Texture coordinates and the frame of a surface that is not the same everywhere.
template <int N>
void set_shading_frame(const Scene& scene, const SurfaceMaterial& material, const Group<N>& group,
                       float time, bool front, Vertex<N>& vertex) {
  const SurfaceDetail detail = scene.geometry.detail(vertex.hit, time);
  SurfacePoint& point = vertex.shading.point;
  point = {detail.u, detail.v, group.width * detail.texture_per_metre};
  Vec3 normal = detail.shading_normal;
  if (material.bump_map != SurfaceMaterial::kNone) {
    normal = scene.bump_maps[material.bump_map].normal(detail, point);
  }
  vertex.frame = frame_along(front ? normal : -normal, detail.dp_du);
  // Seen from behind the shading normal, though not from behind the surface: the surface's own.
  if (dot(vertex.frame.normal, group.ray.direction) >= 0.0f) {
    vertex.frame = frame_along(vertex.normal, detail.dp_du);
    vertex.own_normal = true;
  }
}

/// What the hit alone says.
template <int N>
Vertex<N> vertex_at(const Scene& scene, const Hit& hit, const Group<N>& group,
                    const Spectral<N>& wavelengths, Transport transport) {
  const SurfaceMaterial& material = scene.materials[hit.surface];
  const bool front = dot(hit.normal, group.ray.direction) < 0.0f;
  const Vec3 normal = front ? hit.normal : -hit.normal;
  return {.hit = hit,
          .frame = Frame(normal),
          .normal = normal,
          .wo = {},
          .kernel = front ? material.front_kernel : material.back_kernel,
          .front = front,
          .own_normal = false,
          .shading = {.wavelengths = wavelengths,
                      .point = {},
                      .transport = transport,
                      .path_pdf_ratio = group.path_pdf_ratio},
          .beyond = group.inside};
}

/// What bodies, textures and shading normals say; false where the surface is not seen.
template <int N>
bool complete(const Scene& scene, const Contacts& contacts, const Group<N>& group, float time,
              Vertex<N>& vertex) {
  const SurfaceMaterial& material = scene.materials[vertex.hit.surface];
  const bool bounds_body = material.interior != SurfaceMaterial::kNone;
  if (bounds_body || !contacts.empty()) {
    if (!enter_boundary(scene, contacts, vertex.front, vertex) && bounds_body &&
        (material.index_matched_only || !scene.interiors[material.interior].index_matched)) {
      return false;
    }
  } else if (!vertex.beyond.empty() && !scene.is_medium(vertex.hit.surface)) {
    // A pane, a mirror or paint under water.
    const std::uint32_t around = vertex.beyond.current(scene.interiors);
    vertex.shading.index_from = index_in(scene, around, vertex.shading.wavelengths);
    vertex.shading.index_to = vertex.shading.index_from;
  }
  if (material.boundary != SurfaceMaterial::kNone) {
    const Interior& between = scene.interiors[material.boundary];
    const Spectral<N>& wavelengths = vertex.shading.wavelengths;
    vertex.shading.index_from = (vertex.front ? between.outside : between.index)(wavelengths);
    vertex.shading.index_to = (vertex.front ? between.index : between.outside)(wavelengths);
  }
  if (material.needs_detail) set_shading_frame(scene, material, group, time, vertex.front, vertex);
  vertex.wo = vertex.frame.to_local(-group.ray.direction);
  return true;
}

/// Empty where the surface is not seen.
template <int N>
std::optional<Vertex<N>> make_vertex(const Scene& scene, const Hit& hit, const Contacts& contacts,
                                     const Group<N>& group, const Spectral<N>& wavelengths,
                                     float time, Transport transport) {
  std::optional<Vertex<N>> vertex(vertex_at(scene, hit, group, wavelengths, transport));
  if (!complete(scene, contacts, group, time, *vertex)) vertex.reset();
  return vertex;
}

}  // namespace nocturne
