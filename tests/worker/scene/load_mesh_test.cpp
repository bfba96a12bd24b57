#include "scene/load_mesh.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <fstream>
#include <functional>
#include <limits>

namespace nocturne {
namespace {

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();

// A triangle with everything, as its parts; `time_steps` copies of vertices and normals.
struct Parts {
  std::vector<float> vertices, normals, texture_coordinates;
  std::vector<std::uint32_t> triangles{0, 1, 2};
  v1::Mesh message;

  explicit Parts(std::uint32_t time_steps, bool all = true) {
    for (std::uint32_t step = 0; step < std::max(time_steps, 1u); ++step) {
      const auto s = static_cast<float>(step);
      vertices.insert(vertices.end(), {s, 0, 0, s + 1, 0, 0, s, 1, 0});
      if (all) normals.insert(normals.end(), {0, 0, 1, 0.6f, 0, 0.8f, 0, 0.6f, 0.8f});
    }
    if (all) texture_coordinates = {0, 0, 1, 0, 0, 1};
    message.set_blob(std::string(32, '\x5a'));
    message.set_vertex_count(3);
    message.set_triangle_count(1);
    message.set_normals(all);
    message.set_texture_coordinates(all);
    message.set_time_steps(time_steps);
  }
};

class LoadMesh : public testing::Test {
 protected:
  std::filesystem::path path_ = std::filesystem::temp_directory_path() /
                                ("nocturne-mesh-parts-" + std::to_string(::getpid()));
  ~LoadMesh() override { std::filesystem::remove(path_); }

  TriangleMesh load(const Parts& parts, std::int64_t extra_bytes = 0) {
    std::ofstream file(path_, std::ios::binary);
    const auto write = [&file](const auto& values) {
      file.write(reinterpret_cast<const char*>(values.data()),
                 static_cast<std::streamsize>(4 * values.size()));
    };
    write(parts.vertices);
    write(parts.normals);
    write(parts.texture_coordinates);
    write(parts.triangles);
    file.close();
    if (extra_bytes != 0) {
      const auto size = static_cast<std::int64_t>(std::filesystem::file_size(path_));
      std::filesystem::resize_file(path_, static_cast<std::uintmax_t>(size + extra_bytes));
    }
    return load_mesh(parts.message, [this](const std::string& sha256) {
      EXPECT_EQ(sha256.substr(0, 4), "5a5a");
      return path_;
    });
  }

  void expect_refused(const Parts& parts, const std::string& says, std::int64_t extra_bytes = 0) {
    try {
      load(parts, extra_bytes);
      ADD_FAILURE() << "accepted: " << says;
    } catch (const SceneError& error) {
      EXPECT_NE(std::string(error.what()).find(says), std::string::npos) << error.what();
    }
  }
};

TEST_F(LoadMesh, TakesAllPartsInTheirOrder) {
  for (const std::uint32_t steps : {0u, 1u, 2u, 129u}) {
    const TriangleMesh mesh = load(Parts(steps));
    const std::uint32_t count = std::max(steps, 1u);
    EXPECT_EQ(mesh.time_steps, count);
    EXPECT_EQ(mesh.vertex_count(), 3u);
    ASSERT_EQ(mesh.vertices.size(), 3 * count);
    ASSERT_EQ(mesh.normals.size(), 3 * count);
    EXPECT_EQ(mesh.vertices[3 * (count - 1)].x, static_cast<float>(count - 1));
    EXPECT_FLOAT_EQ(mesh.normals[1].x, 0.6f);
    ASSERT_EQ(mesh.texture_coordinates.size(), 3u);
    EXPECT_EQ(mesh.texture_coordinates[1][0], 1.0f);
    EXPECT_EQ(mesh.triangles[0][2], 2u);
  }
  const TriangleMesh plain = load(Parts(1, false));
  EXPECT_TRUE(plain.normals.empty());
  EXPECT_TRUE(plain.texture_coordinates.empty());
}

TEST_F(LoadMesh, MakesNormalsUnitVectors) {
  Parts parts(1);
  parts.normals[2] = 1.0009f;
  EXPECT_FLOAT_EQ(load(parts).normals[0].z, 1.0f);
  parts.normals[2] = 1.0011f;
  expect_refused(parts, "unit length");
  parts.normals[2] = 0.0f;
  expect_refused(parts, "unit length");
  parts.normals[2] = kNan;
  expect_refused(parts, "unit length");
}

TEST_F(LoadMesh, RefusesOtherLengths) {
  for (const std::int64_t extra : {-4, -1, 1, 4, 12}) expect_refused(Parts(2), "length", extra);
  Parts flagged(1, false);
  flagged.message.set_normals(true);
  expect_refused(flagged, "length");
}

TEST_F(LoadMesh, ChecksTheLengthBeforeTakingMemory) {
  constexpr std::uint32_t kMax = std::numeric_limits<std::uint32_t>::max();
  for (const std::uint32_t vertices : {kMax, 3u}) {
    for (const std::uint32_t triangles : {kMax, 1u}) {
      if (vertices == 3 && triangles == 1) continue;
      Parts parts(1);
      parts.message.set_vertex_count(vertices);
      parts.message.set_triangle_count(triangles);
      for (const std::uint32_t steps : {1u, 129u}) {
        parts.message.set_time_steps(steps);
        expect_refused(parts, "length");
      }
    }
  }
  Parts steps(1);
  for (const std::uint32_t count : {130u, kMax}) {
    steps.message.set_time_steps(count);
    expect_refused(steps, "time steps");
  }
}

TEST_F(LoadMesh, RefusesEmptyMeshesAndNames) {
  Parts parts(1);
  parts.message.set_vertex_count(0);
  expect_refused(parts, "empty");
  parts = Parts(1);
  parts.message.set_triangle_count(0);
  expect_refused(parts, "empty");
  parts = Parts(1);
  parts.message.set_blob("short");
  expect_refused(parts, "SHA-256");
}

TEST_F(LoadMesh, RefusesNumbersThatAreNotFinite) {
  for (const float bad : {kNan, std::numeric_limits<float>::infinity()}) {
    Parts parts(3);
    parts.vertices.back() = bad;
    expect_refused(parts, "vertex");
    parts = Parts(1);
    parts.texture_coordinates[3] = bad;
    expect_refused(parts, "texture coordinate");
  }
}

// Indices count the vertices of one time step.
TEST_F(LoadMesh, RefusesIndicesOutOfRange) {
  Parts parts(2);
  parts.triangles[1] = 3;
  expect_refused(parts, "index");
}

}  // namespace
}  // namespace nocturne
