#include "luminaires/photon_emitter.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>

#include "math/time_steps.h"
#include "surfaces/octahedron.h"
#include "surfaces/sphere_intersection.h"

namespace nocturne {
namespace {

// Between the time steps around `time`.
Vec3 corner_at(std::span<const Vec3> corners, std::size_t index, float time) {
  const std::size_t steps = corners.size() / 3;
  if (steps == 1) return corners[index];
  const auto [step, t] = segment_at(time, steps);
  const Vec3 before = corners[step * 3 + index], after = corners[(step + 1) * 3 + index];
  return before + t * (after - before);
}

// How much larger than in its group a piece of surface is: the normal is stretched by the inverse
// transposed, so areas by that times the determinant.
double area_factor(const Placement& placement, double stretched_normal) {
  return std::fabs(placement.linear.determinant()) * stretched_normal;
}

// Mean over the six ends of the group's axes.
double mean_area_factor(const Placement& placement) {
  if (!placement.valid()) return 0.0;
  double sum = 0.0;
  for (const Double3 axis : {Double3{1, 0, 0}, Double3{0, 1, 0}, Double3{0, 0, 1}}) {
    sum += area_factor(placement, length(placement.normal_to_scene(axis)));
  }
  return sum / 3.0;
}

// Half of all flux as it is, half of it the same for each light group that has any.
void share_among_groups(std::vector<double>& fluxes, const std::vector<std::uint32_t>& groups) {
  std::map<std::uint32_t, double> of_group;
  double total = 0.0;
  for (std::size_t i = 0; i < fluxes.size(); ++i) {
    if (!(fluxes[i] > 0.0)) continue;
    of_group[groups[i]] += fluxes[i];
    total += fluxes[i];
  }
  const auto count = static_cast<double>(of_group.size());
  for (std::size_t i = 0; i < fluxes.size(); ++i) {
    if (!(fluxes[i] > 0.0)) continue;
    fluxes[i] *= 0.5 + 0.5 * total / (count * of_group[groups[i]]);
  }
}

}  // namespace

void PhotonEmitter::add(Element element, const Luminaire& what) {
  const Emission emission = what.emission();
  const double flux =
      std::numbers::pi * emission.radiance * element.area * (what.two_sided() ? 2.0 : 1.0);
  if (!(flux > 0.0)) return;
  add(flux, what.light_group);
  elements_.push_back(std::move(element));
}

void PhotonEmitter::add(double flux, std::uint32_t light_group) {
  fluxes_.push_back(flux);
  groups_.push_back(light_group);
}

void PhotonEmitter::add_triangle(std::uint32_t luminaire, const Luminaire& what,
                                 std::vector<std::array<Vec3, 3>> corners, Triangle triangle) {
  // At its largest, so that what grows is not left to a few photons of large weight.
  float area = 0.0f;
  for (const auto& [a, b, c] : corners) {
    const double twice = length(cross(Double3(b) - Double3(a), Double3(c) - Double3(a)));
    area = std::max(area, static_cast<float>(0.5 * twice));
  }
  Element element{luminaire, area, {}, {}, triangle};
  for (const auto& moment : corners) {
    element.corners.insert(element.corners.end(), moment.begin(), moment.end());
  }
  add(std::move(element), what);
}

void PhotonEmitter::add_sphere(std::uint32_t luminaire, const Luminaire& what, const Sphere& sphere,
                               const Geometry& geometry, std::uint32_t instance) {
  double area = 4.0 * std::numbers::pi * sphere.radius * sphere.radius;
  if (instance != Hit::kNoInstance) {
    const PlacedInstance& placed = geometry.instances()[instance];
    double largest = 0.0;
    for (std::size_t step = 0; step < placed.time_steps(); ++step) {
      largest = std::max(largest, mean_area_factor(placed.placement_at_step(step)));
    }
    area *= largest;
  }
  add({luminaire, static_cast<float>(area), {}, sphere, {instance, 0}}, what);
}

void PhotonEmitter::finish(const LightSampler& lights, Geometry::Ball bounds, bool each_group,
                           std::optional<Geometry::Ball> gathering) {
  distant_start_ = DistantStart(lights.important().elements(), gathering);
  bounds = gathering.value_or(bounds);
  for (const RaySet& rays : rays_) add(rays.mean_flux(), rays.light_group);
  const double disc_area = std::numbers::pi * bounds.radius * bounds.radius;
  for (const DistantDisc& disc : lights.discs()) {
    add(disc_area * disc.irradiance(disc.direction(), false), disc.light_group);
  }
  if (lights.environment()) {
    add(disc_area * 4.0 * std::numbers::pi * lights.environment()->mean_radiance(),
        lights.environment()->light_group);
  }
  if (each_group) share_among_groups(fluxes_, groups_);
  double total = 0.0;
  for (const double flux : fluxes_) total += flux;
  double sum = 0.0;
  for (const double flux : fluxes_) {
    if (!(total > 0.0)) break;
    sum += flux;
    cumulative_.push_back(sum / total);
  }
  if (!cumulative_.empty()) cumulative_.back() = 1.0;
  fluxes_ = {};
  groups_ = {};
}

std::optional<PhotonEmitter::Leaving> PhotonEmitter::leave(const LightSamplingContext& from,
                                                           const AreaLightSampler& important,
                                                           float aimed, const Uniform4& u) {
  Vec3 direction;
  float drawn_pdf = 0.0f;
  if (u[2] < aimed) {
    const auto towards = important.sample(from, u[3], u[0], u[1]);
    if (!towards) return std::nullopt;
    direction = towards->direction;
    drawn_pdf = towards->pdf;
  } else {
    direction = normalized(Frame(from.normal).to_world(CosineHemisphere::sample(u[0], u[1])));
  }
  if (!(aimed > 0.0f)) return Leaving{direction, kPi};
  const float cosine = dot(from.normal, direction);
  const float pdf =
      (1.0f - aimed) * cosine / kPi + aimed * std::max(drawn_pdf, important.pdf(from, direction));
  if (!(cosine > 0.0f && pdf > 0.0f)) return std::nullopt;
  return Leaving{direction, cosine / pdf};
}

PhotonEmitter::Choice PhotonEmitter::choose(float coarse, float fine) const {
  // Uniform floats below 1 keep at least the steps of 2^-24 (sequence.h).
  constexpr double kSteps = 0x1p24;
  const double u = (std::floor(double{coarse} * kSteps) + double{fine}) / kSteps;
  const auto found = std::upper_bound(cumulative_.begin(), cumulative_.end() - 1, u);
  const double start = found == cumulative_.begin() ? 0.0 : *(found - 1);
  const double width = *found - start;
  return {static_cast<std::size_t>(found - cumulative_.begin()), static_cast<float>(width),
          std::clamp(static_cast<float>((u - start) / width), 0.0f, kOneMinusEpsilon)};
}

PhotonEmitter::EmissionPoint PhotonEmitter::point_on_sphere(const Element& element,
                                                            const Geometry& geometry, float time,
                                                            float u, float v) {
  const Sphere& sphere = *element.sphere;
  const Double3 centre = centre_at(sphere, time);
  Hit hit{};
  hit.instance = element.triangle.instance;
  hit.normal = UniformSphere::sample(u, v);
  const auto radius = static_cast<float>(sphere.radius);
  const Vec3 middle = centre.rounded();
  hit.position = middle + radius * hit.normal;
  hit.clearance = kClearanceUnits * (max_abs(middle) + radius);
  const float area = 4.0f * kPi * radius * radius;
  if (hit.instance == Hit::kNoInstance) return {hit, area};
  const Placement placement = geometry.instances()[hit.instance].placement(time);
  if (!placement.valid()) return {hit, 0.0f};
  const Double3 out(hit.normal), normal = placement.normal_to_scene(out);
  const double stretched = length(normal);
  const auto [unfolded_u, unfolded_v] = unfold(out);
  hit.u = unfolded_u;
  hit.v = unfolded_v;
  hit.position = placement.point_to_scene(centre + (sphere.radius / length(out)) * out).rounded();
  hit.normal = ((1.0 / stretched) * normal).rounded();
  hit.clearance =
      kClearanceUnits * max_abs(hit.position) + hit.clearance / static_cast<float>(stretched);
  return {hit, area * static_cast<float>(area_factor(placement, stretched))};
}

PhotonEmitter::EmissionPoint PhotonEmitter::point_on(const Element& element,
                                                     const Geometry& geometry, float time, float u,
                                                     float v) {
  if (element.sphere) return point_on_sphere(element, geometry, time, u, v);
  Hit hit{};
  hit.instance = element.triangle.instance;
  hit.primitive = element.triangle.primitive;
  const Vec3 corner = corner_at(element.corners, 0, time);
  const Double3 edge_u = Double3(corner_at(element.corners, 1, time)) - Double3(corner);
  const Double3 edge_v = Double3(corner_at(element.corners, 2, time)) - Double3(corner);
  const float root = std::sqrt(u);
  hit.u = 1.0f - root;
  hit.v = v * root;
  hit.position = (Double3(corner) + hit.u * edge_u + hit.v * edge_v).rounded();
  const Double3 across = cross(edge_u, edge_v);
  const double twice_the_area = length(across);
  hit.normal = ((1.0 / twice_the_area) * across).rounded();
  hit.clearance =
      kClearanceUnits *
      (max_abs(hit.position) + static_cast<float>(std::max(max_abs(edge_u), max_abs(edge_v))));
  return {hit, static_cast<float>(0.5 * twice_the_area)};
}

}  // namespace nocturne
