// Fresnel's equations for unpolarised light: the share that a plane boundary reflects. Born and
// Wolf, Principles of Optics, 7th ed., section 1.5 (dielectrics) and 14.2 (metals).
#pragma once

#include <array>
#include <cmath>
#include <cstddef>

namespace nocturne {

/// `cos_from` in [0, 1]: of the angle to the normal; `ratio` > 0: index beyond over index here.
///
/// With g = ratio x cos of the refracted angle, g^2 = ratio^2 - 1 + cos^2, the amplitudes are
/// (cos - g) / (cos + g) and (ratio^2 cos - g) / (ratio^2 cos + g). Both numerators cancel for
/// ratios near 1, so they are multiplied out: the result has ratio^2 - 1 as a factor.
template <class T>
T fresnel_dielectric(T cos_from, T ratio) {
  if (ratio == T(1)) return T(0);
  const T contrast = (ratio - T(1)) * (ratio + T(1));
  const T g2 = contrast + cos_from * cos_from;
  if (g2 <= T(0)) return T(1);  // total reflection
  const T g = std::sqrt(g2), ratio2 = ratio * ratio;
  const T a = cos_from + g, b = ratio2 * cos_from + g;
  const T s = contrast / (a * a);
  const T p = contrast * ((ratio2 + T(1)) * cos_from * cos_from - T(1)) / (b * b);
  return T(0.5) * (s * s + p * p);
}

/// n + i k over the index on the side of the light; n, k >= 0.
template <class T>
T fresnel_conductor(T cos_from, T n, T k) {
  const T c2 = cos_from * cos_from, s2 = (T(1) - cos_from) * (T(1) + cos_from);
  // a + i b = sqrt((n + i k)^2 - sin^2)
  const T real = n * n - k * k - s2, imaginary = T(2) * n * k;
  const T square = std::sqrt(real * real + imaginary * imaginary);  // a^2 + b^2
  if (!(square > T(0))) return T(1);
  // The half angle's formula that doesn't cancel.
  const T larger = std::sqrt(T(0.5) * (square + std::fabs(real)));
  const T a = real >= T(0) ? larger : T(0.5) * imaginary / larger;
  const T s = (square + c2 - T(2) * a * cos_from) / (square + c2 + T(2) * a * cos_from);
  const T x = square * c2 + s2 * s2, y = T(2) * a * cos_from * s2;
  return T(0.5) * s * (T(1) + (x - y) / (x + y));
}

/// Reflectance of a dielectric boundary for light that comes evenly from all directions (equal
/// radiance), from the side where `ratio` is index beyond over index here. Duntley's closed form as
/// in Stern, Applied Optics 3(1), 1964; seen from the denser side 1 - (1 - R) / n^2.
double hemispherical_reflectance(double ratio);

/// The same to within 1e-6, from a table: what kernels ask at every vertex.
class HemisphericalReflectance {
 public:
  /// Made at the first call; call it once while loading.
  static const HemisphericalReflectance& instance();

  float operator()(float ratio) const;

 private:
  // Of n = 1 + t^2 at equally spaced t: the reflectance rises steeply at n = 1.
  static constexpr std::size_t kCells = 2048;
  static constexpr float kMaxRatio = 5.0f, kCellsPerT = static_cast<float>(kCells) / 2.0f;

  HemisphericalReflectance();
  float from_thinner_side(float n) const;

  std::array<float, kCells + 1> values_;
};

}  // namespace nocturne
