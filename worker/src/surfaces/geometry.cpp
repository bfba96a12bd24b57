#include "surfaces/geometry.h"

#include <embree3/rtcore.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <list>
#include <map>
#include <stdexcept>
#include <string>
#include <utility>

#include "math/in_place.h"
#include "surfaces/embree_callbacks.h"
#include "surfaces/locate.h"

namespace nocturne {
namespace {

// One instruction set for all workers, whatever their processor; and one build thread, so that the
// tree, and with it the choice between coincident surfaces, is the same everywhere
// (docs/decisions/0003).
constexpr const char* kDeviceConfiguration = "isa=avx2,threads=1,set_affinity=0";
constexpr const char* kCantStart = "Embree can't start: the processor needs AVX2";

RTCRayHit embree_query(const Ray& ray, float time) {
  RTCRayHit query;
  RTCRay& r = query.ray;
  r.org_x = ray.origin.x;
  r.org_y = ray.origin.y;
  r.org_z = ray.origin.z;
  r.dir_x = ray.direction.x;
  r.dir_y = ray.direction.y;
  r.dir_z = ray.direction.z;
  r.tnear = 0.0f;
  r.tfar = std::numeric_limits<float>::infinity();
  r.time = time;
  r.mask = ~0u;
  r.id = 0;
  r.flags = 0;
  query.hit.geomID = RTC_INVALID_GEOMETRY_ID;
  query.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
  return query;
}

constexpr std::size_t kPacket = 8;

// Rays of a packet have nothing to do with each other: then Embree finds for each what it finds for
// it alone, bit for bit, whatever rays it is with (tests/worker/surfaces/packets_test.cpp).
template <class Packet>
void fill(Packet& packet, std::span<const TimedRay> rays, std::span<int> valid) {
  for (std::size_t i = 0; i < kPacket; ++i) {
    valid[i] = i < rays.size() ? -1 : 0;
    const TimedRay& from = rays[std::min(i, rays.size() - 1)];
    packet.org_x[i] = from.ray.origin.x;
    packet.org_y[i] = from.ray.origin.y;
    packet.org_z[i] = from.ray.origin.z;
    packet.dir_x[i] = from.ray.direction.x;
    packet.dir_y[i] = from.ray.direction.y;
    packet.dir_z[i] = from.ray.direction.z;
    packet.tnear[i] = 0.0f;
    packet.tfar[i] = from.end;
    packet.time[i] = from.time;
    packet.mask[i] = ~0u;
    packet.id[i] = 0;
    packet.flags[i] = 0;
  }
}

// Takes down every hit that a search comes across, and lets it go on.
struct Collector {
  RTCIntersectContext context;  // first: Embree hands back a pointer to it
  std::array<Found, 32> found;
  std::size_t count = 0;

  static void take(const RTCFilterFunctionNArguments* arguments) {
    // Geometry asks for single rays only, so N is 1.
    auto& self = *reinterpret_cast<Collector*>(arguments->context);
    RTCHitN* hit = arguments->hit;
    if (self.count < self.found.size()) {
      self.found[self.count++] = {RTCHitN_geomID(hit, 1, 0), RTCHitN_instID(hit, 1, 0, 0),
                                  RTCHitN_primID(hit, 1, 0), RTCHitN_u(hit, 1, 0),
                                  RTCHitN_v(hit, 1, 0),      RTCRayN_tfar(arguments->ray, 1, 0)};
    }
    arguments->valid[0] = 0;
  }
};

}  // namespace

// Shapes of group 0 are geometries of the top scene under their own number; behind them, the
// instances. A group is a scene of its own, numbered from 0.
struct Geometry::Embree {
  struct Group {
    RTCScene scene = nullptr;
    std::vector<std::uint32_t> surfaces;  // by Embree's number in the group
  };

  Embree(std::vector<Shape> s, const std::vector<std::uint32_t>& group_of_shape,
         std::vector<Instance> all)
      : shapes(std::move(s)) {
    if (group_of_shape.size() != shapes.size()) {
      throw std::invalid_argument("every shape needs a group");
    }
    for (Instance& instance : all) instances.emplace_back(std::move(instance));
    device = rtcNewDevice(kDeviceConfiguration);
    if (device == nullptr) throw std::runtime_error(kCantStart);
    try {
      build(group_of_shape);
    } catch (...) {
      release();
      throw;
    }
  }
  ~Embree() { release(); }
  Embree(const Embree&) = delete;
  Embree& operator=(const Embree&) = delete;

