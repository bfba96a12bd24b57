// Small compiled scenes for tests: grey walls, one flat response, everything else at the defaults
// that a scene document has.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

#include "nocturne/v1/scene.pb.h"
#include "scene/load_scene.h"

namespace nocturne::test {

/// The sensor's X, Y and Z are integrals of radiance over 500-600 nm: flat radiance L gives 100 L.
inline constexpr double kResponseIntegral = 100.0;

class SceneBuilder {
 public:
  v1::CompiledScene message;
  /// Blobs by hexadecimal name.
  std::map<std::string, std::filesystem::path> files;

  SceneBuilder() {
    message.set_format(3);
    auto& s = *message.mutable_sensor();
    s.mutable_right()->set_x(1);
    s.mutable_up()->set_y(1);
    s.mutable_forward()->set_z(-1);
    s.set_vertical_field_of_view(0.9);
    s.set_response_first_nm(500);
    s.set_response_step_nm(50);
    for (int i = 0; i < 3; ++i) {
      s.add_response_x(1);
      s.add_response_y(1);
      s.add_response_z(1);
    }
    s.set_wavelength_sampling(v1::WAVELENGTH_SAMPLING_RESPONSE);
    auto& t = *message.mutable_tracing();
    t.set_h(1);
    t.set_roulette(v1::ROULETTE_WEIGHT);
    t.set_maximum_depth(1000);
    t.set_weight_kernel(0.65);
    t.set_weight_luminaires(0.35);
    t.set_sequence(v1::SAMPLE_SEQUENCE_SOBOL);
    t.set_group(1);
  }

  /// A quad or sphere is set on the surface that is returned.
  v1::Surface& add_surface(float reflectance, float radiance, bool two_sided = false) {
    auto& surface = *message.add_surfaces();
    surface.set_kernel(static_cast<std::uint32_t>(message.kernels_size()));
    message.add_kernels()->mutable_lambertian()->mutable_reflectance()->set_spectrum(
        add_spectrum(reflectance));
    if (radiance > 0.0f) {
      auto& luminaire = *message.add_luminaires();
      luminaire.set_surface(static_cast<std::uint32_t>(message.surfaces_size()) - 1);
      luminaire.mutable_radiance()->set_spectrum(add_spectrum(radiance));
      luminaire.set_two_sided(two_sided);
    }
    return surface;
  }

  void add_quad(float reflectance, float radiance, Vec3 corner, Vec3 u, Vec3 v) {
    auto& quad = *add_surface(reflectance, radiance).mutable_quad();
    set(*quad.mutable_corner(), corner);
    set(*quad.mutable_edge_u(), u);
    set(*quad.mutable_edge_v(), v);
  }

  void add_sphere(float reflectance, float radiance, Vec3 centre, double radius) {
    auto& sphere = *add_surface(reflectance, radiance).mutable_sphere();
    set(*sphere.mutable_centre(), centre);
    sphere.set_radius(radius);
  }

  /// A closed box [-1, 1]^3 seen from inside, all of whose walls emit.
  void add_furnace(float albedo, float radiance) {
    add_quad(albedo, radiance, {-1, -1, -1}, {2, 0, 0}, {0, 2, 0});  // normals point inwards
    add_quad(albedo, radiance, {-1, -1, 1}, {0, 2, 0}, {2, 0, 0});
    add_quad(albedo, radiance, {-1, -1, -1}, {0, 2, 0}, {0, 0, 2});
    add_quad(albedo, radiance, {1, -1, -1}, {0, 0, 2}, {0, 2, 0});
    add_quad(albedo, radiance, {-1, -1, -1}, {0, 0, 2}, {2, 0, 0});
    add_quad(albedo, radiance, {-1, 1, -1}, {2, 0, 0}, {0, 0, 2});
  }

  /// Coefficients are indices of spectra, 1/m.
  std::uint32_t add_medium(std::uint32_t absorption, std::uint32_t scattering, double g) {
    auto& medium = *message.add_media();
    medium.set_absorption(absorption);
    medium.set_scattering(scattering);
    medium.set_constant(1.0);
    medium.mutable_phase()->mutable_henyey_greenstein()->set_g(g);
    return static_cast<std::uint32_t>(message.media_size()) - 1;
  }

  /// Falls exponentially from density 1 at `base`: with y where `base` is off the axis in y, else
  /// z.
  void set_scale_height(std::uint32_t medium, Vec3 base, double height) {
    auto& altitude = *message.mutable_media(static_cast<int>(medium))->mutable_altitude();
    set(*altitude.mutable_base(), base);
    set(*altitude.mutable_up(), base.y != 0.0f ? Vec3{0, 1, 0} : Vec3{0, 0, 1});
    altitude.set_scale_height(height);
  }

