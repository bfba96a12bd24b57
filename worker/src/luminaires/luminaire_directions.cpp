#include "luminaires/luminaire_directions.h"

#include <algorithm>
#include <cmath>

#include "math/constants.h"
#include "math/frame.h"
#include "pdfs/directions.h"
#include "surfaces/sphere_intersection.h"

namespace nocturne {
namespace {

// Up to here testing each patch is cheaper than a walk through a tree (a walk costs about 100 ns, a
// patch 4 ns).
constexpr std::size_t kMostPatchesTestedOneByOne = 16;

// The cone under which a sphere is seen from outside: 1 - cos of its half angle, from its sine
// without cancellation.
double one_minus_cosine(double sin2) { return sin2 / (1.0 + std::sqrt(1.0 - sin2)); }

// The power per area of a luminaire, up to a constant.
float weight_per_area(const Luminaire& luminaire) {
  return luminaire.radiance.mean() * (luminaire.two_sided ? 2.0f : 1.0f);
}

struct View {
  double x, y, z, distance2;

  View(const Sphere& s, Vec3 from)
      : x(s.x - from.x), y(s.y - from.y), z(s.z - from.z), distance2(x * x + y * y + z * z) {}
};

Vec3 sample_ball(const Sphere& sphere, Vec3 position, float u1, float u2) {
  const View view(sphere, position);
  const double sin2 = sphere.radius * sphere.radius / view.distance2;
  // From inside every direction meets the sphere once.
  if (sin2 >= 1.0) return direction_from_z(1.0f - 2.0f * u1, u2);
  const double drop = u1 * one_minus_cosine(sin2);
  const double sin_theta = std::sqrt(drop * (2.0 - drop));
  const double phi = 2.0 * std::numbers::pi * u2;
  const double inverse = 1.0 / std::sqrt(view.distance2);
  const Frame frame({static_cast<float>(view.x * inverse), static_cast<float>(view.y * inverse),
                     static_cast<float>(view.z * inverse)});
  return frame.to_world({static_cast<float>(sin_theta * std::cos(phi)),
                         static_cast<float>(sin_theta * std::sin(phi)),
                         static_cast<float>(1.0 - drop)});
}

float ball_pdf(const Sphere& sphere, Vec3 position, Vec3 direction) {
  const View view(sphere, position);
  const double sin2 = sphere.radius * sphere.radius / view.distance2;
  if (sin2 >= 1.0) return 0.25f * kInvPi;
  const auto crossings = cross_sphere(sphere, position.x, position.y, position.z, direction.x,
                                      direction.y, direction.z);
  if (!crossings || crossings->near <= 0.0) return 0.0f;
  return static_cast<float>(1.0 / (2.0 * std::numbers::pi * one_minus_cosine(sin2)));
}

}  // namespace

LuminaireDirections::LuminaireDirections(std::span<const Luminaire> luminaires,
                                         std::span<const Shape> shapes) {
  for (const Luminaire& luminaire : luminaires) {
    const auto* mesh = std::get_if<TriangleMesh>(&shapes[luminaire.surface]);
    if (mesh) add_mesh(*mesh, weight_per_area(luminaire));
  }
  for (const Luminaire& luminaire : luminaires) {
    const auto* sphere = std::get_if<Sphere>(&shapes[luminaire.surface]);
    if (sphere) add_ball(*sphere, weight_per_area(luminaire));
  }
  normalise_weights();
  if (patches_.size() > kMostPatchesTestedOneByOne) index_patches(luminaires, shapes);
}

void LuminaireDirections::add_mesh(const TriangleMesh& mesh, float weight) {
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
    const auto& t = mesh.triangles[i];
    const Vec3 a = mesh.vertices[t[0]], b = mesh.vertices[t[1]], c = mesh.vertices[t[2]];
    // Two triangles (a, b, c), (a, c, d) that make a parallelogram are one patch: half the tests.
    if (i + 1 < mesh.triangles.size()) {
      const auto& next = mesh.triangles[i + 1];
      if (next[0] == t[0] && next[1] == t[2]) {
        const Vec3 gap = (mesh.vertices[next[2]] - a) - (c - b);
        if (gap.x == 0.0f && gap.y == 0.0f && gap.z == 0.0f) {
          add_patch(a, b - a, c - b, false, weight);
          ++i;
          continue;
        }
      }
    }
    add_patch(a, b - a, c - a, true, weight);
  }
}