  void build(const std::vector<std::uint32_t>& group_of_shape) {
    scene = new_scene();
    std::map<std::pair<RTCScene, std::size_t>, EmbreeSpheres> spheres;  // by scene and time steps
    for (unsigned i = 0; i < shapes.size(); ++i) {
      RTCScene to = scene;
      unsigned id = i;
      if (group_of_shape[i] != 0) {
        Group& group = groups[group_of_shape[i]];
        if (group.scene == nullptr) group.scene = new_scene();
        to = group.scene;
        id = static_cast<unsigned>(group.surfaces.size());
        group.surfaces.push_back(i);
      }
      if (auto* mesh = std::get_if<TriangleMesh>(&shapes[i])) {
        attach(to, id, geometry_of(*mesh));
      } else {
        const Sphere& sphere = std::get<Sphere>(shapes[i]);
        spheres[{to, sphere.later_centres.size()}].all.push_back({&sphere, id});
      }
    }
    // Under the number of their first.
    for (auto& [where, same] : spheres) {
      sphere_sets.push_back(std::move(same));
      attach(where.first, sphere_sets.back().all.front().id,
             new_geometry(device, sphere_sets.back()));
    }
    for (auto& [number, group] : groups) commit(group.scene);
    attach_instances();
    commit(scene);
  }

  RTCScene new_scene() const {
    RTCScene made = rtcNewScene(device);
    // Watertight: a closed box must lose no photon through its edges. Filters: others_near.
    rtcSetSceneFlags(made, RTC_SCENE_FLAG_ROBUST | RTC_SCENE_FLAG_CONTEXT_FILTER_FUNCTION);
    return made;
  }

  void commit(RTCScene filled) const {
    rtcCommitScene(filled);
    if (const RTCError error = rtcGetDeviceError(device); error != RTC_ERROR_NONE) {
      throw std::runtime_error("Embree can't build the scene: error " +
                               std::to_string(static_cast<int>(error)));
    }
  }

  void attach_instances() {
    std::map<std::size_t, EmbreeInstances> by_time_steps;
    for (std::uint32_t i = 0; i < instances.size(); ++i) {
      const auto group = groups.find(instances[i].group());
      if (group == groups.end()) throw std::invalid_argument("an instance of an empty group");
      instance_surfaces.push_back(&group->second.surfaces);
      by_time_steps[instances[i].time_steps()].all.push_back(
          {&instances[i], group->second.scene, i});
    }
    auto id = static_cast<unsigned>(shapes.size());
    for (auto& [time_steps, same] : by_time_steps) {
      instance_sets.push_back(std::move(same));
      attach(scene, id++, new_geometry(device, instance_sets.back()));
    }
  }

  RTCGeometry geometry_of(TriangleMesh& mesh) const {
    RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE);
    const std::size_t count = mesh.vertex_count();
    rtcSetGeometryTimeStepCount(geometry, mesh.time_steps);
    // Embree reads 16 bytes at every vertex: keep room behind the last one.
    mesh.vertices.reserve(mesh.vertices.size() + 1);
    for (unsigned step = 0; step < mesh.time_steps; ++step) {
      rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, step, RTC_FORMAT_FLOAT3,
                                 mesh.vertices.data() + step * count, 0, sizeof(Vec3), count);
    }
    rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3,
                               mesh.triangles.data(), 0, sizeof(mesh.triangles[0]),
                               mesh.triangles.size());
    return geometry;
  }

  static void attach(RTCScene to, unsigned id, RTCGeometry geometry) {
    rtcCommitGeometry(geometry);
    rtcAttachGeometryByID(to, geometry, id);
    rtcReleaseGeometry(geometry);
  }

  // From Embree's numbers. Inline: 4 % of the Cornell box.
  [[gnu::always_inline]] Hit located(const Ray& ray, float time, Found found) const {
    if (found.instance != Hit::kNoInstance) {
      found.surface = (*instance_surfaces[found.instance])[found.surface];
      return locate(shapes[found.surface], instances[found.instance].placement(time), ray, found,
                    time);
    }
    const Shape& shape = shapes[found.surface];
    if (const auto* mesh = std::get_if<TriangleMesh>(&shape)) return locate(*mesh, found, time);
    return locate(std::get<Sphere>(shape), ray, found, time);
  }

  void release() {
    if (scene != nullptr) rtcReleaseScene(scene);
    for (auto& [number, group] : groups) rtcReleaseScene(group.scene);
    rtcReleaseDevice(device);
  }

  // Embree keeps pointers into all of these.
  std::vector<Shape> shapes;
  std::vector<PlacedInstance> instances;
  std::list<EmbreeSpheres> sphere_sets;
  std::list<EmbreeInstances> instance_sets;
  std::map<std::uint32_t, Group> groups;
  std::vector<const std::vector<std::uint32_t>*> instance_surfaces;  // by instance
  RTCDevice device = nullptr;
  RTCScene scene = nullptr;
};

Geometry::Geometry(std::vector<Shape> shapes) {
  std::vector<std::uint32_t> in_scene(shapes.size(), 0);
  embree_ = std::make_unique<Embree>(std::move(shapes), in_scene, std::vector<Instance>{});
}
Geometry::Geometry(std::vector<Shape> shapes, std::vector<std::uint32_t> groups,
                   std::vector<Instance> instances)
    : embree_(std::make_unique<Embree>(std::move(shapes), groups, std::move(instances))) {}
