// A number for each photon of a group: photons that travel together, each of one wavelength. All
// operations are lane by lane; N is 1, 4 or 8, so that a group is one register.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>

namespace nocturne {

// The compiler wants the size of a vector as a plain number.
template <int N>
struct LanesOf;
template <>
struct LanesOf<1> {
  using type [[gnu::vector_size(4)]] = float;
  using integers [[gnu::vector_size(4)]] = std::int32_t;
};
template <>
struct LanesOf<4> {
  using type [[gnu::vector_size(16)]] = float;
  using integers [[gnu::vector_size(16)]] = std::int32_t;
};
template <>
struct LanesOf<8> {
  using type [[gnu::vector_size(32)]] = float;
  using integers [[gnu::vector_size(32)]] = std::int32_t;
};

template <int N>
struct alignas(sizeof(float) * N) Spectral {
  /// One register.
  using Lanes = typename LanesOf<N>::type;
  using Integers = typename LanesOf<N>::integers;

  Lanes lanes;

  Spectral() = default;
  // Not explicit: a number is the same number for every photon.
  Spectral(float all) : lanes(all - Lanes{}) {}  // NOLINT(google-explicit-constructor)
  explicit Spectral(Lanes all) : lanes(all) {}

  // A vector may be looked at as its elements (GCC, "Vector Extensions").
  float& operator[](std::size_t i) { return reinterpret_cast<float*>(&lanes)[i]; }
  float operator[](std::size_t i) const { return lanes[i]; }
};

/// f(lane of a, lane of b, ...) for every lane.
template <int N, class F, class... Rest>
Spectral<N> each(const F& f, const Spectral<N>& a, const Rest&... rest) {
  Spectral<N> r;
  for (std::size_t i = 0; i < N; ++i) r[i] = f(a[i], rest[i]...);
  return r;
}

/// The same, once for neighbours that are equal: where f is dear, and most spectra are flat.
template <int N, class F>
Spectral<N> each_distinct(const F& f, const Spectral<N>& a) {
  Spectral<N> r;
  for (std::size_t i = 0; i < N; ++i) r[i] = i > 0 && a[i] == a[i - 1] ? r[i - 1] : f(a[i]);
  return r;
}

template <int N>
Spectral<N> operator+(const Spectral<N>& a, const Spectral<N>& b) {
  return Spectral<N>(a.lanes + b.lanes);
}
template <int N>
Spectral<N> operator-(const Spectral<N>& a, const Spectral<N>& b) {
  return Spectral<N>(a.lanes - b.lanes);
}
template <int N>
Spectral<N> operator*(const Spectral<N>& a, const Spectral<N>& b) {
  return Spectral<N>(a.lanes * b.lanes);
}
template <int N>
Spectral<N> operator/(const Spectral<N>& a, const Spectral<N>& b) {
  return Spectral<N>(a.lanes / b.lanes);
}
template <int N>
Spectral<N> operator+(const Spectral<N>& a, float b) {
  return Spectral<N>(a.lanes + b);
}
template <int N>
Spectral<N> operator*(float a, const Spectral<N>& b) {
  return Spectral<N>(a * b.lanes);
}
template <int N>
Spectral<N> operator/(const Spectral<N>& a, float b) {
  return (1.0f / b) * a;
}
template <int N>
Spectral<N>& operator+=(Spectral<N>& a, const Spectral<N>& b) {
  return a = a + b;
}
template <int N>
Spectral<N>& operator*=(Spectral<N>& a, const Spectral<N>& b) {
  return a = a * b;
}

template <int N>
Spectral<N> sqrt(const Spectral<N>& a) {
  return each([](float x) { return std::sqrt(x); }, a);
}
template <int N>
float largest(const Spectral<N>& a) {
  float r = a[0];
  for (std::size_t i = 1; i < N; ++i) r = std::max(r, a[i]);
  return r;
}
template <int N>
float sum(const Spectral<N>& a) {
  float r = a[0];
  for (std::size_t i = 1; i < N; ++i) r += a[i];
  return r;
}

}  // namespace nocturne
