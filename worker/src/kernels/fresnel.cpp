#include "kernels/fresnel.h"

#include <algorithm>

namespace nocturne {
namespace {

// From the thinner side, n > 1. Terms cancel near 1: the error is the type's, over (n - 1)^2.
template <class T>
double closed_form(double index) {
  const T n = index, n2 = n * n, n4 = n2 * n2, sum = n2 + 1, difference = (n - 1) * (n + 1) * sum;
  const T r = T(0.5) + (n - 1) * (3 * n + 1) / (6 * (n + 1) * (n + 1)) +
              n2 * (n2 - 1) * (n2 - 1) / (sum * sum * sum) * std::log((n - 1) / (n + 1)) -
              2 * n * n2 * (n2 + 2 * n - 1) / (sum * difference) +
              8 * n4 * (n4 + 1) / (sum * difference * difference) * std::log(n);
  return std::clamp(static_cast<double>(r), 0.0, 1.0);
}

double from_thinner_side(double n) {
  if (n > 1.01) return closed_form<double>(n);
  if (n > 1.00002) return closed_form<long double>(n);
  // The first term of the series; the next is below 1e-8.
  return (n - 1.0) / 3.0;
}

}  // namespace

double hemispherical_reflectance(double ratio) {
  if (ratio == 1.0) return 0.0;
  if (ratio > 1.0) return from_thinner_side(ratio);
  // 1 - (1 - R) / n^2, n = 1 / ratio
  return (1.0 - ratio) * (1.0 + ratio) + from_thinner_side(1.0 / ratio) * ratio * ratio;
}

}  // namespace nocturne
