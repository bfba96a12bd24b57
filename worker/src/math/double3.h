// Three-component vectors and 3 x 3 matrices in double precision, for what single precision would
// spoil: points that are carried between coordinate systems.
#pragma once

#include <array>
#include <cmath>

#include "math/vec3.h"

namespace nocturne {

struct Double3 {
  double x = 0, y = 0, z = 0;

  Double3() = default;
  Double3(double a, double b, double c) : x(a), y(b), z(c) {}
  // Not explicit: exact.
  Double3(Vec3 v) : x(v.x), y(v.y), z(v.z) {}  // NOLINT(google-explicit-constructor)

  Vec3 rounded() const {
    return {static_cast<float>(x), static_cast<float>(y), static_cast<float>(z)};
  }
  Double3 normalized() const {
    const double s = 1.0 / std::sqrt(x * x + y * y + z * z);
    return {s * x, s * y, s * z};
  }
};

inline Double3 operator+(Double3 a, Double3 b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
inline Double3 operator-(Double3 a, Double3 b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
inline Double3 operator*(double s, Double3 a) { return {s * a.x, s * a.y, s * a.z}; }
inline double dot(Double3 a, Double3 b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
inline Double3 cross(Double3 a, Double3 b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
inline double length(Double3 a) { return std::sqrt(dot(a, a)); }
inline double max_abs(Double3 a) {
  return std::fmax(std::fabs(a.x), std::fmax(std::fabs(a.y), std::fabs(a.z)));
}

/// By rows.
struct Matrix3 {
  Double3 x{1, 0, 0}, y{0, 1, 0}, z{0, 0, 1};

  double determinant() const { return dot(x, cross(y, z)); }
  Matrix3 transposed() const { return {{x.x, y.x, z.x}, {x.y, y.y, z.y}, {x.z, y.z, z.z}}; }
  /// Not finite where there is none.
  Matrix3 inverse() const {
    const double s = 1.0 / determinant();
    return Matrix3{s * cross(y, z), s * cross(z, x), s * cross(x, y)}.transposed();
  }
};

inline Double3 operator*(const Matrix3& m, Double3 v) {
  return {dot(m.x, v), dot(m.y, v), dot(m.z, v)};
}
/// The transposed matrix times v.
inline Double3 transposed_times(const Matrix3& m, Double3 v) {
  return v.x * m.x + v.y * m.y + v.z * m.z;
}

}  // namespace nocturne