void LuminaireDirections::add_patch(Vec3 corner, Vec3 edge_u, Vec3 edge_v, bool triangle,
                                    float weight) {
  const Vec3 n = cross(edge_u, edge_v);
  const float n2 = dot(n, n);
  if (!(n2 > 0.0f)) return;  // no area, never drawn
  const float inverse = 1.0f / n2;
  const float n_length = std::sqrt(n2);
  patches_.push_back({corner, edge_u, edge_v, n, inverse * cross(edge_v, n),
                      inverse * cross(n, edge_u), n_length, weight, triangle});
  weights_.push_back(static_cast<double>(weight) * n_length * (triangle ? 0.5 : 1.0));
}

void LuminaireDirections::add_ball(const Sphere& sphere, float weight) {
  balls_.push_back({sphere, 0.0f});
  weights_.push_back(weight * 4.0 * std::numbers::pi * sphere.radius * sphere.radius);
}

void LuminaireDirections::normalise_weights() {
  double total = 0.0;
  for (const double weight : weights_) total += weight;
  if (!(total > 0.0)) {  // all dark: nothing worth pointing at
    patches_.clear();
    balls_.clear();
    weights_.clear();
    return;
  }
  double sum = 0.0;
  for (std::size_t i = 0; i < weights_.size(); ++i) {
    sum += weights_[i];
    cumulative_.push_back(static_cast<float>(sum / total));
    if (i < patches_.size()) {
      patches_[i].area_density = static_cast<float>(patches_[i].area_density / total);
    } else {
      balls_[i - patches_.size()].probability = static_cast<float>(weights_[i] / total);
    }
  }
  cumulative_.back() = 1.0f;
  total_ = total;
  weights_ = {};
}

void LuminaireDirections::index_patches(std::span<const Luminaire> luminaires,
                                        std::span<const Shape> shapes) {
  std::vector<Shape> meshes;
  for (const Luminaire& luminaire : luminaires) {
    if (!std::holds_alternative<TriangleMesh>(shapes[luminaire.surface])) continue;
    meshes.push_back(shapes[luminaire.surface]);
    tree_density_.push_back(static_cast<float>(weight_per_area(luminaire) / total_));
  }
  tree_ = std::make_unique<Geometry>(std::move(meshes), Geometry::Queries::kCrossings);
}

std::optional<Vec3> LuminaireDirections::sample(Vec3 position, float choice, float u1,
                                                float u2) const {
  if (cumulative_.empty()) return std::nullopt;
  const auto chosen = static_cast<std::size_t>(
      std::upper_bound(cumulative_.begin(), cumulative_.end() - 1, choice) - cumulative_.begin());
  if (chosen >= patches_.size()) {
    return sample_ball(balls_[chosen - patches_.size()].sphere, position, u1, u2);
  }
  const Patch& patch = patches_[chosen];
  float u = u1, v = u2;
  if (patch.triangle) {
    const float root = std::sqrt(u1);
    u = 1.0f - root;
    v = u2 * root;
  }
  const Vec3 to = patch.corner + u * patch.edge_u + v * patch.edge_v - position;
  const float distance = length(to);
  if (!(distance > 0.0f)) return std::nullopt;
  return (1.0f / distance) * to;
}

float LuminaireDirections::Patch::pdf(Vec3 position, Vec3 direction) const {
  const float towards = dot(direction, normal);
  const Vec3 to_corner = corner - position;
  const float t = dot(to_corner, normal) / towards;
  if (!(t > 0.0f) || std::isinf(t)) return 0.0f;  // behind, or parallel (NaN and infinity)
  const Vec3 q = t * direction - to_corner;
  const float u = dot(q, dual_u), v = dot(q, dual_v);
  if (u < 0.0f || v < 0.0f || (triangle ? u + v > 1.0f : (u > 1.0f || v > 1.0f))) return 0.0f;
  return area_density * t * t * normal_length / std::fabs(towards);
}

float LuminaireDirections::pdf(Vec3 position, Vec3 direction) const {
  float sum = 0.0f;
  if (tree_) {
    tree_->for_each_triangle_crossing({position, direction}, [&](const TriangleCrossing& crossing) {
      if (crossing.cosine > 0.0f) {
        sum +=
            tree_density_[crossing.shape] * crossing.distance * crossing.distance / crossing.cosine;
      }
    });
  } else {
    for (const Patch& patch : patches_) sum += patch.pdf(position, direction);
  }
  for (const Ball& ball : balls_) {
    sum += ball.probability * ball_pdf(ball.sphere, position, direction);
  }
  return sum;
}

}  // namespace nocturne