  void add_matched_sphere(Vec3 centre, double radius, const std::vector<std::uint32_t>& media) {
    auto& sphere = *add_boundary(add_matched(media)).mutable_sphere();
    set(*sphere.mutable_centre(), centre);
    sphere.set_radius(radius);
  }

  void add_matched_box(Vec3 low, Vec3 high, const std::vector<std::uint32_t>& media) {
    add_box(low, high,
            [this, body = add_matched(media)]() -> v1::Surface& { return add_boundary(body); });
  }

  void add_unbounded(const std::vector<std::uint32_t>& media) {
    message.add_unbounded_interiors(add_matched(media));
  }

  void add_glass_box(Vec3 low, Vec3 high, float index) {
    message.add_interiors()->set_index(add_spectrum(index));
    const auto body = static_cast<std::uint32_t>(message.interiors_size()) - 1;
    add_box(low, high, [this, body]() -> v1::Surface& {
      auto& surface = *message.add_surfaces();
      surface.set_kernel(static_cast<std::uint32_t>(message.kernels_size()));
      auto& roughness = *message.add_kernels()->mutable_dielectric()->mutable_roughness();
      roughness.mutable_alpha_u()->set_constant(0.0);
      roughness.mutable_alpha_v()->set_constant(0.0);
      surface.set_interior(body);
      return surface;
    });
  }

  /// Points the sensor at a target that is not above or below it.
  void look(Vec3 from, Vec3 at, double field_of_view) {
    const Vec3 forward = normalized(at - from);
    const Vec3 right = normalized(cross(forward, {0, 1, 0}));
    auto& sensor = *message.mutable_sensor();
    set(*sensor.mutable_position(), from);
    set(*sensor.mutable_forward(), forward);
    set(*sensor.mutable_right(), right);
    set(*sensor.mutable_up(), cross(right, forward));
    sensor.set_vertical_field_of_view(field_of_view);
  }

  std::shared_ptr<Scene> load() const {
    return load_scene(message, [this](const std::string& sha256) -> std::filesystem::path {
      const auto file = files.find(sha256);
      if (file == files.end()) throw std::runtime_error("no blob " + sha256);
      return file->second;
    });
  }

  static void set(v1::Vector& to, Vec3 v) {
    to.set_x(v.x);
    to.set_y(v.y);
    to.set_z(v.z);
  }

  /// Linear over the response.
  std::uint32_t add_ramp(float first, float last) {
    auto& spectrum = *message.add_spectra();
    spectrum.set_first_nm(500);
    spectrum.set_step_nm(100);
    spectrum.add_values(first);
    spectrum.add_values(last);
    return static_cast<std::uint32_t>(message.spectra_size()) - 1;
  }

  std::uint32_t add_spectrum(float value) {
    message.add_spectra()->add_values(value);
    return static_cast<std::uint32_t>(message.spectra_size()) - 1;
  }

 private:
  std::uint32_t add_matched(const std::vector<std::uint32_t>& media) {
    auto& interior = *message.add_interiors();
    interior.set_index_matched(true);
    for (const std::uint32_t medium : media) interior.add_media(medium);
    return static_cast<std::uint32_t>(message.interiors_size()) - 1;
  }

  v1::Surface& add_boundary(std::uint32_t body) {
    auto& surface = *message.add_surfaces();
    surface.set_kernel(static_cast<std::uint32_t>(message.kernels_size()));
    message.add_kernels()->mutable_null_kernel();
    surface.set_interior(body);
    return surface;
  }

  /// Six quads whose normals point out; `add` makes their surface.
  template <class Add>
  static void add_box(Vec3 low, Vec3 high, const Add& add) {
    const Vec3 size = high - low;
    const Vec3 x{size.x, 0, 0}, y{0, size.y, 0}, z{0, 0, size.z};
    const auto quad = [&](Vec3 corner, Vec3 u, Vec3 v) {
      auto& q = *add().mutable_quad();
      set(*q.mutable_corner(), corner);
      set(*q.mutable_edge_u(), u);
      set(*q.mutable_edge_v(), v);
    };
    quad(low, y, x);
    quad(low, z, y);
    quad(low, x, z);
    quad(low + z, x, y);
    quad(low + x, y, z);
    quad(low + y, z, x);
  }
};

}  // namespace nocturne::test
