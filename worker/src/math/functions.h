// The worker's elementary functions, so that images do not depend on the C library: its versions
// round differently, and it chooses its functions by the processor. IEEE 754 fixes +, -, *, / and
// the fused multiply-add of these to the last bit. For float all is computed in double.
//
// Series of Taylor after a reduction of the argument: W. J. Cody and W. Waite, Software Manual for
// the Elementary Functions, 1980. tests/worker/math/functions_test.cpp has the errors: at most 0.51
// units in the last place for float; for double three, for `pow` twice |b log a| more. Loops over
// lanes have no branches. A long file, as a list of functions that share their series.
#pragma once

#include <array>
#include <bit>
#include <cmath>
#include <concepts>
#include <cstdint>
#include <limits>
#include <numbers>

namespace nocturne::math {
namespace detail {

inline constexpr double kInfinity = std::numeric_limits<double>::infinity();
inline constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
/// ln 2 = high + low; products of `high` and whole numbers up to 2^21 are exact.
inline constexpr double kLn2High = 0x1.62e42p-1, kLn2Low = 0x1.fdf473de6af28p-22;
/// pi / 2 = high + low
inline constexpr double kHalfPiHigh = 0x1.921fb54442d18p+0, kHalfPiLow = 0x1.1a62633145c07p-54;
/// Adding it to a number below 2^51 rounds that to a whole one, which its lowest bits then are.
inline constexpr double kRounder = 0x1.8p52;

/// How many terms of a series the result's precision needs.
template <std::floating_point T>
constexpr std::size_t terms(std::size_t single, std::size_t twice) {
  return std::same_as<T, float> ? single : twice;
}

/// sum of c[i] x^i, even and odd powers interleaved
template <std::size_t N>
double polynomial(double x, const std::array<double, N>& c) {
  const double square = x * x;
  double even = 0.0, odd = 0.0;
  for (std::size_t i = N; i-- > 0;) {
    double& sum = i % 2 == 0 ? even : odd;
    sum = i + 2 < N ? std::fma(sum, square, c[i]) : c[i];
  }
  return std::fma(odd, x, even);
}

/// 1 / (first)!, 1 / (first + step)!, ...; every other one negative where `alternating`
template <std::size_t N>
constexpr std::array<double, N> inverse_factorials(int first, int step, bool alternating) {
  std::array<double, N> found{};
  double factorial = 1.0;
  int reached = 0;
  for (std::size_t i = 0; i < N; ++i) {
    for (const int end = first + step * static_cast<int>(i); reached < end;) factorial *= ++reached;
    found[i] = (alternating && i % 2 == 1 ? -1.0 : 1.0) / factorial;
  }
  return found;
}

/// 1 / first, 1 / (first + 2), ...; every other one negative where `alternating`
template <std::size_t N>
constexpr std::array<double, N> inverse_odd(int first, bool alternating) {
  std::array<double, N> found{};
  for (std::size_t i = 0; i < N; ++i) {
    found[i] = (alternating && i % 2 == 1 ? -1.0 : 1.0) / (first + 2 * static_cast<int>(i));
  }
  return found;
}

struct Whole {
  double value;
  std::int64_t integer;
};

/// The nearest whole number; |x| < 2^51. For NaN it gives NaN, and any integer.
inline Whole nearest(double x) {
  const double moved = x + kRounder;
  const auto low = static_cast<std::int32_t>(std::bit_cast<std::int64_t>(moved));
  return {moved - kRounder, low};
}

/// 2^k, -1022 <= k <= 1023
inline double power_of_two(std::int64_t k) { return std::bit_cast<double>((k + 1023) << 52); }

inline double clamped(double x, double low, double high) {
  // NaN stays.
  x = x < low ? low : x;
  return x > high ? high : x;
}

/// e^r - 1, |r| <= ln 2 / 2
template <std::floating_point T>
double expm1_near_zero(double r) {
  static constexpr auto kSeries = inverse_factorials<terms<T>(8, 12)>(2, 1, false);
  return std::fma(r * r, polynomial(r, kSeries), r);
}

/// x = k ln 2 + r
struct Reduced {
  std::int64_t k;
  double r;
};

inline Reduced by_ln2(double x) {
  const Whole k = nearest(x * std::numbers::log2e);
  return {k.integer, std::fma(-k.value, kLn2Low, x - k.value * kLn2High)};
}

/// 2^k times a mantissa, in two steps, as 2^k may be neither finite nor normal
inline double scaled(double mantissa, std::int64_t k) {
  const std::int64_t half = k / 2;
  return mantissa * power_of_two(half) * power_of_two(k - half);
}

template <std::floating_point T>
double exp_of(double x) {
  const Reduced to = by_ln2(clamped(x, -746.0, 710.0));
  return scaled(1.0 + expm1_near_zero<T>(to.r), to.k);
}

template <std::floating_point T>
double exp2_of(double x) {
  const double clear = clamped(x, -1076.0, 1025.0);
  const Whole k = nearest(clear);
  const double r = (clear - k.value) * std::numbers::ln2;
  return scaled(1.0 + expm1_near_zero<T>(r), k.integer);
}

template <std::floating_point T>
double expm1_of(double x) {
  // Where -1 alone is left, and where 1 does not matter.
  const Reduced to = by_ln2(clamped(x, -60.0, 700.0));
  const double less = expm1_near_zero<T>(to.r), power = power_of_two(to.k);
  const double found = std::fma(power, less, power - 1.0);
  return x > 700.0 ? exp_of<T>(x) : found;
}

/// log m = 2 atanh(s), s = f / (2 + f), f = m - 1, 1 / sqrt 2 <= m <= sqrt 2
template <std::floating_point T>
double log_of_near_one(double f) {
  static constexpr auto kSeries = inverse_odd<terms<T>(5, 10)>(3, false);
  const double s = f / (2.0 + f), square = s * s;
  // 2 s = f - f^2 / 2 + s f^2 / 2, of which f is exact.
  const double half_square = 0.5 * f * f;
  return f - (half_square - s * (half_square + 2.0 * square * polynomial(square, kSeries)));
}

/// x = 2^k m
struct Parts {
  double k;
  double m;
};

/// x > 0 and normal, 1 / sqrt 2 <= m <= sqrt 2
inline Parts parts_of(double x) {
  constexpr std::int64_t kLow = std::bit_cast<std::int64_t>(0.5 * std::numbers::sqrt2);
  const auto bits = std::bit_cast<std::int64_t>(x);
  const std::int64_t k = (bits - kLow) >> 52;
  // Whole numbers below 2^51 become doubles by the bits that round them.
  const double value = std::bit_cast<double>(k + std::bit_cast<std::int64_t>(kRounder)) - kRounder;
  return {value, std::bit_cast<double>(bits - (k << 52))};
}

/// x > 0, however small
inline Parts parts_of_any(double x) {
  const bool tiny = x < std::numeric_limits<double>::min();
  const Parts parts = parts_of(tiny ? x * 0x1p54 : x);
  return {tiny ? parts.k - 54.0 : parts.k, parts.m};
}

/// What logarithms are where there is none: -infinity at 0, infinity there, NaN below 0.
inline double log_beyond(double x, double found) {
  found = x < kInfinity ? found : x;
  found = x > 0.0 ? found : (x == 0.0 ? -kInfinity : kNan);
  return found;
}

template <std::floating_point T>
double log_of(double x) {
  const Parts parts = parts_of_any(x);
  return log_beyond(
      x, std::fma(parts.k, kLn2Low, log_of_near_one<T>(parts.m - 1.0)) + parts.k * kLn2High);
}

template <std::floating_point T>
double log2_of(double x) {
  const Parts parts = parts_of_any(x);
  return log_beyond(x, std::fma(log_of_near_one<T>(parts.m - 1.0), std::numbers::log2e, parts.k));
}

template <std::floating_point T>
double log1p_of(double x) {
  const double sum = 1.0 + x;
  const Parts parts = parts_of(sum);
  // What rounding the sum lost counts where it is all there is, and as a part of the rest.
  const double lost = (x - (sum - 1.0)) / sum;
  const double far =
      std::fma(parts.k, kLn2Low, log_of_near_one<T>(parts.m - 1.0) + lost) + parts.k * kLn2High;
  return log_beyond(sum, parts.k == 0.0 ? log_of_near_one<T>(x) : far);
}

template <std::floating_point T>
double pow_of(double a, double b) {
  return b == 0.0 ? 1.0 : exp_of<T>(b * log_of<double>(a));
}

template <std::floating_point T>
double sinh_of(double x) {
  const double e = expm1_of<T>(std::fabs(x));
  return std::copysign(e < kInfinity ? 0.5 * (e + e / (e + 1.0)) : e, x);
}

template <std::floating_point T>
double asinh_of(double x) {
  const double a = std::fabs(x);
  const double near = log1p_of<T>(a + a * a / (1.0 + std::sqrt(std::fma(a, a, 1.0))));
  return std::copysign(a < 0x1p500 ? near : log_of<T>(a) + std::numbers::ln2, x);
}

template <std::floating_point T>
double cbrt_of(double x) {
  const double a = std::fabs(x);
  if (!(a > 0.0 && a < kInfinity)) return x;
  const double y = exp_of<T>(log_of<T>(a) / 3.0);
  // A step of Newton's.
  return std::copysign(y - std::fma(y * y, y, -a) / (3.0 * y * y), x);
}

struct Turned {
  double sin, cos;
};

/// |x| <= 1e6 radians
template <std::floating_point T>
Turned turned(double x) {
  static constexpr auto kSine = inverse_factorials<terms<T>(5, 8)>(3, 2, true);
  static constexpr auto kCosine = inverse_factorials<terms<T>(6, 8)>(2, 2, true);
  const Whole quarters = nearest(x * (2.0 * std::numbers::inv_pi));
  const double r = std::fma(-quarters.value, kHalfPiLow, std::fma(-quarters.value, kHalfPiHigh, x));
  const double square = r * r, s = std::fma(-r * square, polynomial(square, kSine), r),
               c = std::fma(-square, polynomial(square, kCosine), 1.0);
  const bool odd = (quarters.integer & 1) != 0;
  const double sine = odd ? c : s, cosine = odd ? s : c;
  return {(quarters.integer & 2) != 0 ? -sine : sine,
          ((quarters.integer + 1) & 2) != 0 ? -cosine : cosine};
}

/// 0 <= t <= 1
template <std::floating_point T>
double atan_of(double t) {
  static constexpr auto kSeries = inverse_odd<terms<T>(4, 7)>(1, true);
  // atan(i / 8)
  static constexpr std::array kEighths = {
      0x0.0p+0,
      0x1.fd5ba9aac2f6ep-4,
      0x1.f5b75f92c80ddp-3,
      0x1.6f61941e4def1p-2,
      0x1.dac670561bb4fp-2,
      0x1.1e00babdefeb4p-1,
      0x1.4978fa3269ee1p-1,
      0x1.700a7c5784634p-1,
      0x1.921fb54442d18p-1,
  };
  const Whole eighths = nearest(8.0 * t);
  const double near = 0.125 * eighths.value, rest = (t - near) / std::fma(t, near, 1.0);
  return std::fma(rest, polynomial(rest * rest, kSeries),
                  kEighths[static_cast<std::size_t>(eighths.integer & 15)]);
}

template <std::floating_point T>
double atan2_of(double y, double x) {
  const double a = std::fabs(y), b = std::fabs(x), low = a < b ? a : b, high = a < b ? b : a;
  if (!(high < kInfinity)) {
    if (y != y || x != x) return kNan;
    const double wide = b < kInfinity ? 0.5 : (std::signbit(x) ? 1.0 : 0.0);
    const double both = std::signbit(x) ? 0.75 : 0.25;
    return std::copysign(std::numbers::pi * (a < kInfinity || b < kInfinity ? wide : both), y);
  }
  const double angle = atan_of<T>(high > 0.0 ? low / high : 0.0);
  const bool steep = a > b, behind = std::signbit(x);
  // From the axis that is nearest.
  const double quarters = steep ? 1.0 : (behind ? 2.0 : 0.0),
               turn = steep == behind ? angle : -angle;
  return std::copysign(quarters * kHalfPiHigh + std::fma(quarters, kHalfPiLow, turn), y);
}

}  // namespace detail

/// e^x
template <std::floating_point T>
T exp(T x) {
  return static_cast<T>(detail::exp_of<T>(x));
}

/// 2^x
template <std::floating_point T>
T exp2(T x) {
  return static_cast<T>(detail::exp2_of<T>(x));
}

/// e^x - 1
template <std::floating_point T>
T expm1(T x) {
  return static_cast<T>(detail::expm1_of<T>(x));
}

/// The natural logarithm; -infinity at 0, NaN below.
template <std::floating_point T>
T log(T x) {
  return static_cast<T>(detail::log_of<T>(x));
}

/// The logarithm to base 2, exact for powers of 2.
template <std::floating_point T>
T log2(T x) {
  return static_cast<T>(detail::log2_of<T>(x));
}

/// log(1 + x)
template <std::floating_point T>
T log1p(T x) {
  return static_cast<T>(detail::log1p_of<T>(x));
}

/// a^b, a >= 0; NaN below.
template <std::floating_point T>
T pow(T a, T b) {
  return static_cast<T>(detail::pow_of<T>(a, b));
}

template <std::floating_point T>
T sinh(T x) {
  return static_cast<T>(detail::sinh_of<T>(x));
}

template <std::floating_point T>
T asinh(T x) {
  return static_cast<T>(detail::asinh_of<T>(x));
}

/// The cube root.
template <std::floating_point T>
T cbrt(T x) {
  return static_cast<T>(detail::cbrt_of<T>(x));
}

/// Of an angle in radians, |x| <= 1e6.
template <std::floating_point T>
T sin(T x) {
  return static_cast<T>(detail::turned<T>(x).sin);
}

/// Of an angle in radians, |x| <= 1e6.
template <std::floating_point T>
T cos(T x) {
  return static_cast<T>(detail::turned<T>(x).cos);
}

/// Of an angle in radians, |x| <= 1e6.
template <std::floating_point T>
T tan(T x) {
  const detail::Turned found = detail::turned<T>(x);
  return static_cast<T>(found.sin / found.cos);
}

/// The angle of (x, y), radians in [-pi, pi]; 0 or pi at the origin.
template <std::floating_point T>
T atan2(T y, T x) {
  return static_cast<T>(detail::atan2_of<T>(y, x));
}

/// Radians in [0, pi], -1 <= x <= 1; NaN elsewhere.
template <std::floating_point T>
T acos(T x) {
  const double c = x;
  return static_cast<T>(2.0 * detail::atan2_of<T>(std::sqrt(1.0 - c), std::sqrt(1.0 + c)));
}

/// sqrt(x^2 + y^2); of squares that fit into double.
template <std::floating_point T>
T hypot(T x, T y) {
  const double a = x, b = y;
  return static_cast<T>(std::sqrt(a * a + b * b));
}

/// sqrt(x^2 + y^2 + z^2); of squares that fit into double.
template <std::floating_point T>
T hypot(T x, T y, T z) {
  const double a = x, b = y, c = z;
  return static_cast<T>(std::sqrt(a * a + b * b + c * c));
}

/// The complementary error function, to 1e-12 of its value.
double erfc(double x);

/// The inverse of the error function for x in (-1, 1): to 4e-7 of its value where |x| < 1 - 1e-7,
/// to a tenth beyond.
double erf_inverse(double x);

}  // namespace nocturne::math
