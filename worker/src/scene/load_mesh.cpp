#include "scene/load_mesh.h"

#include <bit>
#include <fstream>

#include "digest/sha256.h"

namespace nocturne {
namespace {

static_assert(std::endian::native == std::endian::little, "packed meshes are read as they sit");
static_assert(sizeof(Vec3) == 12 && sizeof(std::array<std::uint32_t, 3>) == 12);

void check(const TriangleMesh& mesh, const std::string& name) {
  for (const Vec3& v : mesh.vertices) {
    if (!std::isfinite(v.x) || !std::isfinite(v.y) || !std::isfinite(v.z)) {
      throw SceneError("mesh " + name + " has a vertex that is not finite");
    }
  }
  for (const auto& triangle : mesh.triangles) {
    for (const std::uint32_t index : triangle) {
      if (index >= mesh.vertices.size()) {
        throw SceneError("mesh " + name + " has a vertex index out of range");
      }
    }
  }
}

}  // namespace

TriangleMesh load_mesh(const v1::Mesh& message, const FindBlob& find_blob) {
  if (message.blob().size() != 32) throw SceneError("a mesh blob is not named by a SHA-256");
  const std::string name = to_hex(message.blob());
  const std::uint64_t vertices = message.vertex_count(), triangles = message.triangle_count();
  if (vertices == 0 || triangles == 0) throw SceneError("mesh " + name + " is empty");
  const auto path = find_blob(name);
  if (std::filesystem::file_size(path) != 12 * (vertices + triangles)) {
    throw SceneError("mesh " + name + " has another length than its counts say");
  }
  TriangleMesh mesh;
  mesh.vertices.reserve(vertices + 1);  // Embree wants room behind the last vertex
  mesh.vertices.resize(vertices);
  mesh.triangles.resize(triangles);
  std::ifstream file(path, std::ios::binary);
  const auto read = [&file](auto& values) {
    file.read(reinterpret_cast<char*>(values.data()),
              static_cast<std::streamsize>(values.size() * sizeof(values[0])));
  };
  read(mesh.vertices);
  read(mesh.triangles);
  if (!file) throw SceneError("mesh " + name + " can't be read");
  check(mesh, name);
  return mesh;
}

}  // namespace nocturne
