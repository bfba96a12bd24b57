// What photons from the sensor know of polarisation: the Mueller matrix from where they are to the
// sensor, by which all light that they meet is counted. Luminaires are unpolarised: of the light
// that is met only the first column counts.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <utility>

#include "kernels/mueller.h"
#include "math/frame.h"

namespace nocturne {

/// From one direction across a ray to another; S1 and S2 turn by twice the angle.
struct StokesTurn {
  float twice_cosine, twice_sine;

  StokesTurn(Vec3 from, Vec3 to, Vec3 towards_sensor) {
    const float cosine = dot(from, to), sine = dot(cross(towards_sensor, from), to);
    const float size = cosine * cosine + sine * sine;
    twice_cosine = (cosine * cosine - sine * sine) / size;
    twice_sine = 2.0f * cosine * sine / size;
  }
  /// What the columns of S1 and S2 become.
  template <class T>
  T one(const T& one, const T& two) const {
    return twice_cosine * one + twice_sine * two;
  }
  template <class T>
  T two(const T& one, const T& two) const {
    return twice_cosine * two - twice_sine * one;
  }
};

/// What a photon that meets unpolarised light past an interaction finds.
template <int N>
struct MetLight {
  /// Of S0, besides what the kernel does to unpolarised light.
  Spectral<N> factor;
  /// S1, S2 and S3 at the sensor over S0.
  std::array<Spectral<N>, 3> stokes;
};

template <int N>
struct Polarisation {
  /// Over its first element, which is part of the photon's weight. Row i is Si at the sensor.
  std::array<std::array<Spectral<N>, 4>, 4> to_sensor = {};
  /// The direction that columns refer to, unit length, across the ray.
  Vec3 reference;
  /// Which of the batch's flights is the photon's.
  std::uint32_t flight = 0;
  /// Light was depolarised in between: all columns but the first are zero, in any direction.
  bool depolarised = false;

  /// At the sensor, with the direction that its S1 refers to.
  static Polarisation at_sensor(Vec3 reference, std::uint32_t flight) {
    Polarisation start;
    start.reference = reference;
    start.flight = flight;
    for (std::size_t i = 0; i < 4; ++i) start.to_sensor[i][i] = 1.0f;
    return start;
  }

  /// Refers to another direction across the ray; light comes along `towards_sensor`.
  void turn_to(Vec3 other, Vec3 towards_sensor) {
    if (!depolarised) {
      const StokesTurn turn(reference, other, towards_sensor);
      for (auto& row : to_sensor) {
        const Spectral<N> one = row[1], two = row[2];
        row[1] = turn.one(one, two);
        row[2] = turn.two(one, two);
      }
    }
    reference = other;
  }

  /// Past an interaction that leaves no light polarised.
  void depolarise() {
    for (auto& row : to_sensor) row[1] = row[2] = row[3] = 0.0f;
    depolarised = true;
  }

  /// Goes past an interaction, towards light; the factor of the photon's weight.
  Spectral<N> pass(const Mueller<N>& by) {
    if (depolarised) {
      for (auto& row : to_sensor) row[1] = by.b * row[0];
      depolarised = false;
      return by.size;
    }
    const auto [factor, inverse] = factor_of(by, to_sensor[0][1]);
    for (auto& row : to_sensor) {
      const auto [zero, one, two, three] = row;
      row[0] = inverse * (zero + by.b * one);
      row[1] = inverse * (by.b * zero + by.a * one);
      row[2] = inverse * (by.c * two + by.s * three);
      row[3] = inverse * (by.d * three - by.s * two);
    }
    return by.size * factor;
  }

  /// The same for unpolarised light that comes from there, by the first column alone; the
  /// interaction refers to the direction `other`.
  MetLight<N> meet(Vec3 other, Vec3 towards_sensor, const Mueller<N>& by) const {
    if (depolarised) return {by.size, first_column()};
    const StokesTurn turn(reference, other, towards_sensor);
    const auto [factor, inverse] = factor_of(by, turn.one(to_sensor[0][1], to_sensor[0][2]));
    MetLight<N> met{by.size * factor, {}};
    for (std::size_t i = 1; i < 4; ++i) {
      const auto& row = to_sensor[i];
      met.stokes[i - 1] = inverse * (row[0] + by.b * turn.one(row[1], row[2]));
    }
    return met;
  }
  std::array<Spectral<N>, 3> first_column() const {
    return {to_sensor[1][0], to_sensor[2][0], to_sensor[3][0]};
  }

 private:
  // By which S0 is more, and one over it.
  static std::pair<Spectral<N>, Spectral<N>> factor_of(const Mueller<N>& by,
                                                       const Spectral<N>& of_s1) {
    const Spectral<N> first = Spectral<N>(1.0f) + by.b * of_s1;
    const Spectral<N> factor = each([](float x) { return std::max(0.0f, x); }, first);
    return {factor, each([](float x) { return x > 0.0f ? 1.0f / x : 0.0f; }, factor)};
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
