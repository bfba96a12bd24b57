#include "scene/load_scene.h"

#include <cmath>
#include <numbers>

#include "scene/load_mesh.h"

namespace nocturne {
namespace {

constexpr std::uint32_t kFormat = 1;
// A photon costs at most this many rays; the scene compiler allows no more either.
constexpr std::uint32_t kMostDepth = 100'000;

[[noreturn]] void refuse(const std::string& what) { throw SceneError("compiled scene: " + what); }

void require(bool condition, const char* what) {
  if (!condition) refuse(what);
}

float finite(double value, const char* what) {
  const auto narrowed = static_cast<float>(value);
  if (!std::isfinite(narrowed)) refuse(std::string(what) + " is not finite");
  return narrowed;
}

Vec3 vector(const v1::Vector& v, const char* what) {
  return {finite(v.x(), what), finite(v.y(), what), finite(v.z(), what)};
}

Spectrum spectrum(const v1::Spectrum& message) {
  require(message.values_size() > 0, "a spectrum without values");
  for (const float value : message.values()) {
    require(std::isfinite(value) && value >= 0.0f, "a spectrum with a negative or infinite value");
  }
  if (message.values_size() == 1) return Spectrum(message.values(0));
  require(message.step_nm() > 0.0, "a spectrum without a step");
  return Spectrum(finite(message.first_nm(), "a wavelength"),
                  finite(message.step_nm(), "a wavelength step"),
                  {message.values().begin(), message.values().end()}, message.zero_outside());
}

class Loader {
 public:
  Loader(const v1::CompiledScene& message, const FindBlob& find_blob)
      : message_(message), find_blob_(find_blob) {
    if (message.format() != kFormat) {
      refuse("format " + std::to_string(message.format()) + "; this program reads format " +
             std::to_string(kFormat));
    }
    for (const auto& s : message.spectra()) spectra_.push_back(spectrum(s));
  }

  std::shared_ptr<const Scene> load() {
    auto luminaires = this->luminaires();
    auto shapes = this->shapes();
    LuminaireDirections directions(luminaires, shapes);
    const TracingOptions options = tracing(directions.empty());
    return std::shared_ptr<const Scene>(
        new Scene{Geometry(std::move(shapes)), materials(), kernels(), std::move(luminaires),
                  std::move(directions), camera(), wavelengths(), options});
  }

 private:
  const Spectrum& spectrum_at(std::uint32_t index) const {
    require(index < spectra_.size(), "a spectrum index out of range");
    return spectra_[index];
  }

  std::vector<Shape> shapes() const {
    require(message_.surfaces_size() > 0, "no surfaces");
    std::vector<Shape> shapes;
    for (const auto& surface : message_.surfaces()) shapes.push_back(shape(surface));
    return shapes;
  }

  Shape shape(const v1::Surface& surface) const {
    switch (surface.shape_case()) {
      case v1::Surface::kMesh:
        return load_mesh(surface.mesh(), find_blob_);
      case v1::Surface::kSphere: {
        const auto& s = surface.sphere();
        vector(s.centre(), "a sphere's centre");
        require(std::isfinite(s.radius()) && s.radius() > 0.0, "a sphere without a radius");
        return Sphere{s.centre().x(), s.centre().y(), s.centre().z(), s.radius()};
      }
      case v1::Surface::kQuad:
        return quad(surface.quad());
      case v1::Surface::SHAPE_NOT_SET:
        break;
    }
    refuse("a surface of a shape that this program doesn't know");
  }

  static TriangleMesh quad(const v1::Quad& q) {
    const Vec3 corner = vector(q.corner(), "a quad's corner");
    const Vec3 u = vector(q.edge_u(), "a quad's edge"), v = vector(q.edge_v(), "a quad's edge");
    return {{corner, corner + u, corner + u + v, corner + v}, {{0, 1, 2}, {0, 2, 3}}};
  }

  std::vector<SurfaceMaterial> materials() const {
    std::vector<SurfaceMaterial> materials;
    for (const auto& surface : message_.surfaces()) {
      require(surface.kernel() < static_cast<std::uint32_t>(message_.kernels_size()),
              "a kernel index out of range");
      materials.push_back({surface.kernel(), SurfaceMaterial::kNoLuminaire});
    }
    for (int i = 0; i < message_.luminaires_size(); ++i) {
      auto& material = materials[message_.luminaires(i).surface()];
      require(material.luminaire == SurfaceMaterial::kNoLuminaire, "a surface with two luminaires");
      material.luminaire = static_cast<std::uint32_t>(i);
    }
    return materials;
  }

