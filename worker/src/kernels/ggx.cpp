#include "kernels/ggx.h"

#include "math/functions.h"

namespace nocturne {
namespace {

// ln Gamma for x >= 1: Stirling's series (Abramowitz and Stegun 6.1.41) after shifting x above 8;
// error below 1e-12. The C library's is not safe between threads.
double log_gamma(double x) {
  double product = 1.0;
  for (; x < 8.0; x += 1.0) product *= x;
  const double r = 1.0 / x, r2 = r * r;
  const double series =
      r *
      (1.0 / 12.0 - r2 * (1.0 / 360.0 - r2 * (1.0 / 1260.0 - r2 * (1.0 / 1680.0 - r2 / 1188.0))));
  constexpr double kHalfLogTwoPi = 0.91893853320467274178;
  return (x - 0.5) * math::log(x) - x + kHalfLogTwoPi + series - math::log(product);
}

}  // namespace

double beta_1p(double a, double b) {
  if (a == 0.0 || b == 0.0) return 1.0 / (1.0 + a + b);
  // Beyond, the logarithms cancel; B is below 1e-6 of its factors' scale there.
  constexpr double kLarge = 1e8;
  a = std::min(a, kLarge);
  b = std::min(b, kLarge);
  return math::exp(log_gamma(1.0 + a) + log_gamma(1.0 + b) - log_gamma(2.0 + a + b));
}

Vec3 half_vector(Vec3 a, Vec3 b, double scale) {
  const double x = static_cast<double>(a.x) + scale * static_cast<double>(b.x);
  const double y = static_cast<double>(a.y) + scale * static_cast<double>(b.y);
  const double z = static_cast<double>(a.z) + scale * static_cast<double>(b.z);
  const double length = std::sqrt(x * x + y * y + z * z);
  if (!(length > 0.0)) return {0.0f, 0.0f, 1.0f};
  const double inverse = (z < 0.0 ? -1.0 : 1.0) / length;
  return {static_cast<float>(inverse * x), static_cast<float>(inverse * y),
          static_cast<float>(inverse * z)};
}

}  // namespace nocturne
