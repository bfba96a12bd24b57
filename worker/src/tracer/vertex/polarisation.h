// What photons from the sensor know of polarisation: the Mueller matrix from where they are to the
// sensor, by which all light that they meet is counted. Luminaires are unpolarised: of the light
// that is met only the first column counts.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>

#include "kernels/mueller.h"
#include "math/frame.h"

namespace nocturne {

template <int N>
struct Polarisation {
  /// Over its first element, which is part of the photon's weight. Row i is Si at the sensor.
  std::array<std::array<Spectral<N>, 4>, 4> to_sensor = {};
  /// The direction that columns refer to, unit length, across the ray.
  Vec3 reference;
  /// Which of the batch's flights is the photon's.
  std::uint32_t flight = 0;

  /// At the sensor, with the direction that its S1 refers to.
  static Polarisation at_sensor(Vec3 reference, std::uint32_t flight) {
    Polarisation start{.to_sensor = {}, .reference = reference, .flight = flight};
    for (std::size_t i = 0; i < 4; ++i) start.to_sensor[i][i] = 1.0f;
    return start;
  }

  /// Refers to another direction across the ray; light comes along `towards_sensor`.
  void turn_to(Vec3 other, Vec3 towards_sensor) {
    const float cosine = dot(reference, other);
    const float sine = dot(cross(towards_sensor, reference), other);
    const float size = cosine * cosine + sine * sine;
    const float twice_cosine = (cosine * cosine - sine * sine) / size;
    const float twice_sine = 2.0f * cosine * sine / size;
    for (auto& row : to_sensor) {
      const Spectral<N> one = row[1], two = row[2];
      row[1] = twice_cosine * one + twice_sine * two;
      row[2] = twice_cosine * two - twice_sine * one;
    }
    reference = other;
  }

  /// Goes past an interaction, towards light; the factor of the photon's weight.
  Spectral<N> pass(const Mueller<N>& by) {
    const Spectral<N> first = Spectral<N>(1.0f) + by.b * to_sensor[0][1];
    const Spectral<N> factor = each([](float x) { return std::max(0.0f, x); }, first);
    const Spectral<N> inverse = each([](float x) { return x > 0.0f ? 1.0f / x : 0.0f; }, factor);
    for (auto& row : to_sensor) {
      const auto [zero, one, two, three] = row;
      row[0] = inverse * (zero + by.b * one);
      row[1] = inverse * (by.b * zero + by.a * one);
      row[2] = inverse * (by.c * two + by.s * three);
      row[3] = inverse * (by.d * three - by.s * two);
    }
    return by.size * factor;
  }
};

inline bool along_each_other(Vec3 one, Vec3 other) {
  constexpr float kAlong = 1e-12f;  // square of an angle
  const Vec3 normal = cross(one, other);
  return dot(normal, normal) <= kAlong;
}

/// Across two directions; where they are along each other any one across.
inline Vec3 across_both(Vec3 one, Vec3 other) {
  return along_each_other(one, other) ? Frame(other).tangent : normalized(cross(one, other));
}

/// The part of an axis that is across a ray.
inline Vec3 across_ray(Vec3 axis, Vec3 direction) {
  const Vec3 part = axis - dot(axis, direction) * direction;
  return dot(part, part) > 1e-12f ? normalized(part) : Frame(direction).tangent;
}

}  // namespace nocturne
