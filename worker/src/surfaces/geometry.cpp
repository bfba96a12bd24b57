// One file, though long: all of it works on Embree's records, which nothing else shall see. First
// what builds them, then the search for single rays in exact order, then packets and queries.
#include "surfaces/geometry.h"

#include <embree3/rtcore.h>
#include <immintrin.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <list>
#include <map>
#include <stdexcept>
#include <string>
#include <tuple>
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

// Bytes of triangles and corners beyond which they are asked for in advance: half of what a core of
// today has of second-level cache.
constexpr std::size_t kLarge = std::size_t{1} << 19;

// GCC warns of the register itself as an argument of a template.
struct Row {
  __m256 lanes;
};

// Eight rows of eight floats: their columns.
void transpose(std::array<Row, 8>& rows) {
  std::array<Row, 8> pairs, fours;
  for (std::size_t i = 0; i < 8; i += 2) {
    pairs[i].lanes = _mm256_unpacklo_ps(rows[i].lanes, rows[i + 1].lanes);
    pairs[i + 1].lanes = _mm256_unpackhi_ps(rows[i].lanes, rows[i + 1].lanes);
  }
  for (std::size_t i = 0; i < 8; i += 4) {
    for (std::size_t k = 0; k < 2; ++k) {
      fours[i + 2 * k].lanes = _mm256_shuffle_ps(pairs[i + k].lanes, pairs[i + 2 + k].lanes, 0x44);
      fours[i + 2 * k + 1].lanes =
          _mm256_shuffle_ps(pairs[i + k].lanes, pairs[i + 2 + k].lanes, 0xEE);
    }
  }
  for (std::size_t i = 0; i < 4; ++i) {
    rows[i].lanes = _mm256_permute2f128_ps(fours[i].lanes, fours[i + 4].lanes, 0x20);
    rows[i + 4].lanes = _mm256_permute2f128_ps(fours[i].lanes, fours[i + 4].lanes, 0x31);
  }
}

// A TimedRay begins with eight floats. Turned in registers: Embree reads lanes together what single
// stores would have left in pieces.
static_assert(sizeof(Ray) == 6 * sizeof(float) && offsetof(TimedRay, ray) == 0 &&
              offsetof(TimedRay, time) == 6 * sizeof(float) &&
              offsetof(TimedRay, end) == 7 * sizeof(float));

// Rays of a packet have nothing to do with each other: then Embree finds for each what it finds for
// it alone, bit for bit, whatever rays it is with (tests/worker/surfaces/packets_test.cpp).
template <class Packet>
void fill(Packet& packet, std::span<const TimedRay> rays, std::span<int> valid) {
  std::array<Row, kPacket> rows;
  for (std::size_t i = 0; i < kPacket; ++i) {
    valid[i] = i < rays.size() ? -1 : 0;
    rows[i].lanes = _mm256_loadu_ps(&rays[std::min(i, rays.size() - 1)].ray.origin.x);
  }
  transpose(rows);
  std::size_t row = 0;
  for (float* column : {packet.org_x, packet.org_y, packet.org_z, packet.dir_x, packet.dir_y,
                        packet.dir_z, packet.time, packet.tfar}) {
    _mm256_store_ps(column, rows[row++].lanes);
  }
  _mm256_store_ps(packet.tnear, _mm256_setzero_ps());
  const auto set = [](unsigned* column, int all) {
    _mm256_store_si256(reinterpret_cast<__m256i*>(column), _mm256_set1_epi32(all));
  };
  set(packet.mask, -1);
  set(packet.id, 0);
  set(packet.flags, 0);
}

// What a single ray's search offers its filter.
Found offered(const RTCFilterFunctionNArguments* arguments) {
  RTCHitN* hit = arguments->hit;
  return {RTCHitN_geomID(hit, 1, 0), RTCHitN_instID(hit, 1, 0, 0),
          RTCHitN_primID(hit, 1, 0), RTCHitN_u(hit, 1, 0),
          RTCHitN_v(hit, 1, 0),      RTCRayN_tfar(arguments->ray, 1, 0)};
}

// Of the surfaces that a line crosses close together.
constexpr std::size_t kMaxNear = 32;

}  // namespace

// Shapes of group 0 are geometries of the top scene under their own number; behind them, the
// instances. A group is a scene of its own, numbered from 0.
struct Geometry::Embree {
  struct Group {
    RTCScene scene = nullptr;
    std::vector<std::uint32_t> surfaces;  // by Embree's number in the group
  };