Geometry::~Geometry() = default;
Geometry::Geometry(Geometry&&) noexcept = default;

Geometry::Ball Geometry::bounds() const {
  RTCLinearBounds box;
  rtcGetSceneLinearBounds(embree_->scene, &box);
  const Vec3 low{std::min(box.bounds0.lower_x, box.bounds1.lower_x),
                 std::min(box.bounds0.lower_y, box.bounds1.lower_y),
                 std::min(box.bounds0.lower_z, box.bounds1.lower_z)};
  const Vec3 high{std::max(box.bounds0.upper_x, box.bounds1.upper_x),
                  std::max(box.bounds0.upper_y, box.bounds1.upper_y),
                  std::max(box.bounds0.upper_z, box.bounds1.upper_z)};
  // A little more, so that nothing touches it.
  return {0.5f * (low + high), 0.5005f * length(high - low)};
}

void Geometry::intersect(std::span<const TimedRay> rays, std::span<std::optional<Hit>> hits) const {
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  context.flags = RTC_INTERSECT_CONTEXT_FLAG_INCOHERENT;
  for (std::size_t first = 0; first < rays.size(); first += kPacket) {
    const auto some = rays.subspan(first, std::min(kPacket, rays.size() - first));
    alignas(32) std::array<int, kPacket> valid;
    RTCRayHit8 query;
    fill(query.ray, some, valid);
    for (std::size_t i = 0; i < kPacket; ++i) {
      query.hit.geomID[i] = RTC_INVALID_GEOMETRY_ID;
      query.hit.instID[0][i] = RTC_INVALID_GEOMETRY_ID;
    }
    rtcIntersect8(valid.data(), embree_->scene, &context, &query);
    for (std::size_t i = 0; i < some.size(); ++i) {
      if (query.hit.geomID[i] == RTC_INVALID_GEOMETRY_ID) {
        hits[first + i].reset();
        continue;
      }
      hits[first + i].emplace(InPlace{[&] {
        return embree_->located(some[i].ray, some[i].time,
                                {query.hit.geomID[i], query.hit.instID[0][i], query.hit.primID[i],
                                 query.hit.u[i], query.hit.v[i], query.ray.tfar[i]});
      }});
    }
  }
}

void Geometry::occluded(std::span<const TimedRay> rays, std::span<std::uint8_t> blocked) const {
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  context.flags = RTC_INTERSECT_CONTEXT_FLAG_INCOHERENT;
  for (std::size_t first = 0; first < rays.size(); first += kPacket) {
    const auto some = rays.subspan(first, std::min(kPacket, rays.size() - first));
    alignas(32) std::array<int, kPacket> valid;
    RTCRay8 query;
    fill(query, some, valid);
    rtcOccluded8(valid.data(), embree_->scene, &context, &query);
    for (std::size_t i = 0; i < some.size(); ++i) blocked[first + i] = query.tfar[i] < 0.0f ? 1 : 0;
  }
}

std::optional<Hit> Geometry::intersect(const Ray& ray, float time) const {
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  RTCRayHit query = embree_query(ray, time);
  rtcIntersect1(embree_->scene, &context, &query);
  if (query.hit.geomID == RTC_INVALID_GEOMETRY_ID) return std::nullopt;
  return embree_->located(ray, time,
                          {query.hit.geomID, query.hit.instID[0], query.hit.primID, query.hit.u,
                           query.hit.v, query.ray.tfar});
}

std::size_t Geometry::others_near(const Ray& ray, float time, const Hit& hit, float reach,
                                  std::span<Hit> found) const {
  Collector collector;
  rtcInitIntersectContext(&collector.context);
  collector.context.filter = Collector::take;
  RTCRayHit query = embree_query(ray, time);
  query.ray.tnear = std::max(0.0f, hit.distance - reach);
  query.ray.tfar = hit.distance + reach;
  rtcIntersect1(embree_->scene, &collector.context, &query);
  std::size_t count = 0;
  for (std::size_t i = 0; i < collector.count && count < found.size(); ++i) {
    const Hit other = embree_->located(ray, time, collector.found[i]);
    if (other.surface == hit.surface && other.instance == hit.instance &&
        other.primitive == hit.primitive) {
      continue;
    }
    found[count++] = other;
  }
  return count;
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
  const RTCDevice device = rtcNewDevice(kDeviceConfiguration);
  if (device == nullptr) throw std::runtime_error(kCantStart);
  const auto version = rtcGetDeviceProperty(device, RTC_DEVICE_PROPERTY_VERSION);
  rtcReleaseDevice(device);
  return "Embree " + std::to_string(version) + ' ' + kDeviceConfiguration;
}

}  // namespace nocturne
