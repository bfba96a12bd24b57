// A number for each photon of a group: photons that travel together, each of one wavelength. All
// operations are lane by lane; N is 1, 4 or 8, so that a group is one register.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

namespace nocturne {

template <int N>
struct alignas(sizeof(float) * N) Spectral {
  std::array<float, N> lane;

  Spectral() = default;
  // Not explicit: a number is the same number for every photon.
  Spectral(float all) { lane.fill(all); }  // NOLINT(google-explicit-constructor)

  float& operator[](std::size_t i) { return lane[i]; }
  float operator[](std::size_t i) const { return lane[i]; }
};

/// f(lane of a, lane of b, ...) for every lane.
template <int N, class F, class... Rest>
Spectral<N> each(const F& f, const Spectral<N>& a, const Rest&... rest) {
  Spectral<N> r;
  for (std::size_t i = 0; i < N; ++i) r[i] = f(a[i], rest[i]...);
  return r;
}

template <int N>
Spectral<N> operator+(const Spectral<N>& a, const Spectral<N>& b) {
  return each([](float x, float y) { return x + y; }, a, b);
}
template <int N>
Spectral<N> operator-(const Spectral<N>& a, const Spectral<N>& b) {
  return each([](float x, float y) { return x - y; }, a, b);
}
template <int N>
Spectral<N> operator*(const Spectral<N>& a, const Spectral<N>& b) {
  return each([](float x, float y) { return x * y; }, a, b);
}
template <int N>
Spectral<N> operator/(const Spectral<N>& a, const Spectral<N>& b) {
  return each([](float x, float y) { return x / y; }, a, b);
}
template <int N>
Spectral<N> operator+(const Spectral<N>& a, float b) {
  return each([b](float x) { return x + b; }, a);
}
template <int N>
Spectral<N> operator*(float a, const Spectral<N>& b) {
  return each([a](float x) { return a * x; }, b);
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
