#include <algorithm>

#include "math/functions.h"

namespace nocturne::math {
namespace {

// log(erfc(x) e^(x^2) / t) for x >= 0, t = 2 / (2 + x), as Chebyshev polynomials of 2 t - 1: fitted
// to scipy's erfcx at 200 nodes, with an error of 1e-13.
constexpr std::array kSeries = {
    -0.6513268598908547,     0.64196979235649032,     0.019476473204185663,
    -0.0095615147868087901,  -0.00094659534448216323, 0.00036683949785283403,
    4.2523324807000597e-05,  -2.0278578112542197e-05, -1.6242900047365343e-06,
    1.3036558357115194e-06,  1.5626441835247399e-08,  -8.5238095922398801e-08,
    6.5290543772251527e-09,  5.0593433300647597e-09,  -9.9136400809865283e-10,
    -2.2736530029649132e-10, 9.6467967214191324e-11,  2.3938406812362708e-12,
    -6.8860472879350733e-12, 8.9436513750484956e-13,  3.1326052862823441e-13};

}  // namespace

double erfc(double x) {
  const double a = std::fabs(x), t = 2.0 / (2.0 + a), twice = 2.0 * (2.0 * t - 1.0);
  // Clenshaw's recurrence.
  double here = 0.0, before = 0.0;
  for (std::size_t i = kSeries.size() - 1; i > 0; --i) {
    const double next = twice * here - before + kSeries[i];
    before = here;
    here = next;
  }
  const double power = 0.5 * twice * here - before + kSeries[0];
  const double positive = t * exp(power - a * a);
  return x < 0.0 ? 2.0 - positive : positive;
}

}  // namespace nocturne::math
