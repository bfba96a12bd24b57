#include "scene/contacts.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <tuple>

namespace nocturne {
namespace {

// Of normals: surfaces that only cross each other have no area in common.
constexpr float kParallel = 0.999f;
// At more grazing incidence the reach along the ray is not that much longer.
constexpr float kMinCosine = 1e-3f;
constexpr std::size_t kMaxNear = 24;

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
  if (const auto* mesh = std::get_if<TriangleMesh>(&shape)) {
    for (const Vec3 v : mesh->vertices) extent.add(Double3(v));
  } else {
    const auto& sphere = std::get<Sphere>(shape);
    const Double3 half{sphere.radius, sphere.radius, sphere.radius};
    const auto add = [&](Double3 centre) {
      extent.add(centre - half);
      extent.add(centre + half);
    };
    add({sphere.x, sphere.y, sphere.z});
    for (const Double3 later : sphere.later_centres) add(later);
  }
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

// Whether photons that start off `a` may step over `b`.
bool reaches(const Extent& a, const Extent& b) {
  const Double3 gap_up = b.lower - a.upper, gap_down = a.lower - b.upper;
  return std::max({gap_up.x, gap_up.y, gap_up.z, gap_down.x, gap_down.y, gap_down.z}) <=
         a.clearance;
}

bool is_body(const SurfaceMaterial& material) {
  return material.medium_interface != SurfaceMaterial::kNone;
}

}  // namespace

void find_contacts(const Geometry& geometry, std::span<const std::uint32_t> groups,
                   std::vector<SurfaceMaterial>& materials) {
  const std::size_t surfaces = geometry.shapes().size();
  if (std::none_of(materials.begin(), materials.end(), is_body)) return;
  const std::vector<Extent> extents = extents_of(geometry, groups);
  for (std::size_t i = 0; i < surfaces; ++i) {
    SurfaceMaterial& material = materials[i];
    if (!is_body(material) && !material.may_pass) continue;
    for (std::size_t j = 0; j < surfaces; ++j) {
      // A surface that is shown more than once may touch itself.
      if (i == j ? extents[i].count < 2 : !reaches(extents[i], extents[j])) continue;
      if (!is_body(material) && !is_body(materials[j])) continue;
      material.contact_reach = static_cast<float>(extents[i].clearance);
    }
  }
}

Contacts search_contacts(const Geometry& geometry, std::span<const SurfaceMaterial> materials,
                         std::span<const MediumInterface> medium_interfaces, const Ray& ray,
                         float time, Hit& hit) {
  std::array<Hit, kMaxNear> near;
  const float cosine = std::max(kMinCosine, std::fabs(dot(hit.normal, ray.direction)));
  const float reach =
      (materials[hit.surface].contact_reach + kClearanceUnits * hit.distance) / cosine;
  std::size_t count = geometry.others_near(ray, time, hit, reach, near);
  const auto apart = [&hit](const Hit& other) {
    return std::fabs(dot(hit.normal, other.normal)) < kParallel ||
           std::fabs(dot(hit.normal, other.position - hit.position)) > hit.clearance;
  };
  const auto end =
      std::remove_if(near.begin(), near.begin() + static_cast<std::ptrdiff_t>(count), apart);
  Contacts contacts;
  if (end == near.begin()) return contacts;

  // The one that is seen comes first.
  const auto order = [&](const Hit& h) {
    const SurfaceMaterial& material = materials[h.surface];
    const bool body = is_body(material);
    const bool dielectric = body && !medium_interfaces[material.medium_interface].index_matched;
    const int kind = !body ? 0 : dielectric ? 1 : 2;
    const std::int64_t priority = body ? medium_interfaces[material.medium_interface].priority : 0;
    return std::tuple(kind, -priority, h.surface, h.instance, h.primitive);
  };
  const Hit first = hit;
  for (auto other = near.begin(); other != end; ++other) {
    if (order(*other) < order(hit)) hit = *other;
  }
  const auto cross = [&](const Hit& h) {
    hit.clearance = std::max(hit.clearance, h.clearance);
    const std::uint32_t body = materials[h.surface].medium_interface;
    if (body == SurfaceMaterial::kNone) return;
    const Crossing crossing{body, dot(h.normal, ray.direction) < 0.0f};
    // Once at an edge that two triangles share.
    const bool own = body == materials[hit.surface].medium_interface &&
                     crossing.entering == (dot(hit.normal, ray.direction) < 0.0f);
    if (!own) contacts.add(crossing);
  };
  cross(first);
  std::for_each(near.begin(), end, cross);
  return contacts;
}

}  // namespace nocturne
