#include "math/functions.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <string>

namespace nocturne::math {
namespace {

constexpr int kArguments = 50'000;
constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// Multiples of the golden ratio, modulo 1: spread evenly, with all bits in use.
double spread(int i) {
  const double turns = (i + 1) * 0.6180339887498949;
  return turns - std::floor(turns);
}

/// Units in the last place of the true value, in the precision of `found`.
template <typename T>
double units_off(T found, long double truth) {
  const T near = std::fabs(static_cast<T>(truth));
  if (std::isinf(found) && found == static_cast<T>(truth)) return 0.0;
  const T unit = std::max(std::nextafter(near, std::numeric_limits<T>::infinity()) - near,
                          std::numeric_limits<T>::denorm_min());
  return static_cast<double>(std::fabs(static_cast<long double>(found) - truth) / unit);
}

/// Beside the C library's functions of 80 bits, over [low, high).
template <typename T, typename Ours, typename Truth>
double worst(double low, double high, Ours ours, Truth truth) {
  double found = 0.0;
  for (int i = 0; i < kArguments; ++i) {
    const T x = static_cast<T>(low + (high - low) * spread(i));
    const double off = units_off(ours(x), truth(static_cast<long double>(x)));
    EXPECT_EQ(off, off) << x;
    found = std::max(found, off);
  }
  return found;
}

template <typename Ours, typename Truth>
void expect_close(const std::string& name, double low, double high, Ours ours, Truth truth,
                  double units = 2.0) {
  EXPECT_LE((worst<float>(low, high, ours, truth)), 0.51) << name;
  EXPECT_LE((worst<double>(low, high, ours, truth)), units) << name;
}

TEST(Functions, AreWithinUnitsOfTheLastPlace) {
  using L = long double;
  expect_close(
      "exp", -87.0, 88.0, [](auto x) { return exp(x); }, [](L x) { return std::exp(x); });
  expect_close(
      "exp near 0", -1e-3, 1e-3, [](auto x) { return exp(x); }, [](L x) { return std::exp(x); });
  expect_close(
      "exp2", -125.0, 127.0, [](auto x) { return exp2(x); }, [](L x) { return std::exp2(x); });
  expect_close(
      "expm1", -30.0, 80.0, [](auto x) { return expm1(x); }, [](L x) { return std::expm1(x); });
  expect_close(
      "expm1 near 0", -1e-4, 1e-4, [](auto x) { return expm1(x); },
      [](L x) { return std::expm1(x); });
  expect_close(
      "log", 1e-6, 100.0, [](auto x) { return log(x); }, [](L x) { return std::log(x); });
  expect_close(
      "log near 1", 0.99, 1.01, [](auto x) { return log(x); }, [](L x) { return std::log(x); });
  expect_close(
      "log2", 1e-6, 100.0, [](auto x) { return log2(x); }, [](L x) { return std::log2(x); }, 3.0);
  expect_close(
      "log1p", -0.999, 50.0, [](auto x) { return log1p(x); }, [](L x) { return std::log1p(x); });
  expect_close(
      "log1p near 0", -1e-4, 1e-4, [](auto x) { return log1p(x); },
      [](L x) { return std::log1p(x); });
  expect_close(
      "sinh", -20.0, 20.0, [](auto x) { return sinh(x); }, [](L x) { return std::sinh(x); }, 3.0);
  expect_close(
      "asinh", -1e3, 1e3, [](auto x) { return asinh(x); }, [](L x) { return std::asinh(x); }, 3.0);
  expect_close(
      "cbrt", -1e3, 1e3, [](auto x) { return cbrt(x); }, [](L x) { return std::cbrt(x); });
  expect_close(
      "sin", -7.0, 7.0, [](auto x) { return sin(x); }, [](L x) { return std::sin(x); });
  expect_close(
      "cos", -7.0, 7.0, [](auto x) { return cos(x); }, [](L x) { return std::cos(x); });
  expect_close(
      "tan", -1.5, 1.5, [](auto x) { return tan(x); }, [](L x) { return std::tan(x); }, 3.0);
  expect_close(
      "acos", -1.0, 1.0, [](auto x) { return acos(x); }, [](L x) { return std::acos(x); }, 3.0);
}

TEST(Functions, OfTwoNumbers) {
  for (int i = 0; i < kArguments; ++i) {
    const double x = 40.0 * spread(i) - 20.0, y = 4.0 * spread(7 * i) - 2.0,
                 a = 20.0 * spread(3 * i);
    const auto fx = static_cast<float>(x), fy = static_cast<float>(y), fa = static_cast<float>(a);
    using L = long double;
    ASSERT_LE(units_off(atan2(y, x), std::atan2(L(y), L(x))), 3.0) << y << ", " << x;
    ASSERT_LE(units_off(atan2(fy, fx), std::atan2(L(fy), L(fx))), 0.51) << fy << ", " << fx;
    ASSERT_LE(units_off(pow(fa, fy), std::pow(L(fa), L(fy))), 0.51) << fa << ", " << fy;
    ASSERT_LE(units_off(pow(a, x), std::pow(L(a), L(x))), 3.0 + 2.0 * std::fabs(x * std::log(a)))
        << a << ", " << x;
    ASSERT_LE(units_off(hypot(x, y), std::hypot(L(x), L(y))), 1.5) << x << ", " << y;
    ASSERT_LE(units_off(hypot(fx, fy, fa), std::hypot(L(fx), L(fy), L(fa))), 0.51);
  }
}

TEST(Functions, TheComplementaryErrorFunction) {
  for (int i = 0; i < kArguments; ++i) {
    const double x = 30.0 * spread(i) - 5.0;
    const long double truth = std::erfc(static_cast<long double>(x));
    if (truth < 1e-300L) continue;
    ASSERT_LE(std::fabs(erfc(x) - truth), 2e-12L * truth) << x;
  }
}

TEST(Functions, TheInverseOfTheErrorFunction) {
  for (int i = 0; i < kArguments; ++i) {
    const double y = 2.0 * spread(i) - 1.0;
    if (std::fabs(y) > 1.0 - 1e-7) continue;
    const double x = erf_inverse(y);
    // How far off x is, by the slope of the error function.
    const double off = (std::erf(x) - y) * 0.5 * std::sqrt(std::numbers::pi) * std::exp(x * x);
    ASSERT_LE(std::fabs(off), 4e-7 * std::fabs(x)) << y;
  }
  EXPECT_EQ(erf_inverse(0.0), 0.0);
  EXPECT_NEAR(erf_inverse(1.0 - 1e-12), 5.0420297, 0.1);
}

TEST(Functions, LargeAngles) {
  for (int i = 0; i < kArguments; ++i) {
    const double x = 2e6 * spread(i) - 1e6;
    ASSERT_NEAR(sin(x), static_cast<double>(std::sin(static_cast<long double>(x))), 3e-16) << x;
    ASSERT_NEAR(cos(x), static_cast<double>(std::cos(static_cast<long double>(x))), 3e-16) << x;
  }
}

TEST(Functions, WhereNumbersEnd) {
  EXPECT_EQ(exp(-kInfinity), 0.0);
  EXPECT_EQ(exp(kInfinity), kInfinity);
  EXPECT_EQ(exp(-800.0), 0.0);
  EXPECT_EQ(exp(800.0), kInfinity);
  EXPECT_EQ(exp(0.0), 1.0);
  EXPECT_EQ(exp(89.0f), std::numeric_limits<float>::infinity());
  EXPECT_LE(units_off(exp(-740.0), std::exp(-740.0L)), 1.0);
  EXPECT_LE(units_off(exp(-100.0f), std::exp(-100.0L)), 1.0);
  EXPECT_EQ(exp2(1024.0), kInfinity);
  EXPECT_EQ(exp2(-3.0), 0.125);
  EXPECT_EQ(expm1(-kInfinity), -1.0);
  EXPECT_EQ(expm1(kInfinity), kInfinity);
  EXPECT_LE(units_off(expm1(705.0), std::expm1(705.0L)), 2.0);
  EXPECT_EQ(log(0.0), -kInfinity);
  EXPECT_EQ(log(kInfinity), kInfinity);
  EXPECT_EQ(log(1.0), 0.0);
  EXPECT_LE(units_off(log(5e-324), std::log(static_cast<long double>(5e-324))), 2.0);
  EXPECT_EQ(log2(0x1p-1074), -1074.0);
  EXPECT_EQ(log2(8.0f), 3.0f);
  EXPECT_EQ(log1p(-1.0), -kInfinity);
  EXPECT_EQ(log1p(0.0), 0.0);
  EXPECT_EQ(log1p(kInfinity), kInfinity);
  EXPECT_EQ(pow(0.0, 0.0), 1.0);
  EXPECT_EQ(pow(0.0, 2.0), 0.0);
  EXPECT_EQ(pow(0.0, -2.0), kInfinity);
  EXPECT_EQ(pow(1.0f, 5.0f), 1.0f);
  EXPECT_EQ(cbrt(0.0), 0.0);
  EXPECT_EQ(cbrt(-kInfinity), -kInfinity);
  EXPECT_EQ(sinh(kInfinity), kInfinity);
  EXPECT_EQ(asinh(-kInfinity), -kInfinity);
  EXPECT_EQ(acos(1.0), 0.0);
  EXPECT_EQ(acos(-1.0f), static_cast<float>(std::numbers::pi));
  EXPECT_EQ(erfc(kInfinity), 0.0);
  EXPECT_EQ(erfc(-kInfinity), 2.0);
  for (const double y : {0.0, -0.0, 1.0, -1.0, kInfinity, -kInfinity}) {
    for (const double x : {0.0, -0.0, 1.0, -1.0, kInfinity, -kInfinity}) {
      EXPECT_EQ(atan2(y, x), std::atan2(y, x)) << y << ", " << x;
    }
  }
}

TEST(Functions, OfWhatIsNoNumber) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  for (const double found :
       {exp(nan),        exp2(nan),     expm1(nan), log(nan),    log2(nan),       log1p(nan),
        pow(nan, 2.0),   pow(2.0, nan), sinh(nan),  asinh(nan),  cbrt(nan),       sin(nan),
        cos(nan),        tan(nan),      acos(nan),  acos(1.5),   atan2(nan, 1.0), atan2(1.0, nan),
        hypot(nan, 1.0), erfc(nan),     log(-1.0),  log1p(-2.0), pow(-1.0, 0.5),  sin(kInfinity)}) {
    EXPECT_NE(found, found);
  }
}

}  // namespace
}  // namespace nocturne::math
