#include "surfaces/embree_scene.h"

#include <cstddef>
#include <stdexcept>
#include <string>
#include <utility>

namespace nocturne {
namespace {

RTCGeometry geometry_of(RTCDevice device, TriangleMesh& mesh) {
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

void attach(RTCGeometry geometry, unsigned id, RTCScene to) {
  rtcCommitGeometry(geometry);
  rtcAttachGeometryByID(to, geometry, id);
  rtcReleaseGeometry(geometry);
}

}  // namespace

// One instruction set for all workers, whatever their processor; and one build thread, so that the
// tree, and with it the choice between coincident surfaces, is the same everywhere
// (docs/decisions/0003).
const char* const kDeviceConfiguration = "isa=avx2,threads=1,set_affinity=0";

RTCDevice new_device() {
  RTCDevice device = rtcNewDevice(kDeviceConfiguration);
  if (device == nullptr) {
    throw std::runtime_error("Embree can't start: the processor needs AVX2");
  }
  return device;
}

EmbreeScene::EmbreeScene(std::vector<Shape> s, const std::vector<std::uint32_t>& group_of_shape,
                         std::vector<Instance> all, const std::stop_token& stop)
    : shapes(std::move(s)), close(shapes.size()) {
  if (group_of_shape.size() != shapes.size()) {
    throw std::invalid_argument("every shape needs a group");
  }
  for (Instance& instance : all) instances.emplace_back(std::move(instance));
  device_ = new_device();
  try {
    build(group_of_shape, stop);
  } catch (...) {
    release();
    throw;
  }
}

void EmbreeScene::build(const std::vector<std::uint32_t>& group_of_shape,
                        const std::stop_token& stop) {
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
    const auto add_mesh = [&](TriangleMesh& mesh) { attach(geometry_of(device_, mesh), id, to); };
    visit_shape(shapes[i], add_mesh, [&](const Sphere& sphere) {
      spheres[{to, sphere.later_centres.size()}].all.push_back({&sphere, id});
    });
  }
  // Under the number of their first.
  for (auto& [where, same] : spheres) {
    sphere_sets.push_back(std::move(same));
    attach(new_geometry(device_, sphere_sets.back()), sphere_sets.back().all.front().id,
           where.first);
  }
  for (auto& [number, group] : groups) commit(group.scene, stop);
  attach_instances();
  commit(scene, stop);
}

RTCScene EmbreeScene::new_scene() const {
  RTCScene made = rtcNewScene(device_);
  // Watertight: a closed box must lose no photon through its edges. Filters: nearest_ahead,
  // crossings_near.
  rtcSetSceneFlags(made, RTC_SCENE_FLAG_ROBUST | RTC_SCENE_FLAG_CONTEXT_FILTER_FUNCTION);
  return made;
}

void EmbreeScene::commit(RTCScene filled, std::stop_token stop) const {
  const auto keep_building = [](void* token, double) {
    return !static_cast<std::stop_token*>(token)->stop_requested();
  };
  rtcSetSceneProgressMonitorFunction(filled, keep_building, &stop);
  rtcCommitScene(filled);
  rtcSetSceneProgressMonitorFunction(filled, nullptr, nullptr);
  if (const RTCError error = rtcGetDeviceError(device_); error != RTC_ERROR_NONE) {
    throw std::runtime_error("Embree can't build the scene: error " +
                             std::to_string(static_cast<int>(error)));
  }
}

void EmbreeScene::attach_instances() {
  std::map<std::size_t, EmbreeInstances> by_time_steps;
  for (std::uint32_t i = 0; i < instances.size(); ++i) {
    const auto group = groups.find(instances[i].group());
    if (group == groups.end()) throw std::invalid_argument("an instance of an empty group");
    instance_surfaces.push_back(&group->second.surfaces);
    by_time_steps[instances[i].time_steps()].all.push_back({&instances[i], group->second.scene, i});
  }
  auto id = static_cast<unsigned>(shapes.size());
  for (auto& [time_steps, same] : by_time_steps) {
    instance_sets.push_back(std::move(same));
    attach(new_geometry(device_, instance_sets.back()), id++, scene);
  }
}

void EmbreeScene::release() {
  if (scene != nullptr) rtcReleaseScene(scene);
  for (auto& [number, group] : groups) rtcReleaseScene(group.scene);
  rtcReleaseDevice(device_);
}

}  // namespace nocturne
