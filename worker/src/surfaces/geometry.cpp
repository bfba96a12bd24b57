#include "surfaces/geometry.h"

#include <embree3/rtcore.h>

#include <cstring>
#include <limits>
#include <stdexcept>
#include <string>

#include "surfaces/sphere_intersection.h"

namespace nocturne {
namespace {

// One instruction set for all workers, whatever their processor; and one build thread, so that the
// tree, and with it the choice between coincident surfaces, is the same everywhere
// (docs/decisions/0003).
constexpr const char* kDeviceConfiguration = "isa=avx2,threads=1,set_affinity=0";

// What Embree calls for a sphere: it has only the pointer given at construction.
struct SphereGeometry {
  Sphere sphere;
  unsigned geometry_id;
};

void sphere_bounds(const RTCBoundsFunctionArguments* arguments) {
  const Sphere& s = static_cast<const SphereGeometry*>(arguments->geometryUserPtr)->sphere;
  // Rounded outwards: two units in the last place cover the conversion to float.
  const auto below = [](double v) {
    return static_cast<float>(v - 2.0 * std::numeric_limits<float>::epsilon() * std::fabs(v));
  };
  const auto above = [](double v) {
    return static_cast<float>(v + 2.0 * std::numeric_limits<float>::epsilon() * std::fabs(v));
  };
  RTCBounds& box = *arguments->bounds_o;
  box.lower_x = below(s.x - s.radius);
  box.lower_y = below(s.y - s.radius);
  box.lower_z = below(s.z - s.radius);
  box.upper_x = above(s.x + s.radius);
  box.upper_y = above(s.y + s.radius);
  box.upper_z = above(s.z + s.radius);
}

// The first crossing within (near, far) of the ray, as Embree's callbacks see it.
std::optional<float> first_crossing(const Sphere& sphere, RTCRayN* ray, unsigned n, unsigned i) {
  const auto crossings = cross_sphere(sphere, RTCRayN_org_x(ray, n, i), RTCRayN_org_y(ray, n, i),
                                      RTCRayN_org_z(ray, n, i), RTCRayN_dir_x(ray, n, i),
                                      RTCRayN_dir_y(ray, n, i), RTCRayN_dir_z(ray, n, i));
  if (!crossings) return std::nullopt;
  for (const double t : {crossings->near, crossings->far}) {
    if (t > RTCRayN_tnear(ray, n, i) && t < RTCRayN_tfar(ray, n, i)) return static_cast<float>(t);
  }
  return std::nullopt;
}

void sphere_intersect(const RTCIntersectFunctionNArguments* arguments) {
  const auto& geometry = *static_cast<const SphereGeometry*>(arguments->geometryUserPtr);
  RTCRayN* ray = RTCRayHitN_RayN(arguments->rayhit, arguments->N);
  RTCHitN* hit = RTCRayHitN_HitN(arguments->rayhit, arguments->N);
  for (unsigned i = 0; i < arguments->N; ++i) {
    if (arguments->valid[i] == 0) continue;
    const auto t = first_crossing(geometry.sphere, ray, arguments->N, i);
    if (!t) continue;
    RTCRayN_tfar(ray, arguments->N, i) = *t;
    RTCHitN_geomID(hit, arguments->N, i) = geometry.geometry_id;
    RTCHitN_primID(hit, arguments->N, i) = 0;
    RTCHitN_instID(hit, arguments->N, i, 0) = RTC_INVALID_GEOMETRY_ID;
  }
}

void sphere_occluded(const RTCOccludedFunctionNArguments* arguments) {
  const auto& geometry = *static_cast<const SphereGeometry*>(arguments->geometryUserPtr);
  for (unsigned i = 0; i < arguments->N; ++i) {
    if (arguments->valid[i] == 0) continue;
    if (first_crossing(geometry.sphere, arguments->ray, arguments->N, i)) {
      RTCRayN_tfar(arguments->ray, arguments->N, i) = -std::numeric_limits<float>::infinity();
    }
  }
}

RTCRay embree_ray(const Ray& ray, float distance) {
  RTCRay r;
  r.org_x = ray.origin.x;
  r.org_y = ray.origin.y;
  r.org_z = ray.origin.z;
  r.dir_x = ray.direction.x;
  r.dir_y = ray.direction.y;
  r.dir_z = ray.direction.z;
  r.tnear = 0.0f;
  r.tfar = distance;
  r.time = 0.0f;
  r.mask = ~0u;
  r.id = 0;
  r.flags = 0;
  return r;
}

// Embree's context with our visitor behind it; the filter gets the context back.
struct CrossingContext {
  RTCIntersectContext embree;
  const std::function<void(const TriangleCrossing&)>* visit;
};

// Visits every candidate and accepts none, so that the traversal goes on to the end of the
// half-line.
void visit_crossing(const RTCFilterFunctionNArguments* arguments) {
  const auto& visit = *reinterpret_cast<const CrossingContext*>(arguments->context)->visit;
  for (unsigned i = 0; i < arguments->N; ++i) {
    if (arguments->valid[i] == 0) continue;
    const Vec3 n{RTCHitN_Ng_x(arguments->hit, arguments->N, i),
                 RTCHitN_Ng_y(arguments->hit, arguments->N, i),
                 RTCHitN_Ng_z(arguments->hit, arguments->N, i)};
    const Vec3 d{RTCRayN_dir_x(arguments->ray, arguments->N, i),
                 RTCRayN_dir_y(arguments->ray, arguments->N, i),
                 RTCRayN_dir_z(arguments->ray, arguments->N, i)};
    visit({RTCHitN_geomID(arguments->hit, arguments->N, i),
           RTCRayN_tfar(arguments->ray, arguments->N, i), std::fabs(dot(n, d)) / length(n)});
    arguments->valid[i] = 0;
  }
}

// The point from the barycentric coordinates: its error depends on the triangle's coordinates, not
// on the ray's length.
Hit triangle_hit(const TriangleMesh& mesh, const RTCHit& hit) {
  const auto& corners = mesh.triangles[hit.primID];
  const Vec3 a = mesh.vertices[corners[0]], b = mesh.vertices[corners[1]],
             c = mesh.vertices[corners[2]];
  const Vec3 ab = b - a, ac = c - a;
  return {a + hit.u * ab + hit.v * ac, normalized(cross(ab, ac)), hit.geomID};
}

Hit sphere_hit(const Sphere& s, const RTCRay& ray, unsigned surface) {
  const double x = ray.org_x + static_cast<double>(ray.tfar) * ray.dir_x - s.x;
  const double y = ray.org_y + static_cast<double>(ray.tfar) * ray.dir_y - s.y;
  const double z = ray.org_z + static_cast<double>(ray.tfar) * ray.dir_z - s.z;
  const double inverse = 1.0 / std::sqrt(x * x + y * y + z * z);
  const double nx = x * inverse, ny = y * inverse, nz = z * inverse;
  return {{static_cast<float>(s.x + s.radius * nx), static_cast<float>(s.y + s.radius * ny),
           static_cast<float>(s.z + s.radius * nz)},
          {static_cast<float>(nx), static_cast<float>(ny), static_cast<float>(nz)},
          surface};
}

}  // namespace

struct Geometry::Embree {
  Embree(std::vector<Shape> s, Queries queries) : shapes(std::move(s)), spheres(shapes.size()) {
    device = rtcNewDevice(kDeviceConfiguration);
    if (device == nullptr) throw std::runtime_error("Embree can't start: the processor needs AVX2");
    scene = rtcNewScene(device);
    // Watertight: a closed box must lose no photon through its edges.
    rtcSetSceneFlags(scene, queries == Queries::kCrossings
                                ? RTC_SCENE_FLAG_ROBUST | RTC_SCENE_FLAG_CONTEXT_FILTER_FUNCTION
                                : RTC_SCENE_FLAG_ROBUST);
    for (unsigned i = 0; i < shapes.size(); ++i)
      std::visit([&](auto& shape) { attach(i, shape); }, shapes[i]);
    rtcCommitScene(scene);
    if (const RTCError error = rtcGetDeviceError(device); error != RTC_ERROR_NONE) {
      release();
      throw std::runtime_error("Embree can't build the scene: error " +
                               std::to_string(static_cast<int>(error)));
    }
  }
  ~Embree() { release(); }
  Embree(const Embree&) = delete;
  Embree& operator=(const Embree&) = delete;

