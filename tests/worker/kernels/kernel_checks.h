// What the tests of kernels share: random numbers, sums over a sampler's draws.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <optional>

#include "kernels/kernel.h"
#include "pdfs/directions.h"
#include "sampling/philox.h"
#include "sampling/sequence.h"

namespace nocturne::test {

/// Set `index` of the independent numbers named `seed`.
inline Uniform4 numbers(std::uint32_t index, std::uint32_t seed) {
  const auto words = philox4x32({index, 0, 0, 0}, {seed, 7u});
  return {to_unit(words[0]), to_unit(words[1]), to_unit(words[2]), to_unit(words[3])};
}

inline Spectral<4> lanes(float a, float b, float c, float d) {
  Spectral<4> r;
  r.lanes = Spectral<4>::Lanes{a, b, c, d};
  return r;
}

inline KernelNumbers kernel_numbers(const Uniform4& u) { return {u[0], u[1], u[2]}; }

/// At an angle to the normal, and an azimuth.
inline Vec3 direction(double degrees, double azimuth_degrees = 0.0) {
  const double t = degrees * std::numbers::pi / 180.0,
               p = azimuth_degrees * std::numbers::pi / 180.0;
  return {static_cast<float>(std::sin(t) * std::cos(p)),
          static_cast<float>(std::sin(t) * std::sin(p)), static_cast<float>(std::cos(t))};
}

struct Mean {
  double value, standard_error;
};

/// Of f(index) over 0 .. count - 1.
template <class F>
Mean mean_of(std::uint32_t count, const F& f) {
  double sum = 0.0, squares = 0.0;
  for (std::uint32_t i = 0; i < count; ++i) {
    const double x = f(i);
    sum += x;
    squares += x * x;
  }
  const double mean = sum / count;
  return {mean, std::sqrt(std::max(0.0, squares / count - mean * mean) / count)};
}

/// What photon `lane` carries after one draw: factor, or value over density; 0 without a draw.
template <class Bound>
double weight(const Bound& kernel, Vec3 wo, const KernelNumbers& u, std::size_t lane = 0) {
  const auto draw = kernel.sample(wo, u, lane);
  if (!draw) return 0.0;
  if (draw->delta) return static_cast<double>(draw->factor[lane]);
  const auto value = kernel.value(wo, draw->wi);
  const auto pdf = kernel.pdf(wo, draw->wi);
  return static_cast<double>(value[lane]) / static_cast<double>(pdf[lane]);
}

/// Directional albedo by the kernel's own draws.
template <class Bound>
Mean sampled_albedo(const Bound& kernel, Vec3 wo, std::uint32_t draws, std::uint32_t seed = 1) {
  return mean_of(
      draws, [&](std::uint32_t i) { return weight(kernel, wo, kernel_numbers(numbers(i, seed))); });
}

/// Reciprocity of a kernel's value over the cosine: the largest relative difference, of
/// values above 1e-3, over random pairs of directions of one hemisphere.
template <class Bound>
float largest_asymmetry(const Bound& kernel) {
  float largest = 0.0f;
  for (std::uint32_t i = 0; i < 2000; ++i) {
    const auto u = numbers(i, 31);
    const Vec3 a = UniformHemisphere::sample(u[0], u[1]), b = UniformHemisphere::sample(u[2], u[3]);
    const float f = kernel.value(a, b)[0] / b.z;
    largest = std::max(largest, std::abs(kernel.value(b, a)[0] / a.z - f) / std::max(1e-3f, f));
  }
  return largest;
}

}  // namespace nocturne::test
