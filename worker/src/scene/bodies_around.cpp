#include "scene/bodies_around.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "scene/contacts.h"
#include "scene/places.h"
#include "scene/sensor_extents.h"
#include "surfaces/octahedron.h"
#include "surfaces/sphere_intersection.h"
#include "surfaces/triangle_at.h"

namespace nocturne {
namespace {

InteriorList left_by(const Bodies& bodies, DepartingRay from, float time) {
  constexpr int kMaxSurfaces = 10'000;
  const auto& [geometry, materials, interiors, everywhere] = bodies;
  const Vec3 direction = from.ray.direction;
  std::vector<std::uint32_t> entered, left;
  const auto cross = [&](const Crossing& crossing) {
    if (crossing.entering) {
      entered.push_back(crossing.body);
    } else if (const auto found = std::ranges::find(entered, crossing.body);
               found != entered.end()) {
      entered.erase(found);
    } else {
      left.push_back(crossing.body);
    }
  };
  for (int i = 0; i < kMaxSurfaces; ++i) {
    auto hit = geometry.intersect(from.ray, time, from.departure);
    if (!hit) break;
    const Contacts contacts =
        contacts_of(geometry, materials, interiors, from.ray, time, from.departure, *hit);
    from = geometry.depart(*hit, direction, time);
    std::ranges::for_each(contacts, cross);
    const std::uint32_t body = materials[hit->surface].interior;
    if (body != SurfaceMaterial::kNone) cross({body, dot(hit->normal, direction) < 0.0f});
  }
  InteriorList inside = everywhere;
  std::ranges::for_each(left.rbegin(), left.rend(), [&](std::uint32_t b) { inside.enter(b); });
  return inside;
}

// No axis, no diagonal: few scenes have edges there.
Vec3 a_direction() { return normalized(Vec3{0.5317f, 0.7621f, 0.3694f}); }

Bodies bodies_of(const Scene& scene) {
  return {scene.geometry, scene.materials, scene.interiors, scene.everywhere};
}

// A point of a surface at the first time, as if it had been hit.
Hit a_point_on(const Shape& shape, const PlacedInstance* instance, std::uint32_t surface,
               const Geometry& geometry) {
  constexpr float kU = 0.3f, kV = 0.3f;
  Vec3 point, normal;
  const auto of_mesh = [&](const TriangleMesh& mesh) {
    const auto& t = mesh.triangles.front();
    const Double3 a(placed(instance, 0.0f, mesh.vertices[t[0]]));
    const Double3 ab = Double3(placed(instance, 0.0f, mesh.vertices[t[1]])) - a;
    const Double3 ac = Double3(placed(instance, 0.0f, mesh.vertices[t[2]])) - a;
    normal = cross(ab, ac).normalized().rounded();
    point = (a + double{kU} * ab + double{kV} * ac).rounded();
  };
  const auto of_sphere = [&](const Sphere& s) {
    const Double3 out = fold(kU, kV);
    const Double3 at = Double3{s.x, s.y, s.z} + s.radius * out;
    const auto placement =
        instance == nullptr ? std::nullopt : std::optional(instance->placement(0.0f));
    point = (placement ? placement->point_to_scene(at) : at).rounded();
    normal = normalized((placement ? placement->normal_to_scene(out) : out).rounded());
  };
  visit_shape(shape, of_mesh, of_sphere);
  return {.position = point,
          .normal = normal,
          .surface = surface,
          .distance = 0.0f,
          .clearance = 1e-5f * std::max(max_abs(point), 1e-3f),
          .instance = index_of(geometry, instance),
          .primitive = 0,
          .u = kU,
          .v = kV};
}

// A box that holds the points at all times. Corners that move linearly within a placement that
// moves linearly too stay in the box around their whole placed trajectories.
Box box_of(std::span<const Vec3> points, const PlacedInstance* instance) {
  Box own;
  for (const Vec3 p : points) own.add(p);
  if (instance == nullptr) return own;
  Box box;
  for (std::size_t step = 0; step < instance->time_steps(); ++step) {
    const Placement placement = instance->placement_at_step(step);
    for (int i = 0; i < 8; ++i) {
      box.add(placement
                  .point_to_scene({i & 1 ? own.high.x : own.low.x, i & 2 ? own.high.y : own.low.y,
                                   i & 4 ? own.high.z : own.low.z})
                  .rounded());
    }
  }
  return box;
}

Box box_of(const TriangleMesh& mesh, std::uint32_t triangle, const PlacedInstance* instance) {
  std::vector<Vec3> corners;
  for (std::size_t step = 0; step < mesh.time_steps; ++step) {
    for (const std::uint32_t i : mesh.triangles[triangle]) {
      corners.push_back(mesh.vertices[step * mesh.vertex_count() + i]);
    }
  }
  return box_of(corners, instance);
}

std::vector<Vec3> centres(const Sphere& sphere) {
  std::vector<Vec3> all;
  for (std::size_t i = 0; i <= sphere.later_centres.size(); ++i) {
    all.push_back(centre_at_step(sphere, i).rounded());
  }
  return all;
}

}  // namespace

Box whole_box_of(const Shape& shape, const PlacedInstance* instance) {
  return visit_shape(
      shape, [&](const TriangleMesh& mesh) { return box_of(mesh.vertices, instance); },
      [&](const Sphere& sphere) {
        const auto r = static_cast<float>(sphere.radius);
        std::vector<Vec3> ends;
        for (const Vec3 c : centres(sphere)) {
          ends.push_back(c - Vec3{r, r, r});
          ends.push_back(c + Vec3{r, r, r});
        }
        return box_of(ends, instance);
      });
}

namespace {

// What float coordinates leave unknown, and what starts a little off a surface.
float reach_of(const Box& a, const Box& b) {
  constexpr float kRounding = 0x1p-18f;
  return kRounding * std::max({max_abs(a.low), max_abs(a.high), max_abs(b.low), max_abs(b.high)});
}

// A ball that moves from one step to the next: the nearest and the farthest point of a box from the
// box of its centres.
bool sphere_crosses(const Sphere& sphere, const Box& box) {
  const auto far_apart = [](float low_a, float high_a, float low_b, float high_b) {
    return std::max(high_a - low_b, high_b - low_a);
  };
  const auto apart = [](float low_a, float high_a, float low_b, float high_b) {
    return std::max({0.0f, low_a - high_b, low_b - high_a});
  };
  const std::vector<Vec3> way = centres(sphere);
  const auto radius = static_cast<float>(sphere.radius);
  for (std::size_t i = 0; i < way.size(); ++i) {
    Box c;
    c.add(way[i]);
    c.add(way[std::min(i + 1, way.size() - 1)]);
    const auto each = [&](const auto& f) {
      return length(Vec3{f(box.low.x, box.high.x, c.low.x, c.high.x),
                         f(box.low.y, box.high.y, c.low.y, c.high.y),
                         f(box.low.z, box.high.z, c.low.z, c.high.z)});
    };
    const float reach = reach_of(box, c) + 0x1p-18f * radius;
    if (each(apart) <= radius + reach && each(far_apart) >= radius - reach) return true;
  }
  return false;
}

bool crosses(const Shape& shape, const PlacedInstance* instance, std::vector<Box> boxes) {
  const Box all = around(boxes), whole = whole_box_of(shape, instance);
  const float reach = reach_of(all, whole);
  if (!reaches(all, whole, reach)) return false;
  std::erase_if(boxes, [&](const Box& box) { return !reaches(box, whole, reach); });
  const auto mesh_crosses = [&](const TriangleMesh& mesh) {
    std::vector<Box> triangles;
    for (std::uint32_t i = 0; i < mesh.triangles.size(); ++i) {
      triangles.push_back(box_of(mesh, i, instance));
      if (!reaches(triangles.back(), all, reach)) triangles.pop_back();
    }
    const auto meet = [](const Box&, const Box&) { return true; };
    return BoxTree(std::move(triangles)).any_pair_with(BoxTree(std::move(boxes)), reach, meet);
  };
  return visit_shape(shape, mesh_crosses, [&](const Sphere& sphere) {
    return instance != nullptr ? !boxes.empty() : std::ranges::any_of(boxes, [&](const Box& box) {
      return sphere_crosses(sphere, box);
    });
  });
}

// Whether the boundary of a body may pass through any of the boxes, at any time.
bool any_boundary_crosses(const Bodies& bodies, std::span<const std::uint32_t> groups,
                          const std::vector<Box>& boxes, std::uint32_t but_surface) {
  const auto shapes = bodies.geometry.shapes();
  for (std::uint32_t i = 0; i < shapes.size(); ++i) {
    if (i == but_surface || bodies.materials[i].interior == SurfaceMaterial::kNone) {
      continue;
    }
    bool found = false;
    for_each_place(bodies.geometry, groups[i], [&](const PlacedInstance* instance) {
      found = found || crosses(shapes[i], instance, boxes);
    });
    if (found) return true;
  }
  return false;
}

// Of all places, each by its triangles where these are few.
std::vector<Box> boxes_of(const Bodies& bodies, const Shape& shape, std::uint32_t group) {
  constexpr std::size_t kFew = 64;
  std::vector<Box> boxes;
  for_each_place(bodies.geometry, group, [&](const PlacedInstance* instance) {
    const auto whole = [&] { boxes.push_back(whole_box_of(shape, instance)); };
    const auto triangles = [&](const TriangleMesh& mesh) {
      if (group != 0 && mesh.triangles.size() > kFew) return whole();
      for (std::uint32_t i = 0; i < mesh.triangles.size(); ++i) {
        boxes.push_back(box_of(mesh, i, instance));
      }
    };
    visit_shape(shape, triangles, [&](const Sphere&) { whole(); });
  });
  return boxes;
}

}  // namespace

InteriorList bodies_around(const Bodies& bodies, Vec3 position, float time) {
  return left_by(bodies, {{position, a_direction()}, {}}, time);
}

InteriorList bodies_around(const Bodies& bodies, const Hit& on, Vec3 towards, float time) {
  Vec3 direction = a_direction();
  if (dot(on.normal, direction) * dot(on.normal, towards) < 0.0f) direction = -direction;
  return left_by(bodies, bodies.geometry.depart(on, direction, time), time);
}

SensorSurroundings sensor_surroundings(const Bodies& bodies, std::span<const std::uint32_t> groups,
                                       const Sensor& sensor, Vec3 start) {
  SensorSurroundings around{bodies_around(bodies, start, 0.0f), false};
  if (!bodies.interiors.empty()) {
    around.differ = any_boundary_crosses(bodies, groups, boxes_of_starts(sensor), ~0u);
  }
  return around;
}

std::vector<LuminaireSurroundings> luminaire_surroundings(
    const Bodies& bodies, std::span<const std::uint32_t> groups,
    const std::vector<Luminaire>& luminaires) {
  std::vector<LuminaireSurroundings> all;
  for (const Luminaire& luminaire : luminaires) {
    LuminaireSurroundings& around = all.emplace_back();
    if (bodies.interiors.empty()) continue;
    const std::uint32_t surface = luminaire.surface, group = groups[surface];
    const Shape& shape = bodies.geometry.shapes()[surface];
    bool first = true;
    for_each_place(bodies.geometry, group, [&](const PlacedInstance* instance) {
      const Hit on = a_point_on(shape, instance, surface, bodies.geometry);
      const InteriorList in_front = bodies_around(bodies, on, on.normal, 0.0f);
      const InteriorList behind =
          luminaire.two_sided() ? bodies_around(bodies, on, -on.normal, 0.0f) : in_front;
      if (std::exchange(first, false)) {
        around.in_front = in_front;
        around.behind = behind;
        return;
      }
      // Several of what bounds a body itself may overlap.
      around.differ = around.differ || !(around.in_front == in_front && around.behind == behind) ||
                      bodies.materials[surface].interior != SurfaceMaterial::kNone;
    });
    around.differ = around.differ ||
                    any_boundary_crosses(bodies, groups, boxes_of(bodies, shape, group), surface);
  }
  return all;
}

InteriorList bodies_at_sensor(const Scene& scene, Film film, Vec3 start, float time) {
  const bool too_wide = film.width > kMaxAspect * film.height && !scene.interiors.empty();
  if (!scene.sensor_around.differ && !too_wide) return scene.sensor_around.inside;
  return bodies_around(bodies_of(scene), start, time);
}

InteriorList bodies_at_luminaire(const Scene& scene, std::uint32_t luminaire, const Hit& from,
                                 Vec3 direction, float time) {
  const LuminaireSurroundings& around = scene.luminaires_around[luminaire];
  if (around.differ) return bodies_around(bodies_of(scene), from, direction, time);
  return dot(from.normal, direction) < 0.0f ? around.behind : around.in_front;
}

}  // namespace nocturne