  void release() {
    rtcReleaseScene(scene);
    rtcReleaseDevice(device);
  }

  void attach(unsigned id, TriangleMesh& mesh) {
    RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE);
    const std::size_t count = mesh.vertices.size();
    // Embree reads 16 bytes at every vertex: keep room behind the last one.
    mesh.vertices.emplace_back();
    rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3,
                               mesh.vertices.data(), 0, sizeof(Vec3), count);
    rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3,
                               mesh.triangles.data(), 0, sizeof(mesh.triangles[0]),
                               mesh.triangles.size());
    finish(id, geometry);
  }

  void attach(unsigned id, Sphere& sphere) {
    spheres[id] = {sphere, id};
    RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_USER);
    rtcSetGeometryUserPrimitiveCount(geometry, 1);
    rtcSetGeometryUserData(geometry, &spheres[id]);
    rtcSetGeometryBoundsFunction(geometry, sphere_bounds, nullptr);
    rtcSetGeometryIntersectFunction(geometry, sphere_intersect);
    rtcSetGeometryOccludedFunction(geometry, sphere_occluded);
    finish(id, geometry);
  }

  void finish(unsigned id, RTCGeometry geometry) {
    rtcCommitGeometry(geometry);
    rtcAttachGeometryByID(scene, geometry, id);
    rtcReleaseGeometry(geometry);
  }

  std::vector<Shape> shapes;
  std::vector<SphereGeometry> spheres;
  RTCDevice device = nullptr;
  RTCScene scene = nullptr;
};

