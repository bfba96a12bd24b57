#include "tracer/learning/gatherers.h"

#include <algorithm>
#include <cmath>
#include <variant>

#include "pdfs/directions.h"
#include "sampling/golden_ratio.h"

namespace nocturne {
namespace {

/// Points in all, and of one shape. 64 points on a ball tell its radius within 13 %
/// (aims_around.cpp).
constexpr std::size_t kMaxPlaces = 4096, kPlacesOfAShape = 64;
/// Part of the scene's radius. A fifth of the area is met by one photon of five that leaves for
/// anywhere, so that aiming brings a factor of five at most.
constexpr float kSmall = 0.5f;

std::vector<Vec3> points_of(const Shape& shape, std::size_t count) {
  std::vector<Vec3> points;
  const auto of_mesh = [&](const TriangleMesh& mesh) {
    const std::size_t vertices = mesh.vertex_count(), step = vertices / count + 1;
    for (std::size_t i = 0; i < vertices; i += step) points.push_back(mesh.vertices[i]);
    // Corners of a box or a pane are too few for a ball around them.
    const std::vector<Vec3> corners = points;
    while (!points.empty() && points.size() < count / 2) {
      points.insert(points.end(), corners.begin(), corners.end());
    }
  };
  visit_shape(shape, of_mesh, [&](const Sphere& sphere) {
    for (std::size_t i = 0; i < count; ++i) {
      const auto step = static_cast<float>(i);
      const Vec3 out =
          UniformSphere::sample((step + 0.5f) / static_cast<float>(count), by_golden_ratio(step));
      points.push_back(
          (Double3{sphere.x, sphere.y, sphere.z} + sphere.radius * Double3(out)).rounded());
    }
  });
  return points;
}

bool small_beside(const Geometry::Ball& all, const std::vector<Vec3>& points) {
  const float scale = 1.0f / static_cast<float>(std::max<std::size_t>(1, points.size()));
  Vec3 middle{};
  for (const Vec3 point : points) middle = middle + scale * point;
  return std::ranges::all_of(
      points, [&](Vec3 point) { return length(point - middle) < kSmall * all.radius; });
}

bool gathers(const Scene& scene, const SurfaceMaterial& material) {
  const auto specular_like = [&](std::uint32_t kernel) {
    return kernel < scene.specular_like.size() && scene.specular_like[kernel];
  };
  return !material.index_matched_only &&
         (material.has_delta_lobe || specular_like(material.front_kernel) ||
          specular_like(material.back_kernel));
}

}  // namespace

std::vector<Vec3> places_on_gatherers(const Scene& scene,
                                      const std::function<std::uint32_t(std::uint32_t)>& group_of) {
  const auto shapes = scene.geometry.shapes();
  std::vector<std::uint32_t> gatherers;
  for (std::uint32_t i = 0; i < shapes.size(); ++i) {
    if (gathers(scene, scene.materials[i])) gatherers.push_back(i);
  }
  std::vector<Vec3> places;
  const std::size_t step = gatherers.size() / kMaxPlaces + 1;
  const Geometry::Ball all = scene.geometry.bounds();
  const auto add = [&](const std::vector<Vec3>& points) {
    if (places.size() < kMaxPlaces && small_beside(all, points)) {
      places.insert(places.end(), points.begin(), points.end());
    }
  };
  for (std::size_t i = 0; i < gatherers.size(); i += step) {
    const std::vector<Vec3> points = points_of(shapes[gatherers[i]], kPlacesOfAShape);
    const std::uint32_t group = group_of(gatherers[i]);
    if (group == 0) add(points);
    for (const PlacedInstance& instance : scene.geometry.instances()) {
      if (instance.group() != group) continue;
      std::vector<Vec3> placed;
      const Placement placement = instance.placement(0.0f);
      for (const Vec3 point : points) {
        placed.push_back(placement.point_to_scene(Double3(point)).rounded());
      }
      add(placed);
    }
  }
  return places;
}

}  // namespace nocturne
