#include "scene/load_mesh.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <fstream>

#include "math/time_steps.h"
#include "scene/load_context.h"

namespace nocturne {
namespace {

static_assert(std::endian::native == std::endian::little, "packed meshes are read as they sit");
static_assert(sizeof(Vec3) == 12 && sizeof(std::array<std::uint32_t, 3>) == 12 &&
              sizeof(std::array<float, 2>) == 8);

// A normal's length may be off by this; it is made a unit vector.
constexpr double kNormalTolerance = 1e-3;

// How many of each the blob holds; what a blob can't hold does not overflow 64 bits.
struct Counts {
  std::uint64_t vertices, normals, texture_coordinates, triangles;

  explicit Counts(const v1::Mesh& message)
      : vertices(std::uint64_t{message.vertex_count()} * std::max(message.time_steps(), 1u)),
        normals(message.normals() ? vertices : 0),
        texture_coordinates(message.texture_coordinates() ? message.vertex_count() : 0),
        triangles(message.triangle_count()) {}

  std::uint64_t bytes() const {
    return 12 * (vertices + normals + triangles) + 8 * texture_coordinates;
  }
};

class Checks {
 public:
  explicit Checks(const std::string& name) : name_(name) {}

  void require(bool condition, const char* what) const {
    if (!condition) throw SceneError("mesh " + name_ + " " + what);
  }

  void check(TriangleMesh& mesh) const {
    for (const Vec3& v : mesh.vertices) require(finite(v), "has a vertex that is not finite");
    for (Vec3& n : mesh.normals) n = unit(n);
    for (const auto& [u, v] : mesh.texture_coordinates) {
      require(std::isfinite(u) && std::isfinite(v), "has a texture coordinate that is not finite");
    }
    for (const auto& triangle : mesh.triangles) {
      require(std::ranges::max(triangle) < mesh.vertex_count(), "has a vertex index out of range");
    }
  }

 private:
  static bool finite(Vec3 v) {
    return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
  }

  Vec3 unit(Vec3 normal) const {
    const double size = length(Double3(normal));
    require(std::fabs(size - 1.0) <= kNormalTolerance, "has a normal that is not of unit length");
    return ((1.0 / size) * Double3(normal)).rounded();
  }

  const std::string& name_;
};

TriangleMesh read(const std::filesystem::path& path, const Counts& counts) {
  TriangleMesh mesh;
  mesh.vertices.reserve(counts.vertices + 1);  // Embree wants room behind the last vertex
  mesh.vertices.resize(counts.vertices);
  mesh.normals.resize(counts.normals);
  mesh.texture_coordinates.resize(counts.texture_coordinates);
  mesh.triangles.resize(counts.triangles);
  std::ifstream file(path, std::ios::binary);
  file.exceptions(std::ios::badbit | std::ios::failbit);
  const auto fill = [&file](auto& values) {
    file.read(reinterpret_cast<char*>(values.data()),
              static_cast<std::streamsize>(values.size() * sizeof(values[0])));
  };
  fill(mesh.vertices);
  fill(mesh.normals);
  fill(mesh.texture_coordinates);
  fill(mesh.triangles);
  return mesh;
}

}  // namespace

TriangleMesh load_mesh(const v1::Mesh& message, const FindBlob& find_blob) {
  const std::string name = blob_name(message.blob());
  const Checks checks(name);
  checks.require(message.time_steps() <= kMaxTimeSteps, "has more than 129 time steps");
  const Counts counts(message);
  checks.require(counts.vertices > 0 && counts.triangles > 0, "is empty");
  const auto path = find_blob(name);
  checks.require(std::filesystem::file_size(path) == counts.bytes(),
                 "has another length than its counts say");
  TriangleMesh mesh;
  try {
    mesh = read(path, counts);
  } catch (const std::ios::failure&) {
    checks.require(false, "can't be read");
  }
  mesh.time_steps = std::max(message.time_steps(), 1u);
  checks.check(mesh);
  return mesh;
}

}  // namespace nocturne
