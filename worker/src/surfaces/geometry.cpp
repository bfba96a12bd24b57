#include "surfaces/geometry.h"

#include <algorithm>
#include <array>
#include <utility>

#include "math/box.h"
#include "surfaces/embree_scene.h"
#include "surfaces/exact_search.h"
#include "surfaces/packets.h"

namespace nocturne {

namespace {

// Rays in some array of a function's own.
constexpr std::size_t kSome = 64;

}  // namespace

Geometry::Geometry(std::vector<Shape> shapes) {
  std::vector<std::uint32_t> in_scene(shapes.size(), 0);
  embree_ = std::make_unique<EmbreeScene>(std::move(shapes), in_scene, std::vector<Instance>{},
                                          std::stop_token{});
}
Geometry::Geometry(std::vector<Shape> shapes, std::vector<std::uint32_t> groups,
                   std::vector<Instance> instances, std::stop_token stop)
    : embree_(
          std::make_unique<EmbreeScene>(std::move(shapes), groups, std::move(instances), stop)) {}
Geometry::~Geometry() = default;
Geometry::Geometry(Geometry&&) noexcept = default;

Geometry::Ball Geometry::bounds() const {
  RTCLinearBounds all;
  rtcGetSceneLinearBounds(embree_->scene, &all);
  if (!(all.bounds0.lower_x <= all.bounds0.upper_x)) return {};  // nothing is shown
  Box box;
  for (const RTCBounds& b : {all.bounds0, all.bounds1}) {
    box.add({{b.lower_x, b.lower_y, b.lower_z}, {b.upper_x, b.upper_y, b.upper_z}});
  }
  // A little more, so that nothing touches it.
  return {box.middle(), 0.5005f * length(box.high - box.low)};
}

void Geometry::set_close(std::vector<CloseSurface> close) {
  embree_->largest_reach = 0.0f;
  for (const CloseSurface& each : close) {
    embree_->largest_reach = std::max(embree_->largest_reach, each.reach);
  }
  embree_->close = std::move(close);
}
const CloseSurface& Geometry::close(std::uint32_t surface) const { return embree_->close[surface]; }
bool Geometry::any_close() const { return embree_->largest_reach > 0.0f; }

void Geometry::intersect(std::span<const TimedRay> rays, std::span<std::optional<Hit>> hits) const {
  if (!any_close()) return intersect_packets(*embree_, rays, hits);
  // Those that depart exactly are searched for one by one, the others together.
  std::array<TimedRay, kSome> others;
  std::array<std::size_t, kSome> places;
  std::array<std::optional<Hit>, kSome> found;
  std::size_t waiting = 0;
  const auto search_others = [&] {
    intersect_packets(*embree_, std::span(others).first(waiting), found);
    for (std::size_t i = 0; i < waiting; ++i) hits[places[i]] = found[i];
    waiting = 0;
  };
  for (std::size_t i = 0; i < rays.size(); ++i) {
    if (rays[i].departure != nullptr && rays[i].departure->exact) {
      hits[i] = nearest_ahead(*embree_, rays[i].ray, rays[i].time, *rays[i].departure);
      continue;
    }
    others[waiting] = rays[i];
    places[waiting++] = i;
    if (waiting == kSome) search_others();
  }
  if (waiting > 0) search_others();
}

void Geometry::occluded(std::span<const TimedRay> rays, std::span<std::uint8_t> blocked,
                        RayCoherence coherence) const {
  std::fill_n(blocked.begin(), rays.size(), std::uint8_t{0});
  occluded_packets(embree_->scene, rays, blocked, coherence);
}

std::optional<Hit> Geometry::intersect(const Ray& ray, float time) const {
  const TimedRay one{ray, time};
  std::optional<Hit> hit;
  intersect_packets(*embree_, std::span(&one, 1), std::span(&hit, 1));
  return hit;
}

std::optional<Hit> Geometry::intersect(const Ray& ray, float time,
                                       const Departure& departure) const {
  return departure.exact ? nearest_ahead(*embree_, ray, time, departure) : intersect(ray, time);
}

DepartingRay Geometry::depart(const Hit& hit, Vec3 direction, float time) const {
  if (!(close(hit.surface).reach > 0.0f)) return {{leave_surface(hit, direction), direction}, {}};
  const auto point = [&](const Shape& shape, const Placement* placement) {
    return exact_point(shape, placement, hit, time);
  };
  DepartingRay ray = DepartingRay::from(
      embree_->with_placement(hit.surface, hit.instance, time, point), direction);
  ray.departure.surface = hit.surface;
  ray.departure.instance = hit.instance;
  ray.departure.primitive = hit.primitive;
  return ray;
}

std::size_t Geometry::crossings_near(const Ray& ray, float time, const Departure& departure,
                                     const Hit& hit, float reach,
                                     std::span<NearCrossing> found) const {
  return nocturne::crossings_near(*embree_, ray, time, departure, hit, reach, found);
}

SurfaceDetail Geometry::detail(const Hit& hit, float time) const {
  const Shape& shape = embree_->shapes[hit.surface];
  if (hit.instance == Hit::kNoInstance) return surface_detail(shape, nullptr, hit, time);
  const Placement placement = embree_->instances[hit.instance].placement(time);
  return surface_detail(shape, &placement, hit, time);
}

std::span<const Shape> Geometry::shapes() const { return embree_->shapes; }
std::span<const PlacedInstance> Geometry::instances() const { return embree_->instances; }

std::string Geometry::library() {
  const RTCDevice device = new_device();
  const auto version = rtcGetDeviceProperty(device, RTC_DEVICE_PROPERTY_VERSION);
  rtcReleaseDevice(device);
  return "Embree " + std::to_string(version) + ' ' + kDeviceConfiguration;
}

}  // namespace nocturne
