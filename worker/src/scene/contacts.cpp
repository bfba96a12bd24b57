#include "scene/contacts.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <tuple>

#include "surfaces/thin_shapes.h"

namespace nocturne {
namespace {

// At more grazing incidence the reach along the ray is not that much longer.
constexpr float kMinCosine = 1e-3f;
constexpr std::size_t kMaxNear = 24;
// Clearances. Where a medium scatters is rounded, too, and in one of every so many times the
// thickness over the rounding ends up outside of a body: in a hundredth of the width that is one of
// some 1e5, where a face is as near.
constexpr double kThinMedium = 1e4;

// A box at all times, and a bound on the clearance of any hit in it.
struct Extent {
  Double3 lower{kInfinite, kInfinite, kInfinite}, upper{-kInfinite, -kInfinite, -kInfinite};
  double clearance = 0.0;
  int count = 0;

  static constexpr double kInfinite = std::numeric_limits<double>::infinity();

  void add(Double3 p) {
    lower = {std::min(lower.x, p.x), std::min(lower.y, p.y), std::min(lower.z, p.z)};
    upper = {std::max(upper.x, p.x), std::max(upper.y, p.y), std::max(upper.z, p.z)};
  }
  Double3 corner(int i) const {
    return {i & 1 ? upper.x : lower.x, i & 2 ? upper.y : lower.y, i & 4 ? upper.z : lower.z};
  }
  // Coordinate and edge, as clearances are made of (hit.h).
  double reach() const { return std::max(max_abs(lower), max_abs(upper)) + max_abs(upper - lower); }
};

Extent extent_of(const Shape& shape) {
  Extent extent;
  const auto add_mesh = [&](const TriangleMesh& mesh) {
    for (const Vec3 v : mesh.vertices) extent.add(Double3(v));
  };
  visit_shape(shape, add_mesh, [&](const Sphere& sphere) {
    const Double3 half{sphere.radius, sphere.radius, sphere.radius};
    const auto add = [&](Double3 centre) {
      extent.add(centre - half);
      extent.add(centre + half);
    };
    add({sphere.x, sphere.y, sphere.z});
    for (const Double3 later : sphere.later_centres) add(later);
  });
  extent.clearance = kClearanceUnits * extent.reach();
  extent.count = 1;
  return extent;
}

// Of every surface, wherever it is shown.
std::vector<Extent> extents_of(const Geometry& geometry, std::span<const std::uint32_t> groups) {
  std::vector<Extent> own, shown;
  for (const Shape& shape : geometry.shapes()) own.push_back(extent_of(shape));
  shown.resize(own.size());
  for (std::size_t i = 0; i < own.size(); ++i) {
    if (groups[i] == 0) shown[i] = own[i];
  }
  for (const PlacedInstance& instance : geometry.instances()) {
    for (std::size_t i = 0; i < own.size(); ++i) {
      if (groups[i] != instance.group()) continue;
      ++shown[i].count;
      double stretch = 0.0;
      for (std::size_t step = 0; step < instance.time_steps(); ++step) {
        const Placement placement = instance.placement_at_step(step);
        stretch = std::max(stretch, placement.largest_stretch());
        for (int c = 0; c < 8; ++c) shown[i].add(placement.point_to_scene(own[i].corner(c)));
      }
      shown[i].clearance = std::max(
          shown[i].clearance, stretch * own[i].clearance + kClearanceUnits * shown[i].reach());
    }
  }
  return shown;
}

// How close they have to be for single precision not to tell them apart; `seen_from` is the error
// of a hit that is seen from afar.
double reach_of(const Extent& a, const Extent& b, double seen_from) {
  return std::max(a.clearance, b.clearance) + seen_from;
}

bool reaches(const Extent& a, const Extent& b, double seen_from) {
  const Double3 gap_up = b.lower - a.upper, gap_down = a.lower - b.upper;
  return std::max({gap_up.x, gap_up.y, gap_up.z, gap_down.x, gap_down.y, gap_down.z}) <=
         reach_of(a, b, seen_from);
}

// The part of a shape's box that its triangles fill may be far less: whether any of them reaches
// the other's box.
bool any_part_reaches(const Shape& shape, const Extent& whole, const Extent& other,
                      double seen_from) {
  const TriangleMesh* mesh = mesh_at_rest(shape);
  return mesh == nullptr || std::ranges::any_of(mesh->triangles, [&](const auto& triangle) {
           Extent part;
           for (const std::uint32_t corner : triangle) part.add(Double3(mesh->vertices[corner]));
           part.clearance = whole.clearance;
           return reaches(part, other, seen_from);
         });
}

bool is_body(const SurfaceMaterial& material) {
  return material.interior != SurfaceMaterial::kNone;
}

// Photons may be on both sides.
bool is_passed(const SurfaceMaterial& material) { return is_body(material) || material.may_pass; }

}  // namespace

std::vector<CloseSurface> find_close(const Geometry& geometry,
                                     std::span<const std::uint32_t> groups,
                                     const std::vector<SurfaceMaterial>& materials,
                                     std::span<const Interior> interiors, float longest_view) {
  const std::size_t surfaces = geometry.shapes().size();
  std::vector<CloseSurface> close(surfaces);
  for (std::size_t i = 0; i < surfaces; ++i) {
    close[i].body = is_body(materials[i]);
    close[i].luminaire = materials[i].luminaire != SurfaceMaterial::kNone;
    close[i].straight = materials[i].index_matched_only ||
                        (!close[i].body && materials[i].may_pass && materials[i].has_delta_lobe);
  }
  const auto end = materials.begin() + static_cast<std::ptrdiff_t>(surfaces);
  if (std::none_of(materials.begin(), end, is_passed)) return close;
  const std::vector<Extent> extents = extents_of(geometry, groups);
  const double seen_from = kClearanceUnits * static_cast<double>(longest_view);
  const auto meet = [&](std::size_t i, std::size_t j) {
    if (!reaches(extents[i], extents[j], seen_from)) return false;
    const Shape &one = geometry.shapes()[i], &other = geometry.shapes()[j];
    return (groups[i] != 0 || any_part_reaches(one, extents[i], extents[j], seen_from)) &&
           (groups[j] != 0 || any_part_reaches(other, extents[j], extents[i], seen_from)) &&
           (groups[i] != 0 || groups[j] != 0 ||
            may_be_close(one, other, reach_of(extents[i], extents[j], seen_from)));
  };
  const auto set = [&](std::size_t i) {
    close[i].reach = static_cast<float>(extents[i].clearance);
  };
  for (std::size_t i = 0; i < surfaces; ++i) {
    if (!is_passed(materials[i])) continue;
    const bool media = close[i].body && !interiors[materials[i].interior].media.empty();
    const double thin = (media ? kThinMedium : 2.0) * extents[i].clearance + seen_from;
    // A group that is placed more than once may touch itself.
    if (groups[i] != 0 || may_be_thin(geometry.shapes()[i], thin)) set(i);
    for (std::size_t j = 0; j < surfaces; ++j) {
      if (i == j || (close[i].reach > 0.0f && close[j].reach > 0.0f) || !meet(i, j)) continue;
      set(i);
      set(j);
    }
  }
  return close;
}

Contacts search_contacts(const Geometry& geometry, std::span<const SurfaceMaterial> materials,
                         std::span<const Interior> interiors, const Ray& ray, float time,
                         const Departure& departure, Hit& hit) {
  std::array<NearCrossing, kMaxNear> near;
  const float cosine = std::max(kMinCosine, std::fabs(dot(hit.normal, ray.direction)));
  const float reach = (geometry.close(hit.surface).reach + kClearanceUnits * hit.distance) / cosine;
  const std::size_t count = geometry.crossings_near(ray, time, departure, hit, reach, near);
  Contacts contacts;
  if (count == 0) return contacts;

  // The one that is seen comes first.
  const auto order = [&](const Hit& h) {
    const SurfaceMaterial& material = materials[h.surface];
    const bool body = is_body(material);
    const bool dielectric = body && !interiors[material.interior].index_matched;
    const int kind = !body ? 0 : dielectric ? 1 : 2;
    const std::int64_t priority = body ? interiors[material.interior].priority : 0;
    return std::tuple(kind, -priority, h.surface, h.instance, h.primitive);
  };
  const auto touching = std::span(near).first(count);
  hit = near[0].hit;
  for (const NearCrossing& each : touching) {
    if (each.touches_first && order(each.hit) < order(hit)) hit = each.hit;
  }
  const auto cross = [&](const NearCrossing& crossing) {
    const std::uint32_t body = materials[crossing.hit.surface].interior;
    if (body == SurfaceMaterial::kNone) return;
    const Crossing made{body, crossing.at.entering()};
    // Once at an edge that two triangles share.
    const bool own = body == materials[hit.surface].interior &&
                     made.entering == (dot(hit.normal, ray.direction) < 0.0f);
    if (!own) contacts.add(made);
  };
  for (const NearCrossing& each : touching) {
    if (each.touches_first) cross(each);
  }
  return contacts;
}

}  // namespace nocturne