  std::vector<AnyKernel> kernels() const {
    std::vector<AnyKernel> kernels;
    for (const auto& kernel : message_.kernels()) {
      require(kernel.has_lambertian(), "a kernel that this program doesn't know");
      kernels.emplace_back(Lambertian{spectrum_at(kernel.lambertian().reflectance())});
    }
    return kernels;
  }

  std::vector<Luminaire> luminaires() const {
    std::vector<Luminaire> luminaires;
    for (const auto& luminaire : message_.luminaires()) {
      require(luminaire.surface() < static_cast<std::uint32_t>(message_.surfaces_size()),
              "a luminaire on a surface that is not there");
      luminaires.push_back(
          {luminaire.surface(), spectrum_at(luminaire.radiance()), luminaire.two_sided()});
    }
    return luminaires;
  }

  Camera camera() const {
    const auto& s = message_.sensor();
    require(s.vertical_field_of_view() > 0.0 && s.vertical_field_of_view() < std::numbers::pi,
            "a field of view outside (0, pi)");
    require(s.lens_radius() >= 0.0 && (s.lens_radius() == 0.0 || s.focus_distance() > 0.0),
            "a lens without a focus distance");
    return {vector(s.position(), "the sensor's position"),
            vector(s.right(), "the sensor's right"),
            vector(s.up(), "the sensor's up"),
            vector(s.forward(), "the sensor's forward"),
            finite(std::tan(0.5 * s.vertical_field_of_view()), "the field of view"),
            finite(s.lens_radius(), "the lens radius"),
            finite(s.focus_distance(), "the focus distance")};
  }

  WavelengthSampler wavelengths() const {
    const auto& s = message_.sensor();
    const auto curve = [](const auto& values) {
      for (const float value : values) {
        require(std::isfinite(value) && value >= 0.0f, "a response that is negative or infinite");
      }
      return std::vector<float>(values.begin(), values.end());
    };
    require(s.wavelength_sampling() == v1::WAVELENGTH_SAMPLING_RESPONSE ||
                s.wavelength_sampling() == v1::WAVELENGTH_SAMPLING_UNIFORM,
            "a wavelength sampling that this program doesn't know");
    return WavelengthSampler({finite(s.response_first_nm(), "a wavelength"),
                              finite(s.response_step_nm(), "a wavelength step"),
                              curve(s.response_x()), curve(s.response_y()), curve(s.response_z())},
                             s.wavelength_sampling() == v1::WAVELENGTH_SAMPLING_RESPONSE);
  }

  // Without anything to point at, the luminaires' weight goes to the kernel.
  TracingOptions tracing(bool no_luminaire_directions) const {
    const auto& t = message_.tracing();
    double kernel = t.weight_kernel(), luminaires = t.weight_luminaires();
    const double uniform = t.weight_uniform();
    require(kernel >= 0.0 && luminaires >= 0.0 && uniform >= 0.0 &&
                std::fabs(kernel + luminaires + uniform - 1.0) < 1e-6,
            "mixture weights that are negative or don't add up to 1");
    if (no_luminaire_directions) {
      kernel += luminaires;
      luminaires = 0.0;
    }
    require(t.h() > 0.0 && std::isfinite(t.h()), "h is not positive");
    require(t.maximum_depth() >= 1 && t.maximum_depth() <= kMostDepth,
            "a maximum depth outside [1, 100000]");
    require(t.sequence() == v1::SAMPLE_SEQUENCE_SOBOL ||
                t.sequence() == v1::SAMPLE_SEQUENCE_INDEPENDENT,
            "a sample sequence that this program doesn't know");
    require(t.roulette() == v1::ROULETTE_WEIGHT || t.roulette() == v1::ROULETTE_ALBEDO,
            "a roulette that this program doesn't know");
    return {
        static_cast<float>(t.h()),
        t.roulette() == v1::ROULETTE_WEIGHT,
        t.maximum_depth(),
        {static_cast<float>(kernel), static_cast<float>(luminaires), static_cast<float>(uniform)},
        t.sequence() == v1::SAMPLE_SEQUENCE_SOBOL ? SequenceKind::kSobol
                                                  : SequenceKind::kIndependent,
        t.seed()};
  }

  const v1::CompiledScene& message_;
  const FindBlob& find_blob_;
  std::vector<Spectrum> spectra_;
};

}  // namespace

std::shared_ptr<const Scene> load_scene(const v1::CompiledScene& message,
                                        const FindBlob& find_blob) {
  return Loader(message, find_blob).load();
}

}  // namespace nocturne
