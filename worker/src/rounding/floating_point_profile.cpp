#include "rounding/floating_point_profile.h"

#include <immintrin.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numeric>
#include <string_view>
#include <type_traits>
#include <vector>

#include "digest/sha256.h"
#include "math/functions.h"
#include "surfaces/geometry.h"

namespace nocturne {
namespace {

constexpr int kArguments = 512;
constexpr int kRays = 2048;

class Answers {
 public:
  template <typename T>
  void add(T value) {
    static_assert(std::is_arithmetic_v<T>);
    bytes_.append(reinterpret_cast<const char*>(&value), sizeof value);
  }
  void add_text(std::string_view text) { bytes_ += text; }
  std::string hex() const {
    Sha256 digest;
    digest.update(bytes_);
    return digest.hex();
  }

 private:
  std::string bytes_;
};

/// Multiples of the golden ratio, modulo 1: spread evenly, with all bits in use.
double spread(int i) {
  const double turns = (i + 1) * 0.6180339887498949;
  return turns - std::floor(turns);
}

/// f over [low, high), in both precisions that the tracer uses.
template <typename F>
void add_function(Answers& answers, double low, double high, F f) {
  for (int i = 0; i < kArguments; ++i) {
    const double x = low + (high - low) * spread(i);
    answers.add(f(x));
    answers.add(f(static_cast<float>(x)));
  }
}

/// f(x, y), x over [low, high), y over [-2, 2).
template <typename F>
void add_function_of_two(Answers& answers, double low, double high, F f) {
  for (int i = 0; i < kArguments; ++i) {
    const double x = low + (high - low) * spread(i), y = 4.0 * spread(7 * i) - 2.0;
    answers.add(f(x, y));
    answers.add(f(static_cast<float>(x), static_cast<float>(y)));
  }
}

// Our own functions have the same bits wherever sums, products and fused products are rounded as
// IEEE 754 says, unless a compiler has put them in another order.
void add_functions(Answers& answers) {
  add_function(answers, -30.0, 30.0, [](auto x) { return math::sin(x); });
  add_function(answers, -30.0, 30.0, [](auto x) { return math::cos(x); });
  add_function(answers, -1.5, 1.5, [](auto x) { return math::tan(x); });
  add_function(answers, -1.0, 1.0, [](auto x) { return math::acos(x); });
  add_function(answers, -80.0, 80.0, [](auto x) { return math::exp(x); });
  add_function(answers, -80.0, 80.0, [](auto x) { return math::exp2(x); });
  add_function(answers, -20.0, 20.0, [](auto x) { return math::expm1(x); });
  add_function(answers, 1e-3, 50.0, [](auto x) { return math::log(x); });
  add_function(answers, 1e-3, 50.0, [](auto x) { return math::log2(x); });
  add_function(answers, -0.999, 20.0, [](auto x) { return math::log1p(x); });
  add_function(answers, -20.0, 20.0, [](auto x) { return math::sinh(x); });
  add_function(answers, -20.0, 20.0, [](auto x) { return math::asinh(x); });
  add_function(answers, -50.0, 50.0, [](auto x) { return math::cbrt(x); });
  add_function(answers, -5.0, 5.0, [](auto x) { return math::erfc(x); });
  add_function_of_two(answers, 1e-3, 20.0, [](auto x, auto y) { return math::pow(x, y); });
  add_function_of_two(answers, -20.0, 20.0, [](auto x, auto y) { return math::atan2(x, y); });
  add_function_of_two(answers, -20.0, 20.0, [](auto x, auto y) { return math::hypot(x, y); });
}

// How numbers are rounded, whether products and sums were contracted, what becomes of tiny ones.
void add_arithmetic(Answers& answers) {
  answers.add(_mm_getcsr() & ~static_cast<unsigned>(_MM_EXCEPT_MASK));
  volatile double one = 1.0, three = 3.0, tenth = 0.1;
  answers.add(one / three);
  answers.add(-one / three);
  answers.add(tenth * tenth - 0.01);
  volatile float tiny = std::numeric_limits<float>::min(), half = 0.5f;
  answers.add(tiny * half);
  answers.add(std::sqrt(static_cast<float>(tenth)));
}

// The standard leaves open where equal elements end up, and compilers in which order they add.
void add_algorithms(Answers& answers) {
  std::vector<int> order(1000);
  std::iota(order.begin(), order.end(), 0);
  std::sort(order.begin(), order.end(), [](int a, int b) { return a % 7 < b % 7; });
  for (const int each : order) answers.add(each);
  std::partition(order.begin(), order.end(), [](int a) { return a % 3 == 0; });
  for (const int each : order) answers.add(each);
  std::vector<double> terms;
  for (int i = 0; i < 1000; ++i) terms.push_back(spread(i));
  answers.add(std::accumulate(terms.begin(), terms.end(), 0.0));
}

/// A rough ground of 32 x 32 squares, once more in the same place, and two balls above it.
Geometry landscape() {
  constexpr std::uint32_t kEdge = 33;
  TriangleMesh ground;
  for (std::uint32_t i = 0; i < kEdge * kEdge; ++i) {
    ground.vertices.push_back({static_cast<float>(i % kEdge), static_cast<float>(i / kEdge),
                               static_cast<float>(spread(static_cast<int>(i)))});
  }
  for (std::uint32_t y = 0; y + 1 < kEdge; ++y) {
    for (std::uint32_t x = 0; x + 1 < kEdge; ++x) {
      const std::uint32_t at = y * kEdge + x;
      ground.triangles.push_back({at, at + 1, at + kEdge + 1});
      ground.triangles.push_back({at, at + kEdge + 1, at + kEdge});
    }
  }
  return Geometry({ground, ground, Sphere{8.3, 9.1, 2.7, 3.9}, Sphere{22.7, 20.2, 4.1, 3.3}});
}

void add_hit(Answers& answers, const Hit& hit) {
  answers.add(hit.surface);
  answers.add(hit.primitive);
  for (const float each :
       {hit.distance, hit.u, hit.v, hit.clearance, hit.position.x, hit.position.y, hit.position.z,
        hit.normal.x, hit.normal.y, hit.normal.z}) {
    answers.add(each);
  }
}

void add_hits(Answers& answers) {
  answers.add_text(Geometry::library());
  const Geometry scene = landscape();
  std::array<NearCrossing, 8> others{};
  for (int i = 0; i < kRays; ++i) {
    const auto at = [i](int step) { return static_cast<float>(spread(5 * i + step)); };
    const Ray ray{{32.0f * at(0), 32.0f * at(1), 12.0f},
                  normalized(Vec3{at(2) - 0.5f, at(3) - 0.5f, -0.2f - at(4)})};
    const auto hit = scene.intersect(ray, 0.0f);
    answers.add(hit.has_value());
    if (!hit) continue;
    add_hit(answers, *hit);
    const std::size_t near = scene.crossings_near(ray, 0.0f, {}, *hit, 1e-3f, others);
    for (std::size_t j = 0; j < near; ++j) add_hit(answers, others[j].hit);
  }
}

}  // namespace

std::string floating_point_profile() {
  Answers answers;
  add_arithmetic(answers);
  add_functions(answers);
  add_algorithms(answers);
  add_hits(answers);
  return answers.hex().substr(0, 16);
}

}  // namespace nocturne