  Embree(std::vector<Shape> s, const std::vector<std::uint32_t>& group_of_shape,
         std::vector<Instance> all, const std::stop_token& stop)
      : shapes(std::move(s)), close(shapes.size()) {
    if (group_of_shape.size() != shapes.size()) {
      throw std::invalid_argument("every shape needs a group");
    }
    for (Instance& instance : all) instances.emplace_back(std::move(instance));
    device = rtcNewDevice(kDeviceConfiguration);
    if (device == nullptr) throw std::runtime_error(kCantStart);
    try {
      build(group_of_shape, stop);
    } catch (...) {
      release();
      throw;
    }
  }
  ~Embree() { release(); }
  Embree(const Embree&) = delete;
  Embree& operator=(const Embree&) = delete;

  void build(const std::vector<std::uint32_t>& group_of_shape, const std::stop_token& stop) {
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
    std::size_t bytes = 0;
    for (const Shape& shape : shapes) {
      if (const auto* mesh = std::get_if<TriangleMesh>(&shape)) {
        bytes += mesh->vertices.size() * sizeof(Vec3) +
                 mesh->triangles.size() * sizeof(mesh->triangles[0]);
      }
    }
    is_large = bytes > kLarge;
    for (auto& [number, group] : groups) commit(group.scene, stop);
    attach_instances();
    commit(scene, stop);
  }

  RTCScene new_scene() const {
    RTCScene made = rtcNewScene(device);
    // Watertight: a closed box must lose no photon through its edges. Filters: nearest_ahead,
    // crossings_near.
    rtcSetSceneFlags(made, RTC_SCENE_FLAG_ROBUST | RTC_SCENE_FLAG_CONTEXT_FILTER_FUNCTION);
    return made;
  }

