#include "scene/load_media.h"

#include <algorithm>
#include <array>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>

#include "scene/load_special_kernels.h"

namespace nocturne {
namespace {

using Shape = decltype(Phase::shape);

std::vector<ScatteringElements> load_matrix(const v1::TabulatedPhase& message) {
  const int count = message.s12_size();
  const auto fits = [count](int size) { return size == count; };
  require(fits(message.s33_size()) && fits(message.s34_size()) &&
              (message.s22_size() == 0 || fits(message.s22_size())) &&
              (message.s44_size() == 0 || fits(message.s44_size())),
          "a phase matrix whose elements are not as many as each other");
  std::vector<ScatteringElements> matrix;
  for (int i = 0; i < count; ++i) {
    matrix.push_back({message.s12(i), message.s22_size() == 0 ? 1.0f : message.s22(i),
                      message.s33(i), message.s34(i),
                      message.s44_size() == 0 ? message.s33(i) : message.s44(i)});
  }
  return matrix;
}

Shape load_tabulated(const v1::TabulatedPhase& message) {
  require(message.wavelengths_size() <= static_cast<int>(TabulatedPhase::kMaxWavelengths) &&
              message.cosines_size() <= static_cast<int>(TabulatedPhase::kMaxCosines) &&
              message.values_size() <= static_cast<int>(TabulatedPhase::kMaxValues),
          "a phase function with too many values");
  return TabulatedPhase({message.wavelengths().begin(), message.wavelengths().end()},
                        {message.cosines().begin(), message.cosines().end()},
                        {message.values().begin(), message.values().end()}, load_matrix(message));
}

Shape load_shape(const LoadContext& context, const v1::PhaseFunction& message) {
  switch (message.shape_case()) {
    case v1::PhaseFunction::kHenyeyGreenstein:
      return HenyeyGreenstein(message.henyey_greenstein().g());
    case v1::PhaseFunction::kDoubleHenyeyGreenstein: {
      const auto& two = message.double_henyey_greenstein();
      return DoubleHenyeyGreenstein(two.g_first(), two.g_second(), two.weight());
    }
    case v1::PhaseFunction::kRayleigh: {
      const auto& rayleigh = message.rayleigh();
      if (!rayleigh.has_depolarisation()) return RayleighPhase(std::nullopt);
      return RayleighPhase(context.spectrum(rayleigh.depolarisation()));
    }
    case v1::PhaseFunction::kTabulated:
      return load_tabulated(message.tabulated());
    case v1::PhaseFunction::SHAPE_NOT_SET:
      break;
  }
  refuse("a phase function that this program doesn't know");
}

AltitudeDensity load_altitude(const v1::AltitudeDensity& message) {
  const Ground ground{Double3(message.base().x(), message.base().y(), message.base().z()),
                      Double3(message.up().x(), message.up().y(), message.up().z()),
                      message.radius()};
  switch (message.profile_case()) {
    case v1::AltitudeDensity::kScaleHeight:
      return AltitudeDensity::exponential(ground, message.scale_height());
    case v1::AltitudeDensity::kTable:
      return AltitudeDensity::table(
          ground, {message.table().altitudes().begin(), message.table().altitudes().end()},
          {message.table().densities().begin(), message.table().densities().end()});
    case v1::AltitudeDensity::PROFILE_NOT_SET:
      break;
  }
  refuse("a profile over altitude that this program doesn't know");
}

// Grids are large, and density and temperature, or several media, may share one.
class Grids {
 public:
  explicit Grids(const LoadContext& context) : context_(context) {}

  GridField field(const v1::DensityGrid& message) {
    auto& grid = grids_[message.blob()];
    if (!grid) {
      grid = std::make_shared<FloatGrid>(
          FloatGrid::map(context_.find_blob(blob_name(message.blob()))));
    }
    require(message.transform_size() == 12, "a grid's transform that is not 12 numbers");
    std::array<double, 12> transform;
    std::ranges::copy(message.transform(), transform.begin());
    return GridField(grid, transform, message.scale(), message.nearest());
  }

 private:
  const LoadContext& context_;
  std::map<std::string, std::shared_ptr<const FloatGrid>> grids_;
};

AnyDensity load_density(const v1::Medium& message, Grids& grids) {
  switch (message.density_case()) {
    case v1::Medium::kConstant:
      require(message.constant() >= 0.0, "a medium's density is negative");
      return ConstantDensity{finite(message.constant(), "a medium's density")};
    case v1::Medium::kAltitude:
      return load_altitude(message.altitude());
    case v1::Medium::kGrid:
      return GridDensity(grids.field(message.grid()));
    default:
      refuse("a medium's density that this program doesn't know");
  }
}

std::optional<Glow> load_glow(const v1::Medium& message, Grids& grids) {
  if (!message.has_temperature()) return std::nullopt;
  const float scale = finite(message.emission_scale(), "a medium's emission scale");
  require(scale >= 0.0f, "a medium's emission scale is negative");
  return Glow(grids.field(message.temperature()), scale);
}

std::optional<Spectrum> load_null_collisions(const LoadContext& context,
                                             const v1::Medium& message) {
  if (message.fluorophores_size() == 0) return std::nullopt;
  require(!message.has_temperature(), "a medium that glows and fluoresces");
  return context.spectrum(message.null_collisions());
}

}  // namespace

std::vector<Medium> load_media(const LoadContext& context, std::vector<AnyKernel>& kernels,
                               std::vector<SurfaceMaterial>& materials) {
  std::vector<Medium> media;
  Grids grids(context);
  for (const auto& message : context.message.media()) {
    const Spectrum& absorption = context.spectrum(message.absorption());
    const Spectrum& scattering = context.spectrum(message.scattering());
    const auto kernel = static_cast<std::uint32_t>(kernels.size());
    const bool fluoresces = message.fluorophores_size() > 0;
    const std::optional<Spectrum> null_collisions = load_null_collisions(context, message);
    Phase phase{absorption, scattering, load_shape(context, message.phase())};
    if (fluoresces) {
      kernels.emplace_back(FluorescentPhase{std::move(phase),
                                            load_fluorophores(context, message.fluorophores()),
                                            null_collisions.value_or(Spectrum(0.0f))});
    } else {
      kernels.emplace_back(std::move(phase));
    }
    materials.push_back(
        {.front_kernel = kernel, .back_kernel = kernel, .has_delta_lobe = fluoresces});
    media.push_back({absorption, scattering, load_density(message, grids),
                     load_glow(message, grids), null_collisions});
  }
  return media;
}

}  // namespace nocturne
