// How an interaction changes the polarisation of light, as the Mueller matrix from the Stokes
// vector that comes to the one that leaves, over the share of unpolarised light that leaves:
//   | 1  b  .  . |
//   | b  a  .  . |
//   | .  .  c -s |
//   | .  .  s  d |
// Both vectors refer to one direction across both rays, or, where light goes straight on, to the
// filter's axis: S1 is positive where the field is along it, S2 where it is along the middle
// between it and the direction that follows it counterclockwise as the receiver sees it, S3 where
// it turns clockwise as the receiver sees it. Waves go as e^(i k z). Born and Wolf, Principles of
// Optics, 7th ed., section 10.8; signs: docs/explanation/polarisation.md.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>

#include "kernels/thin_film.h"

namespace nocturne {

/// Of each photon. As it is made it depolarises: all that leaves is unpolarised.
template <int N>
struct Mueller {
  Spectral<N> b = 0.0f, a = 0.0f, c = 0.0f, d = 0.0f, s = 0.0f;
  /// The share of unpolarised light that leaves, over what the kernel's value says, which may take
  /// it for unpolarised within.
  Spectral<N> size = 1.0f;

  static Mueller unchanged() { return {0.0f, 1.0f, 1.0f, 1.0f, 0.0f, 1.0f}; }
  void keep(std::size_t photon) { a[photon] = c[photon] = d[photon] = 1.0f; }

  /// Of shares of the power along the direction and across it, and the mean product of the field
  /// along it with the other's conjugate.
  void set(std::size_t photon, double along, double across, Complex product) {
    const double mean = 0.5 * (along + across);
    if (!(mean > 0.0)) return;
    b[photon] = static_cast<float>(0.5 * (along - across) / mean);
    a[photon] = 1.0f;
    c[photon] = d[photon] = static_cast<float>(product.re / mean);
    s[photon] = static_cast<float>(product.im / mean);
  }
  /// Where the field along the direction is multiplied by the first number, and that across it by
  /// the second.
  void set(std::size_t photon, Complex along, Complex across) {
    set(photon, along.norm(), across.norm(), along * across.conjugate());
  }

  /// The face of a dielectric without layers, by Fresnel's amplitudes (fresnel.h); `ratio`: index
  /// beyond over index on the side of the light. Of transmitted amplitudes only their ratio
  /// counts.
  void set_face(std::size_t photon, float cosine, float ratio, bool reflects) {
    const float contrast = (ratio - 1.0f) * (ratio + 1.0f), square = ratio * ratio;
    const float g2 = contrast + cosine * cosine;
    if (g2 > 0.0f) {
      const float g = std::sqrt(g2), across = cosine + g, within = square * cosine + g;
      const float rs = reflects ? -contrast / (across * across) : 1.0f / across;
      const float rp =
          reflects ? contrast * ((square + 1.0f) * cosine * cosine - 1.0f) / (within * within)
                   : ratio / within;
      const float mean = 0.5f * (rs * rs + rp * rp);
      if (!(mean > 0.0f)) return;
      b[photon] = 0.5f * (rs * rs - rp * rp) / mean;
      a[photon] = 1.0f;
      c[photon] = d[photon] = rs * rp / mean;
    } else if (reflects) {  // totally: both amplitudes turn their phases
      const float decay = std::sqrt(-g2);
      const float real = square * cosine * cosine - g2, imaginary = -cosine * decay * contrast;
      const float whole = real * real + imaginary * imaginary;
      a[photon] = 1.0f;
      c[photon] = d[photon] = whole > 0.0f ? (real * real - imaginary * imaginary) / whole : 1.0f;
      s[photon] = whole > 0.0f ? 2.0f * real * imaginary / whole : 0.0f;
    }
  }

  /// Of light a part of which is depolarised: `kept` is the other part, of each photon.
  Mueller diluted(const Spectral<N>& kept) const {
    return {kept * b, kept * a, kept * c, kept * d, kept * s, size};
  }
};

/// Of light that several parts of a kernel send on.
template <int N>
class MuellerSum {
 public:
  /// `value`: what unpolarised kernels say of this part.
  void add(const Spectral<N>& value, const Mueller<N>& part) {
    const Spectral<N> share = value * part.size;
    values_ += value;
    shares_ += share;
    sum_.b += share * part.b;
    sum_.a += share * part.a;
    sum_.c += share * part.c;
    sum_.d += share * part.d;
    sum_.s += share * part.s;
  }
  Mueller<N> mean() const {
    Mueller<N> found = sum_.diluted(over(1.0f, shares_));
    found.size = over(shares_, values_, 1.0f);
    return found;
  }

 private:
  static Spectral<N> over(const Spectral<N>& some, const Spectral<N>& all, float none = 0.0f) {
    return each([none](float a, float b) { return b > 0.0f ? a / b : none; }, some, all);
  }

  Mueller<N> sum_;
  Spectral<N> values_ = 0.0f, shares_ = 0.0f;
};

/// What the face of a dielectric mirrors.
template <int N>
Mueller<N> dielectric_mirror(float cosine, const Spectral<N>& ratio, std::uint32_t photons) {
  Mueller<N> found;
  for (std::size_t i = 0; i < N; ++i) {
    if (((photons >> i) & 1u) == 0u) continue;
    found.set_face(i, std::clamp(cosine, 0.0f, 1.0f), ratio[i], true);
  }
  return found;
}

/// A kernel that knows its effect on polarised light; others depolarise it. `photons`: bit i,
/// whether anybody asks of photon i.
template <class B, int N>
concept Polarises = requires(const B& b, Vec3 wo, Vec3 wi, std::uint32_t photons) {
  { b.mueller(wo, wi, photons) } -> std::same_as<Mueller<N>>;
};
/// One whose delta parts do something else than its smooth part does.
template <class B, int N>
concept PolarisesByPart = requires(const B& b, Vec3 wo, const Draw<N>& draw,
                                   std::uint32_t photons) {
  { b.mueller_of_delta(wo, draw, photons) } -> std::same_as<Mueller<N>>;
};

template <int N, class B>
Mueller<N> mueller_of(const B& kernel, Vec3 wo, const Draw<N>& draw, std::uint32_t photons) {
  if constexpr (PolarisesByPart<B, N>) {
    if (draw.delta) return kernel.mueller_of_delta(wo, draw, photons);
  }
  if constexpr (Polarises<B, N>) {
    return kernel.mueller(wo, draw.wi, photons);
  } else {
    return {};
  }
}

}  // namespace nocturne
