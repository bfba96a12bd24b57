#include <gtest/gtest.h>

#include <functional>
#include <limits>

#include "support/scene_builder.h"

namespace nocturne {
namespace {

test::SceneBuilder scene_with_a_line() {
  test::SceneBuilder builder;
  builder.add_quad(0.5f, 1.0f, {0, 0, 0}, {1, 0, 0}, {0, 1, 0});
  auto& line = *builder.message.mutable_spectra(1)->add_lines();
  line.set_centre_nm(550);
  line.set_power(1);
  line.set_width_nm(0.01);
  for (const double nm : {500.0, 549.99, 550.0, 550.01, 600.0}) {
    builder.message.mutable_sensor()->add_wavelength_knots(nm);
    builder.message.mutable_sensor()->add_wavelength_density(nm == 550.0 ? 50.0f : 0.005f);
  }
  return builder;
}

TEST(LoadLines, TakesLinesAndADensity) {
  const auto scene = scene_with_a_line().load();
  EXPECT_NEAR(scene->wavelengths.pdf(550.0f), 50.0, 0.5);
}

struct Damage {
  const char* says;
  std::function<void(v1::Spectrum&, v1::Sensor&)> apply;
};

TEST(LoadLines, RefusesDamagedMessagesInWords) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const Damage damages[] = {
      {"centre", [&](auto& m, auto&) { m.mutable_lines(0)->set_centre_nm(nan); }},
      {"power", [&](auto& m, auto&) { m.mutable_lines(0)->set_power(1e39); }},
      {"negative", [](auto& m, auto&) { m.mutable_lines(0)->set_power(-1); }},
      {"width", [&](auto& m, auto&) { m.mutable_lines(0)->set_width_nm(nan); }},
      {"0.001", [](auto& m, auto&) { m.mutable_lines(0)->set_width_nm(0); }},
      {"0.001", [](auto& m, auto&) { m.mutable_lines(0)->set_width_nm(-1); }},
      {"10000",
       [](auto& m, auto&) {
         for (int i = 0; i < 10'000; ++i) *m.add_lines() = m.lines(0);
       }},
      {"values", [](auto& m, auto&) { m.clear_values(); }},
      {"knots", [](auto&, auto& s) { s.clear_wavelength_knots(); }},
      {"knots", [](auto&, auto& s) { s.clear_wavelength_density(); }},
      {"go back", [](auto&, auto& s) { s.set_wavelength_knots(1, 560); }},
      {"negative", [](auto&, auto& s) { s.set_wavelength_density(1, -1); }},
      {"out of", [](auto&, auto& s) { s.set_wavelength_knots(0, 499); }},
      {"zero where", [](auto&, auto& s) { s.set_wavelength_knots(0, 510); }},
      {"not finite", [&](auto&, auto& s) { s.set_wavelength_knots(0, nan); }},
      {"100000",
       [](auto&, auto& s) {
         for (int i = 0; i < 100'000; ++i) s.add_wavelength_knots(600);
       }},
  };
  for (const Damage& damage : damages) {
    auto builder = scene_with_a_line();
    damage.apply(*builder.message.mutable_spectra(1), *builder.message.mutable_sensor());
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
