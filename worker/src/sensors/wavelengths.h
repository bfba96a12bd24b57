// The wavelengths of a group of photons, and what the sensor's responses make of them.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "spectrum/rows.h"
#include "spectrum/spectral.h"
#include "spectrum/wavelength_density.h"

namespace nocturne {

/// Which light a further curve counts; see LightPart in scene.proto.
enum class LightPart { kWhole, kDirect, kIndirect };

/// All light, or a part of it: direct or indirect, or that of a light group.
struct CountedLight {
  LightPart part = LightPart::kWhole;
  std::optional<std::uint32_t> group = std::nullopt;
  /// Group i is S(i + 1) of the Stokes vector.
  bool stokes = false;

  bool all() const { return part == LightPart::kWhole && !group; }
};

/// A response that is a sum: of values of a sample, X, Y, Z and further ones, times factors.
struct SumOfValues {
  struct Term {
    std::size_t value;
    double factor;
  };
  std::vector<Term> terms;
};

/// Sampled response curves on one equally spaced grid, linear in between; per nm, K_m included.
struct ResponseCurves {
  float first_nm, step_nm;
  std::vector<float> x, y, z;
  /// Any number more.
  std::vector<std::vector<float>> further;
  /// Of each of these; of those that are missing here, all light.
  std::vector<CountedLight> counted = {};
  /// The last of the further curves count nothing, and are sums of values before them.
  std::vector<SumOfValues> sums = {};

  CountedLight light(std::size_t curve) const {
    return curve < counted.size() ? counted[curve] : CountedLight{};
  }
};

/// N wavelengths, each distributed like every other, together stratified.
template <int N>
struct WavelengthSamples {
  Spectral<N> nm;
  /// Response over density: the mean of weight x spectral radiance is X, Y, Z (Y in cd/m2).
  std::array<Spectral<N>, 3> weight;
  /// Place in the grid, and one over the density, nm.
  Spectral<N> position, inverse_density;
};

/// Knots in nm, and densities of any size; see WavelengthDensity.
struct DensityTable {
  std::vector<float> knots_nm, values;
};

/// Draws wavelengths: in proportion to X + Y + Z, with further curves of all light counting
/// as much, so that parts change nothing; uniformly; or from a density that is given, such as one
/// that finds narrow lines.
class WavelengthSampler {
 public:
  /// Throws std::invalid_argument where the curves are shorter than two values, differ in length or
  /// are all zero.
  WavelengthSampler(const ResponseCurves& curves, bool in_proportion_to_response);

  /// Also throws where the density is no WavelengthDensity, reaches out of the curves' grid, or is
  /// zero where a curve is not: what never is drawn would be missing.
  WavelengthSampler(const ResponseCurves& curves, const DensityTable& density);

  /// u in [0, 1). Photon k gets the wavelength that belongs to the fraction of u + k / N.
  template <int N>
  WavelengthSamples<N> sample(float u) const {
    Spectral<N> shifted;
    for (std::size_t k = 0; k < N; ++k) shifted.lanes[k] = u + static_cast<float>(k) / N;
    shifted.lanes = shifted.lanes >= 1.0f ? shifted.lanes - 1.0f : shifted.lanes;
    const auto drawn = density_.sample(shifted);
    WavelengthSamples<N> samples;
    samples.nm = drawn.nm;
    samples.inverse_density = drawn.inverse_density;
    samples.position = inverse_step_ * (drawn.nm + -first_nm_);
    std::array<Row, N> weights;
    for (std::size_t k = 0; k < N; ++k) {
      const std::size_t cell = cell_at(samples.position[k]);
      const float t = samples.position[k] - static_cast<float>(cell);
      weights[k] = xyz_[cell] + t * (xyz_[cell + 1] - xyz_[cell]);
    }
    for (std::size_t c = 0; c < 3; ++c) {
      samples.weight[c] = drawn.inverse_density * column(weights, c);
    }
    return samples;
  }

  std::size_t further_curves() const { return further_.size(); }
  /// Those before sums of others.
  std::size_t counting_curves() const { return counting_; }
  /// Of a sample's X, Y, Z and further values.
  void put_sums(double* values) const {
    double* sum = values + 3 + counting_;
    for (const SumOfValues& of : sums_) {
      for (const auto& [value, factor] : of.terms) *sum += factor * values[value];
      ++sum;
    }
  }
  const CountedLight& light(std::size_t curve) const { return counted_[curve]; }
  /// Whether any curve counts direct or indirect light only.
  bool tells_parts() const { return tells_parts_; }
  /// One more than the largest light group, or 3 of Stokes vectors, that any curve counts; 0: none
  /// asks.
  std::uint32_t light_groups() const { return light_groups_; }
  /// Whether these are of Stokes vectors.
  bool tells_stokes() const { return tells_stokes_; }

  /// The same as `weight` for a further curve.
  template <int N>
  Spectral<N> further_weight(std::size_t curve, const WavelengthSamples<N>& samples) const {
    const std::vector<float>& values = further_[curve];
    return each(
        [&](float position, float inverse_density) {
          const std::size_t cell = cell_at(position);
          const float t = position - static_cast<float>(cell);
          return inverse_density * (values[cell] + t * (values[cell + 1] - values[cell]));
        },
        samples.position, samples.inverse_density);
  }

  /// Density of sample, 1/nm; zero outside the grid.
  float pdf(float nm) const { return density_.pdf(nm); }

 private:
  std::size_t cell_at(float position) const {
    return std::min<std::size_t>(static_cast<std::uint32_t>(static_cast<std::int32_t>(position)),
                                 xyz_.size() - 2);
  }

  WavelengthDensity density_;
  float first_nm_, inverse_step_;
  std::vector<Row> xyz_;  // side by side; the fourth fills the row
  std::vector<std::vector<float>> further_;
  std::vector<CountedLight> counted_;
  std::vector<SumOfValues> sums_;
  std::size_t counting_;
  bool tells_parts_ = false;
  std::uint32_t light_groups_ = 0;
  bool tells_stokes_ = false;
};

}  // namespace nocturne
