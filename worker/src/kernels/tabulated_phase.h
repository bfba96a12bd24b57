// A phase function given by numbers, such as that of droplets from Mie's theory: linear between
// wavelengths and between cosines of the scattering angle. For light that is polarised it may have
// a matrix, as particles have that are turned at random and are as many as their mirror images; its
// elements are linear as the phase function is. C. F. Bohren and D. R. Huffman, Absorption and
// Scattering of Light by Small Particles, 1983, equations 4.77 and 13.21, whose S1 is positive in
// the plane of scattering; ours is across it, as in mueller.h.
#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "kernels/kernel.h"
#include "kernels/mueller.h"
#include "kernels/scattering_angle.h"

namespace nocturne {

class TabulatedPhase;

/// Over the phase function.
struct ScatteringElements {
  float s12, s22, s33, s34, s44;

  friend ScatteringElements operator*(float a, const ScatteringElements& b) {
    return {a * b.s12, a * b.s22, a * b.s33, a * b.s34, a * b.s44};
  }
  friend ScatteringElements operator+(const ScatteringElements& a, const ScatteringElements& b) {
    return {a.s12 + b.s12, a.s22 + b.s22, a.s33 + b.s33, a.s34 + b.s34, a.s44 + b.s44};
  }
};

template <int N>
struct BoundTabulatedPhase {
  /// Rows `low` and low + 1; `fraction` of the distance between them.
  struct Rows {
    std::size_t low;
    float fraction;
  };
  const TabulatedPhase* table;
  std::array<Rows, N> rows;
  Spectral<N> path_pdf_ratio;

  Spectral<N> density(const ScatteringAngle& angle) const;
  float mean_density(const ScatteringAngle& angle) const {
    return sum(path_pdf_ratio * density(angle));
  }
  /// A photon's row by the path pdf ratios, then by inversion.
  ScatteringAngle sample(const KernelNumbers& numbers) const;
  /// Depolarises where nothing is known of it.
  Mueller<N> mueller(const ScatteringAngle& angle) const;
};

class TabulatedPhase {
 public:
  static constexpr std::size_t kMaxWavelengths = 10'000, kMaxCosines = 100'000,
                               kMaxValues = 10'000'000;

  /// A place between two cosines.
  struct CosineCell {
    std::size_t cell;
    float fraction;
  };

  /// `wavelengths`: nm, increasing; the first and last hold outside. `cosines`: increasing from -1
  /// to 1. `values`: by wavelength, then cosine; not negative, not all zero in a row; any unit, as
  /// each row is normalised. `matrix`: as many as values, over them, each in [-1, 1]; or none.
  /// Throws std::invalid_argument.
  TabulatedPhase(const std::vector<double>& wavelengths, std::vector<double> cosines,
                 std::vector<float> values, std::vector<ScatteringElements> matrix = {});

  template <int N>
  BoundTabulatedPhase<N> bind(const Shading<N>& shading) const& {
    BoundTabulatedPhase<N> bound;
    bound.table = this;
    bound.path_pdf_ratio = shading.path_pdf_ratio;
    for (std::size_t i = 0; i < N; ++i) {
      const auto [low, fraction] = rows_at(shading.wavelengths[i]);
      bound.rows[i] = {low, fraction};
    }
    return bound;
  }
  /// The bound kernel points into the table.
  template <int N>
  BoundTabulatedPhase<N> bind(const Shading<N>&) const&& = delete;

  CosineCell place(double cosine) const;
  /// Of one wavelength's row, 1/sr.
  float density(std::size_t row, const CosineCell& at) const {
    const float* value = &values_[row * cosines_.size() + at.cell];
    return value[0] + at.fraction * (value[1] - value[0]);
  }
  bool has_matrix() const { return !matrix_.empty(); }
  /// Of one wavelength's row, times its density there.
  ScatteringElements elements(std::size_t row, const CosineCell& at) const {
    const std::size_t place = row * cosines_.size() + at.cell;
    return (1.0f - at.fraction) * values_[place] * matrix_[place] +
           at.fraction * values_[place + 1] * matrix_[place + 1];
  }
  /// A cosine by inversion of a row's cumulative distribution.
  double sample(std::size_t row, float u) const;

 private:
  struct RowsAt {
    std::size_t low;
    float fraction;
  };
  RowsAt rows_at(float wavelength_nm) const;

  std::vector<float> wavelengths_;
  // In double precision: large droplets want knots closer than single precision has numbers.
  std::vector<double> cosines_;
  // 1/sr, by row.
  std::vector<float> values_;
  std::vector<ScatteringElements> matrix_;
  // Probability below each cosine but the first, by row.
  std::vector<double> cumulative_;
};

template <int N>
Spectral<N> BoundTabulatedPhase<N>::density(const ScatteringAngle& angle) const {
  const TabulatedPhase::CosineCell at = table->place(angle.cosine());
  Spectral<N> r;
  for (std::size_t i = 0; i < N; ++i) {
    const auto& [low, fraction] = rows[i];
    r[i] = table->density(low, at);
    if (fraction > 0.0f) r[i] += fraction * (table->density(low + 1, at) - r[i]);
  }
  return r;
}

template <int N>
Mueller<N> BoundTabulatedPhase<N>::mueller(const ScatteringAngle& angle) const {
  Mueller<N> found;
  if (!table->has_matrix()) return found;
  const TabulatedPhase::CosineCell at = table->place(angle.cosine());
  const Spectral<N> all = density(angle);
  for (std::size_t i = 0; i < N; ++i) {
    if (!(all[i] > 0.0f)) continue;
    const auto& [low, fraction] = rows[i];
    ScatteringElements there = table->elements(low, at);
    if (fraction > 0.0f) {
      there = (1.0f - fraction) * there + fraction * table->elements(low + 1, at);
    }
    const ScatteringElements of = (1.0f / all[i]) * there;
    found.b[i] = -of.s12;
    found.a[i] = of.s22;
    found.c[i] = of.s33;
    found.d[i] = of.s44;
    found.s[i] = -of.s34;
  }
  return found;
}

template <int N>
ScatteringAngle BoundTabulatedPhase<N>::sample(const KernelNumbers& numbers) const {
  // Rounding may leave more than all path pdf ratios; then it is the last photon that has any.
  std::size_t photon = 0;
  float left = numbers.part, share = path_pdf_ratio[0];
  for (std::size_t i = 0; i < N; ++i) {
    if (!(path_pdf_ratio[i] > 0.0f)) continue;
    photon = i;
    share = path_pdf_ratio[i];
    if (left < share) break;
    if (i + 1 < N) left -= share;
  }
  const auto& [low, fraction] = rows[photon];
  const bool high = left < fraction * share;
  return ScatteringAngle::from_cosine(table->sample(high ? low + 1 : low, numbers.u));
}

}  // namespace nocturne