  void commit(RTCScene filled, std::stop_token stop) const {
    const auto go_on = [](void* token, double) {
      return !static_cast<std::stop_token*>(token)->stop_requested();
    };
    rtcSetSceneProgressMonitorFunction(filled, go_on, &stop);
    rtcCommitScene(filled);
    rtcSetSceneProgressMonitorFunction(filled, nullptr, nullptr);
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
  [[gnu::always_inline]] Hit located(Double3 origin, Vec3 direction, float time,
                                     Found found) const {
    if (found.instance != Hit::kNoInstance) {
      found.surface = (*instance_surfaces[found.instance])[found.surface];
      return locate(shapes[found.surface], instances[found.instance].placement(time), origin,
                    direction, found, time);
    }
    const Shape& shape = shapes[found.surface];
    if (const auto* mesh = std::get_if<TriangleMesh>(&shape)) return locate(*mesh, found, time);
    return locate(std::get<Sphere>(shape), origin, direction, found, time);
  }

  // The triangles of a packet's hits outside instances: f(mesh, number).
  template <class F>
  void for_each_triangle(const RTCHit8& hit, const F& f) const {
    for (std::size_t i = 0; i < kPacket; ++i) {
      if (hit.geomID[i] == RTC_INVALID_GEOMETRY_ID) continue;
      if (hit.instID[0][i] != RTC_INVALID_GEOMETRY_ID) continue;
      if (const auto* mesh = std::get_if<TriangleMesh>(&shapes[hit.geomID[i]])) {
        f(*mesh, hit.primID[i]);
      }
    }
  }
  void prefetch_triangles(const RTCHit8& hit) const {
    for_each_triangle(hit, [](const TriangleMesh& mesh, std::uint32_t triangle) {
      __builtin_prefetch(&mesh.triangles[triangle]);
    });
  }
  void prefetch_corners(const RTCHit8& hit) const {
    for_each_triangle(hit, [](const TriangleMesh& mesh, std::uint32_t triangle) {
      for (const std::uint32_t corner : mesh.triangles[triangle]) {
        __builtin_prefetch(&mesh.vertices[corner]);
      }
    });
  }

  // f(shape, placement or null) of what a hit is on.
  template <class F>
  auto with_placement(std::uint32_t surface, std::uint32_t instance, float time, const F& f) const {
    if (instance == Hit::kNoInstance) return f(shapes[surface], nullptr);
    const Placement placement = instances[instance].placement(time);
    return f(shapes[surface], &placement);
  }

  // A line. Embree measures from `back` metres behind its origin.
  struct Line {
    Double3 origin;
    Vec3 direction;
    float time;
    double back = 0.0;
    // What was left where it starts.
    std::optional<Crossed> left = {};
    // Of one that starts in a medium: what was left before.
    std::optional<Crossed> passed = {};
  };

  Crossed crossed(const Line& line, Found found) const {
    if (found.instance != Hit::kNoInstance) {
      found.surface = (*instance_surfaces[found.instance])[found.surface];
    }
    return crossed_shape(line, found);
  }
  Crossed crossed_shape(const Line& line, Found found) const {
    found.distance = static_cast<float>(found.distance - line.back);
    const auto cross = [&](const Shape& shape, const Placement* placement) {
      return cross_exactly(shape, placement, line.origin, line.direction, found, line.time);
    };
    return {found.surface, found.instance, found.primitive,
            with_placement(found.surface, found.instance, line.time, cross)};
  }

  Line line_of(const Ray& ray, float time, const Departure& departure) const {
    Line line{departure.start(ray), ray.direction, time};
    if (departure.surface == Departure::kNothing) return line;
    const Crossed before = crossed_shape(
        line, {departure.surface, departure.instance, departure.primitive, 0.0f, 0.0f, 0.0f});
    if (departure.in_medium) {
      line.passed = before;
      return line;
    }
    line.left = before;
    line.left->at.distance = 0.0;
    return line;
  }

  // What a line crosses close together, what it left among it.
  struct Picture {
    Picture() {}  // what is not there need not be zero

    std::array<Crossed, kMaxNear + 1> crossed;
    std::array<Found, kMaxNear> found;
    std::size_t count = 0;

    void add(const Crossed& at, const Found& as_found) {
      if (count == found.size()) return;
      found[count] = as_found;
      crossed[count++] = at;
    }
    // The last is what was left, now or before.
    std::span<const Crossed> with(const Line& line) {
      if (!line.left && !line.passed) return std::span(crossed).first(count);
      crossed[count] = line.left ? *line.left : *line.passed;
      return std::span(crossed).first(count + 1);
    }
  };

  // f(index) of those that lie before a ray along the line, and were not crossed where it starts.
  template <class F>
  void for_each_ahead(const Line& line, Picture& picture, const F& f) const {
    const auto all = picture.with(line);
    for (std::size_t i = 0; i < picture.count; ++i) {
      const auto order = line.left ? sheet_order(all, picture.count, i, close) : std::nullopt;
      if (!order.value_or(all[i].at.distance > 0.0)) continue;
      if (line.left && (same_crossing(shapes[all[i].surface], *line.left, all[i]) ||
                        touch(all, picture.count, i, close))) {
        continue;
      }
      // Crossed together with what is behind, where the medium was entered.
      if (line.passed && !(line.passed->at.distance > 0.0) && touch(all, picture.count, i, close)) {
        continue;
      }
      f(i);
    }
  }

  // Near the start takes down every hit, to be looked at in double precision; beyond finds the
  // nearest.
  struct NearestAhead {
    ExactContext context;  // first: Embree hands back a pointer to it
    const Embree& geometry;
    const Line& line;
    // From here on Embree's numbers tell.
    float certain;
    bool grazing;
    Picture picture;

    NearestAhead(const Embree& all, const Line& along, float certain_from, bool is_grazing)
        : geometry(all), line(along), certain(certain_from), grazing(is_grazing) {
      rtcInitIntersectContext(&context.context);
      context.context.filter = decide;
      context.origin = along.origin - along.back * Double3(along.direction);
    }

    static void decide(const RTCFilterFunctionNArguments* arguments) {
      auto& self = *reinterpret_cast<NearestAhead*>(arguments->context);
      const Found found = offered(arguments);
      if (found.distance > self.certain) {
        if (self.grazing && self.leaves_here(found)) arguments->valid[0] = 0;
        return;
      }
      self.picture.add(self.geometry.crossed(self.line, found), found);
      arguments->valid[0] = 0;
    }
    // A neighbour of what was left, all but parallel to the ray.
    bool leaves_here(const Found& found) const {
      const Crossed again = geometry.crossed(line, found);
      return line.left && same_crossing(geometry.shapes[again.surface], *line.left, again);
    }
  };

  std::optional<Hit> nearest_ahead(const Ray& ray, float time, const Departure& departure) const {
    // Closer to the tangent a hit may be wrong by more along the ray than the search looks back.
    constexpr double kMinCosine = 1e-3, kGrazing = 1e-2;
    Line line = line_of(ray, time, departure);
    // From within a medium what is met may be at any angle.
    const double cosine = line.left ? std::fabs(line.left->at.facing) : kMinCosine;
    const double reach = line.left ? close[line.left->surface].reach : largest_reach;
    line.back = 2.0 * reach / std::max(kMinCosine, cosine);
    const Double3 from = line.origin - line.back * Double3(ray.direction);
    NearestAhead search(*this, line, static_cast<float>(3.0 * line.back), cosine < kGrazing);
    RTCRayHit query = embree_query({from.rounded(), ray.direction}, time);
    rtcIntersect1(scene, &search.context.context, &query);
    std::size_t first = kMaxNear;
    for_each_ahead(line, search.picture, [&](std::size_t i) {
      const auto distance = [&](std::size_t j) { return search.picture.crossed[j].at.distance; };
      if (first == kMaxNear || distance(i) < distance(first)) first = i;
    });
    if (first != kMaxNear) {
      Hit hit = located(from, ray.direction, time, search.picture.found[first]);
      hit.distance = std::max(0.0f, static_cast<float>(search.picture.crossed[first].at.distance));
      return hit;
    }
    if (query.hit.geomID == RTC_INVALID_GEOMETRY_ID) return std::nullopt;
    const Found found{query.hit.geomID, query.hit.instID[0], query.hit.primID,
                      query.hit.u,      query.hit.v,         query.ray.tfar};
    Hit hit = located(from, ray.direction, time, found);
    // A medium scatters up to the surface exactly.
    hit.distance = static_cast<float>(crossed(line, found).at.distance);
    return hit;
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
  std::vector<CloseSurface> close;                                   // by surface
  float largest_reach = 0.0f;
  bool is_large = false;
  RTCDevice device = nullptr;
  RTCScene scene = nullptr;
};

Geometry::Geometry(std::vector<Shape> shapes) {
  std::vector<std::uint32_t> in_scene(shapes.size(), 0);
  embree_ = std::make_unique<Embree>(std::move(shapes), in_scene, std::vector<Instance>{},
                                     std::stop_token{});
}
Geometry::Geometry(std::vector<Shape> shapes, std::vector<std::uint32_t> groups,
                   std::vector<Instance> instances, std::stop_token stop)
    : embree_(std::make_unique<Embree>(std::move(shapes), groups, std::move(instances), stop)) {}
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
  if (!any_close()) return intersect_packets(rays, hits);
  // Those that depart exactly are searched for one by one, the others together.
  std::array<TimedRay, kPacket> others;
  std::array<std::size_t, kPacket> places;
  std::array<std::optional<Hit>, kPacket> found;
  std::size_t waiting = 0;
  const auto search = [&] {
    intersect_packets(std::span(others).first(waiting), found);
    for (std::size_t i = 0; i < waiting; ++i) hits[places[i]] = found[i];
    waiting = 0;
  };
  for (std::size_t i = 0; i < rays.size(); ++i) {
    if (rays[i].departure != nullptr && rays[i].departure->exact) {
      hits[i] = embree_->nearest_ahead(rays[i].ray, rays[i].time, *rays[i].departure);
      continue;
    }
    others[waiting] = rays[i];
    places[waiting++] = i;
    if (waiting == kPacket) search();
  }
  if (waiting > 0) search();
}

void Geometry::intersect_packets(std::span<const TimedRay> rays,
                                 std::span<std::optional<Hit>> hits) const {
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  context.flags = RTC_INTERSECT_CONTEXT_FLAG_INCOHERENT;
  // Large meshes lie in slow memory, which Embree does not touch for its own: corners are asked for
  // a packet before they are needed, and who they are two packets before.
  std::array<RTCRayHit8, 3> searched;
  const std::size_t behind = embree_->is_large ? 2 : 0;
  const std::size_t packets = (rays.size() + kPacket - 1) / kPacket;
  for (std::size_t step = 0; step < packets + behind; ++step) {
    if (step < packets) {
      const std::size_t first = step * kPacket;
      const auto some = rays.subspan(first, std::min(kPacket, rays.size() - first));
      alignas(32) std::array<int, kPacket> valid;
      RTCRayHit8& query = searched[step % 3];
      fill(query.ray, some, valid);
      for (std::size_t i = 0; i < kPacket; ++i) {
        query.hit.geomID[i] = RTC_INVALID_GEOMETRY_ID;
        query.hit.instID[0][i] = RTC_INVALID_GEOMETRY_ID;
      }
      rtcIntersect8(valid.data(), embree_->scene, &context, &query);
      if (embree_->is_large) embree_->prefetch_triangles(query.hit);
    }
    if (embree_->is_large && step >= 1 && step <= packets) {
      embree_->prefetch_corners(searched[(step - 1) % 3].hit);
    }
    if (step < behind) continue;
    const std::size_t first = (step - behind) * kPacket;
    const RTCRayHit8& query = searched[(step - behind) % 3];
    for (std::size_t i = first; i < std::min(first + kPacket, rays.size()); ++i) {
      const std::size_t lane = i - first;
      if (query.hit.geomID[lane] == RTC_INVALID_GEOMETRY_ID) {
        hits[i].reset();
        continue;
      }
      hits[i].emplace(InPlace{[&] {
        return embree_->located(
            rays[i].ray.origin, rays[i].ray.direction, rays[i].time,
            {query.hit.geomID[lane], query.hit.instID[0][lane], query.hit.primID[lane],
             query.hit.u[lane], query.hit.v[lane], query.ray.tfar[lane]});
      }});
    }
  }
}

void Geometry::occluded(std::span<const TimedRay> rays, std::span<std::uint8_t> blocked,
                        Ways ways) const {
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  context.flags = ways == Ways::kTogether ? RTC_INTERSECT_CONTEXT_FLAG_COHERENT
                                          : RTC_INTERSECT_CONTEXT_FLAG_INCOHERENT;
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
  return embree_->located(ray.origin, ray.direction, time,
                          {query.hit.geomID, query.hit.instID[0], query.hit.primID, query.hit.u,
                           query.hit.v, query.ray.tfar});
}

std::optional<Hit> Geometry::intersect(const Ray& ray, float time,
                                       const Departure& departure) const {
  return departure.exact ? embree_->nearest_ahead(ray, time, departure) : intersect(ray, time);
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
  Embree::Line line = embree_->line_of(ray, time, departure);
  line.back = reach - static_cast<double>(hit.distance);
  // From close by, where Embree's numbers are small.
  const Double3 from = line.origin - line.back * Double3(ray.direction);
  Embree::NearestAhead search(*embree_, line, std::numeric_limits<float>::infinity(), false);
  RTCRayHit query = embree_query({from.rounded(), ray.direction}, time);
  query.ray.tfar = 2.0f * reach;
  rtcIntersect1(embree_->scene, &search.context.context, &query);
  Embree::Picture& picture = search.picture;
  std::array<std::size_t, kMaxNear> ahead;
  std::size_t count = 0;
  embree_->for_each_ahead(line, picture, [&](std::size_t i) { ahead[count++] = i; });
  const auto order = [&](std::size_t i) {
    const Crossed& c = picture.crossed[i];
    return std::tuple(c.at.distance, c.surface, c.instance, c.primitive);
  };
  std::sort(ahead.begin(), ahead.begin() + static_cast<std::ptrdiff_t>(count),
            [&](std::size_t a, std::size_t b) { return order(a) < order(b); });
  const auto all = picture.with(line);
  for (std::size_t i = count; i-- > 1;) {
    if (sheet_order(all, ahead[i], ahead[i - 1], embree_->close).value_or(false)) {
      std::swap(ahead[i], ahead[i - 1]);
    }
  }
  if (count > 0 && departure.exact && !line.left) {
    // In a medium, between surfaces that touch: what lies behind was not crossed either.
    for (std::size_t i = 0; i < picture.count; ++i) {
      if (!(all[i].at.distance > 0.0) && touch(all, ahead[0], i, embree_->close)) {
        ahead[count++] = i;
      }
    }
  }
  count = std::min(count, found.size());
  for (std::size_t i = 0; i < count; ++i) {
    found[i] = {embree_->located(from, ray.direction, time, picture.found[ahead[i]]),
                all[ahead[i]].at, i == 0 || touch(all, ahead[0], ahead[i], embree_->close)};
    found[i].hit.distance = std::max(0.0f, static_cast<float>(found[i].at.distance));
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
