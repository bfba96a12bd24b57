#include "scene/load_scene.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <fstream>
#include <functional>
#include <limits>

#include "support/scene_builder.h"

namespace nocturne {
namespace {

test::SceneBuilder good_scene() {
  test::SceneBuilder builder;
  builder.add_quad(0.5f, 1.0f, {0, 0, 0}, {1, 0, 0}, {0, 1, 0});
  return builder;
}

TEST(LoadScene, TakesAGoodScene) { EXPECT_NO_THROW(good_scene().load()); }

struct Damage {
  const char* says;
  std::function<void(v1::CompiledScene&)> apply;
};

// What a worker gets comes over a network: every number is checked before it is used.
TEST(LoadScene, RefusesDamagedMessagesInWords) {
  const Damage damages[] = {
      {"format", [](auto& m) { m.set_format(2); }},
      {"surfaces",
       [](auto& m) {
         m.clear_surfaces();
         m.clear_luminaires();
       }},
      {"kernel index", [](auto& m) { m.mutable_surfaces(0)->set_kernel(7); }},
      {"spectrum index",
       [](auto& m) { m.mutable_kernels(0)->mutable_lambertian()->set_reflectance(9); }},
      {"kernel", [](auto& m) { m.mutable_kernels(0)->clear_lambertian(); }},
      {"luminaire", [](auto& m) { m.mutable_luminaires(0)->set_surface(3); }},
      {"two luminaires", [](auto& m) { *m.add_luminaires() = m.luminaires(0); }},
      {"shape", [](auto& m) { m.mutable_surfaces(0)->clear_quad(); }},
      {"corner",
       [](auto& m) {
         m.mutable_surfaces(0)->mutable_quad()->mutable_corner()->set_x(
             std::numeric_limits<double>::quiet_NaN());
       }},
      {"radius", [](auto& m) { m.mutable_surfaces(0)->mutable_sphere()->set_radius(-1); }},
      {"spectrum", [](auto& m) { m.mutable_spectra(0)->set_values(0, -1.0f); }},
      {"spectrum", [](auto& m) { m.mutable_spectra(0)->clear_values(); }},
      {"field of view", [](auto& m) { m.mutable_sensor()->set_vertical_field_of_view(4); }},
      {"focus", [](auto& m) { m.mutable_sensor()->set_lens_radius(1); }},
      {"wavelength sampling", [](auto& m) { m.mutable_sensor()->clear_wavelength_sampling(); }},
      {"add up", [](auto& m) { m.mutable_tracing()->set_weight_kernel(0.9); }},
      {"h is", [](auto& m) { m.mutable_tracing()->set_h(0); }},
      {"depth", [](auto& m) { m.mutable_tracing()->set_maximum_depth(0); }},
      {"roulette", [](auto& m) { m.mutable_tracing()->clear_roulette(); }},
      {"sequence", [](auto& m) { m.mutable_tracing()->clear_sequence(); }},
  };
  for (const Damage& damage : damages) {
    auto builder = good_scene();
    damage.apply(builder.message);
    try {
      builder.load();
      ADD_FAILURE() << "accepted: " << damage.says;
    } catch (const SceneError& error) {
      EXPECT_NE(std::string(error.what()).find(damage.says), std::string::npos) << error.what();
    }
  }
}

class LoadMesh : public testing::Test {
 protected:
  std::filesystem::path path_ =
      std::filesystem::temp_directory_path() / ("nocturne-mesh-" + std::to_string(::getpid()));
  ~LoadMesh() override { std::filesystem::remove(path_); }

  void load(std::vector<float> vertices, std::vector<std::uint32_t> indices,
            std::uint32_t vertex_count, std::uint32_t triangle_count) {
    std::ofstream file(path_, std::ios::binary);
    file.write(reinterpret_cast<const char*>(vertices.data()),
               static_cast<std::streamsize>(4 * vertices.size()));
    file.write(reinterpret_cast<const char*>(indices.data()),
               static_cast<std::streamsize>(4 * indices.size()));
    file.close();
    test::SceneBuilder builder;
    auto& mesh = *builder.add_surface(0.5f, 1.0f).mutable_mesh();
    mesh.set_blob(std::string(32, '\x5a'));
    mesh.set_vertex_count(vertex_count);
    mesh.set_triangle_count(triangle_count);
    load_scene(builder.message, [this](const std::string& sha256) {
      EXPECT_EQ(sha256.substr(0, 4), "5a5a");
      return path_;
    });
  }
};

TEST_F(LoadMesh, TakesAGoodMesh) {
  EXPECT_NO_THROW(load({0, 0, 0, 1, 0, 0, 0, 1, 0}, {0, 1, 2}, 3, 1));
}

TEST_F(LoadMesh, ChecksTheLengthBeforeTakingMemory) {
  EXPECT_THROW(load({0, 0, 0, 1, 0, 0, 0, 1, 0}, {0, 1, 2}, 4'000'000'000u, 4'000'000'000u),
               SceneError);
}

TEST_F(LoadMesh, RefusesIndicesOutOfRange) {
  EXPECT_THROW(load({0, 0, 0, 1, 0, 0, 0, 1, 0}, {0, 1, 3}, 3, 1), SceneError);
}

TEST_F(LoadMesh, RefusesVerticesThatAreNotFinite) {
  EXPECT_THROW(
      load({0, 0, 0, std::numeric_limits<float>::infinity(), 0, 0, 0, 1, 0}, {0, 1, 2}, 3, 1),
      SceneError);
}

}  // namespace
}  // namespace nocturne
