#include "scene/load_scene.h"

#include <gtest/gtest.h>

#include <functional>
#include <limits>

#include "support/caustic_scene.h"
#include "support/scene_builder.h"

namespace nocturne {
namespace {

test::SceneBuilder good_scene() {
  test::SceneBuilder builder;
  builder.add_quad(0.5f, 1.0f, {0, 0, 0}, {1, 0, 0}, {0, 1, 0});
  return builder;
}

TEST(LoadScene, TakesAGoodScene) { EXPECT_NO_THROW(good_scene().load()); }

TEST(LoadScene, EndsWhenAStopIsRequested) {
  const test::SceneBuilder builder = good_scene();
  const FindBlob none = [](const std::string&) -> std::filesystem::path { return {}; };
  std::stop_source stop;
  EXPECT_NO_THROW(load_scene(builder.message, none, stop.get_token()));
  stop.request_stop();
  EXPECT_THROW(load_scene(builder.message, none, stop.get_token()), SceneError);
}

std::uint32_t add_spectrum(v1::CompiledScene& scene, float value) {
  scene.add_spectra()->add_values(value);
  return static_cast<std::uint32_t>(scene.spectra_size()) - 1;
}

struct Damage {
  const char* says;
  std::function<void(v1::CompiledScene&)> apply;
};

// The range of distances near a camera does not depend on the size of the ground.
TEST(LoadScene, WhatIsNearACameraIsMeasuredByWhatItSees) {
  for (const float half : {3.0f, 3000.0f}) {
    test::SceneBuilder builder = test::floor_and_lamp(true);
    builder.add_quad(0.5f, 0.0f, {-half, -1.001f, -half}, {0, 0, 2 * half}, {2 * half, 0, 0});
    EXPECT_NEAR(builder.load()->near_ends, 0.2f, 0.05f) << half;
  }
}

// Their photons would start in media that they know nothing of.
TEST(LoadScene, RefusesPhotonsOfDistantLightInUnboundedMedia) {
  test::SceneBuilder builder = test::floor_and_lamp(true);
  builder.add_unbounded({});
  EXPECT_NO_THROW(builder.load());
  builder.message.mutable_environment()->set_constant(add_spectrum(builder.message, 1.0f));
  EXPECT_THROW(builder.load(), SceneError);
  builder.message.mutable_tracing()->set_direction(v1::DIRECTION_ADJOINT);
  EXPECT_NO_THROW(builder.load());
}

// What a worker gets comes over a network: every number is checked before it is used.
v1::Interior& add_body(v1::CompiledScene& message) {
  auto& interior = *message.add_interiors();
  interior.set_index_matched(true);
  return interior;
}

v1::Response& add_counted_group(v1::CompiledScene& message) {
  auto& response = *message.mutable_sensor()->add_further_responses();
  *response.mutable_values() = message.sensor().response_y();
  return response;
}

v1::Fluorescent::Fluorophore& add_fluorophore(v1::CompiledScene& message) {
  auto& fluorescent = *message.mutable_kernels(0)->mutable_fluorescent();
  fluorescent.mutable_reflectance()->set_spectrum(add_spectrum(message, 0.2f));
  auto& added = *fluorescent.add_fluorophores();
  added.set_absorption(add_spectrum(message, 0.5f));
  added.set_emission(add_spectrum(message, 1e-6f));
  return added;
}

v1::PolarisingFilter& add_filter(v1::CompiledScene& message) {
  auto& filter = *message.mutable_kernels(0)->mutable_polarising_filter();
  filter.set_along(add_spectrum(message, 1.0f));
  filter.set_across(add_spectrum(message, 0.0f));
  filter.set_retardance(filter.across());
  filter.mutable_axis()->set_x(1.0);
  return filter;
}

TEST(LoadScene, KnowsPolarisationWhereAFilterIsOrTheSensorAsks) {
  test::SceneBuilder builder = good_scene();
  EXPECT_FALSE(builder.load()->polarised);
  add_counted_group(builder.message).set_stokes(2);
  EXPECT_TRUE(builder.load()->polarised);
  builder.message.mutable_sensor()->clear_further_responses();
  add_filter(builder.message);
  EXPECT_TRUE(builder.load()->polarised);
}

TEST(LoadScene, TakesFluorescenceOfPhotonsFromTheSensor) {
  test::SceneBuilder builder = good_scene();
  add_fluorophore(builder.message);
  EXPECT_NO_THROW(builder.load());
}

v1::Medium& add_dyed_medium(v1::CompiledScene& message) {
  auto& medium = *message.add_media();
  medium.mutable_phase()->mutable_henyey_greenstein()->set_g(0.0);
  medium.set_constant(1.0);
  medium.set_absorption(add_spectrum(message, 0.5f));
  medium.set_scattering(add_spectrum(message, 0.0f));
  medium.set_null_collisions(medium.absorption());
  auto& dye = *medium.add_fluorophores();
  dye.set_absorption(medium.absorption());
  dye.set_emission(add_spectrum(message, 1e-6f));
  return medium;
}

TEST(LoadScene, TakesDyesInMedia) {
  test::SceneBuilder builder = good_scene();
  add_dyed_medium(builder.message);
  const auto scene = builder.load();
  const Spectral<1> nm = 500.0f;
  EXPECT_FLOAT_EQ(scene->media[0].extinction(nm)[0], 0.5f);
  EXPECT_FLOAT_EQ(scene->media[0].collisions(nm)[0], 1.0f);
}

TEST(LoadScene, RefusesDamagedMessagesInWords) {
  const Damage damages[] = {
      {"format", [](auto& m) { m.set_format(1); }},
      {"surfaces",
       [](auto& m) {
         m.clear_surfaces();
         m.clear_luminaires();
       }},
      {"kernel index", [](auto& m) { m.mutable_surfaces(0)->set_kernel(7); }},
      {"spectrum index",
       [](auto& m) {
         m.mutable_kernels(0)->mutable_lambertian()->mutable_reflectance()->set_spectrum(9);
       }},
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
      {"200 to 2500 nm",
       [](auto& m) {
         m.set_format(7);
         m.mutable_sensor()->set_response_first_nm(150);
       }},
      {"add up", [](auto& m) { m.mutable_tracing()->set_weight_kernel(0.9); }},
      {"h is", [](auto& m) { m.mutable_tracing()->set_h(0); }},
      {"medium index", [](auto& m) { add_body(m).add_media(0); }},
      {"unbounded interior", [](auto& m) { m.add_unbounded_interiors(0); }},
      {"dielectric",
       [](auto& m) {
         add_body(m).set_index_matched(false);
         m.add_unbounded_interiors(0);
       }},
      {"phase function", [](auto& m) { m.add_media()->set_constant(1.0); }},
      {"density",
       [](auto& m) { m.add_media()->mutable_phase()->mutable_henyey_greenstein()->set_g(0.0); }},
      {"density is negative",
       [](auto& m) {
         auto& medium = *m.add_media();
         medium.mutable_phase()->mutable_henyey_greenstein()->set_g(0.0);
         medium.set_constant(-1.0);
       }},
      {"axis", [](auto& m) { add_filter(m).mutable_axis()->set_x(2.0); }},
      {"more than all", [](auto& m) { add_filter(m).set_along(add_spectrum(m, 1.5f)); }},
      {"polarised light where",
       [](auto& m) {
         add_filter(m);
         m.mutable_tracing()->set_sharing(16);
       }},
      {"Stokes", [](auto& m) { add_counted_group(m).set_stokes(4); }},
      {"a sum of later ones", [](auto& m) { add_counted_group(m).add_terms()->set_value(3); }},
      {"impossible factor",
       [](auto& m) {
         add_counted_group(m).add_terms()->set_factor(std::numeric_limits<double>::infinity());
       }},
      {"after sums of others",
       [](auto& m) {
         add_counted_group(m).add_terms()->set_value(1);
         add_counted_group(m).set_stokes(1);
       }},
      {"polarised light and to parts",
       [](auto& m) {
         add_counted_group(m).set_stokes(1);
         add_counted_group(m).set_light(v1::LIGHT_PART_DIRECT);
       }},
      {"no fluorophore", [](auto& m) { m.mutable_kernels(0)->mutable_fluorescent(); }},
      {"fluorescence where",
       [](auto& m) {
         add_fluorophore(m);
         m.mutable_tracing()->set_sharing(16);
       }},
      {"spectrum index", [](auto& m) { add_fluorophore(m).set_absorption(99); }},
      {"fluorescence where",
       [](auto& m) {
         add_dyed_medium(m);
         m.mutable_tracing()->set_sharing(16);
       }},
      {"spectrum index", [](auto& m) { add_dyed_medium(m).set_null_collisions(99); }},
      {"glows and fluoresces",
       [](auto& m) { add_dyed_medium(m).mutable_temperature()->set_blob("x"); }},
      {"not as many as each other",
       [](auto& m) {
         auto& medium = add_dyed_medium(m);
         auto& table = *medium.mutable_phase()->mutable_tabulated();
         table.add_wavelengths(500);
         for (const double cosine : {-1.0, 1.0}) table.add_cosines(cosine);
         for (const float value : {1.0f, 1.0f}) table.add_values(value);
         for (const float element : {0.0f, 0.0f}) table.add_s12(element);
       }},
      {"zero everywhere",
       [](auto& m) { add_fluorophore(m).set_absorption(add_spectrum(m, 0.0f)); }},
      {"with lines",
       [](auto& m) {
         const auto index = static_cast<int>(add_fluorophore(m).emission());
         auto& line = *m.mutable_spectra(index)->add_lines();
         line.set_centre_nm(500);
         line.set_power(1);
         line.set_width_nm(1);
       }},
      {"roulette", [](auto& m) { m.mutable_tracing()->clear_roulette(); }},
      {"sequence", [](auto& m) { m.mutable_tracing()->clear_sequence(); }},
      {"group of photons", [](auto& m) { m.mutable_tracing()->set_group(3); }},
      {"block of pixels", [](auto& m) { m.mutable_tracing()->set_sharing(4); }},
      {"split", [](auto& m) { m.mutable_tracing()->set_split_vertices(9); }},
      {"aimed", [](auto& m) { m.mutable_tracing()->set_aimed_emission(1.0); }},
      {"forward photons",
       [](auto& m) { m.mutable_tracing()->set_direction(v1::DIRECTION_FORWARD); }},
      {"both directions need a camera",
       [](auto& m) {
         m.mutable_tracing()->set_direction(v1::DIRECTION_BOTH);
         m.mutable_sensor()->set_model(v1::SENSOR_MODEL_PLANE);
         m.mutable_sensor()->set_height(1.0);
       }},
      {"interior index", [](auto& m) { m.mutable_surfaces(0)->set_interior(0); }},
      {"index of refraction", [](auto& m) { m.add_interiors()->set_index(add_spectrum(m, 0.0f)); }},
      {"number out of range",
       [](auto& m) {
         auto& conductor = *m.add_kernels()->mutable_conductor();
         conductor.mutable_roughness()->mutable_alpha_u()->set_constant(-1);
       }},
      {"blend of a blend",
       [](auto& m) {
         m.add_kernels()->mutable_blend()->add_parts()->set_kernel(0);
         m.add_kernels()->mutable_blend()->add_parts()->set_kernel(1);
       }},
      {"blend", [](auto& m) { m.add_kernels()->mutable_blend(); }},
      {"coat's index",
       [](auto& m) {
         auto& principled = *m.add_kernels()->mutable_principled();
         *principled.mutable_base() = m.kernels(0).lambertian().reflectance();
         principled.set_coat_index(0.5);
       }},
      {"12 numbers", [](auto& m) { m.add_instances()->add_transforms(1.0); }},
      {"important shape", [](auto& m) { m.add_important_shapes()->set_weight(1); }},
      {"without texels", [](auto& m) { m.mutable_environment()->mutable_map(); }},
      {"further responses",
       [](auto& m) {
         for (int i = 0; i < 61; ++i) m.mutable_sensor()->add_further_responses();
       }},
      {"light group that no response counts",
       [](auto& m) {
         add_counted_group(m).set_light_group(1);
         m.mutable_environment()->set_constant(add_spectrum(m, 1.0f));
         m.mutable_environment()->set_light_group(2);
       }},
      {"rays of a file", [](auto& m) { m.add_ray_sets()->set_count(1); }},
      {"too large a number", [](auto& m) { add_counted_group(m).set_light_group(64); }},
      {"part of the light of a light group",
       [](auto& m) {
         add_counted_group(m).set_light_group(1);
         m.mutable_sensor()->mutable_further_responses(0)->set_light(v1::LIGHT_PART_DIRECT);
       }},
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

}  // namespace
}  // namespace nocturne