Geometry::Geometry(std::vector<Shape> shapes, Queries queries)
    : embree_(std::make_unique<Embree>(std::move(shapes), queries)) {}
Geometry::~Geometry() = default;

std::optional<Hit> Geometry::intersect(const Ray& ray) const {
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  RTCRayHit query;
  query.ray = embree_ray(ray, std::numeric_limits<float>::infinity());
  query.hit.geomID = RTC_INVALID_GEOMETRY_ID;
  rtcIntersect1(embree_->scene, &context, &query);
  if (query.hit.geomID == RTC_INVALID_GEOMETRY_ID) return std::nullopt;
  const Shape& shape = embree_->shapes[query.hit.geomID];
  if (const auto* mesh = std::get_if<TriangleMesh>(&shape)) return triangle_hit(*mesh, query.hit);
  return sphere_hit(std::get<Sphere>(shape), query.ray, query.hit.geomID);
}

bool Geometry::occluded(const Ray& ray, float distance) const {
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  RTCRay query = embree_ray(ray, distance);
  rtcOccluded1(embree_->scene, &context, &query);
  return query.tfar < 0.0f;
}

void Geometry::for_each_triangle_crossing(
    const Ray& ray, const std::function<void(const TriangleCrossing&)>& visit) const {
  CrossingContext context{{}, &visit};
  rtcInitIntersectContext(&context.embree);
  context.embree.filter = visit_crossing;
  RTCRay query = embree_ray(ray, std::numeric_limits<float>::infinity());
  rtcOccluded1(embree_->scene, &context.embree, &query);
}

std::span<const Shape> Geometry::shapes() const { return embree_->shapes; }

}  // namespace nocturne
