// Tentative collisions along a ray in a medium whose density varies: as often as in one that is
// everywhere as dense as its bounds. Which of them are real is up to the caller. Woodcock et al.,
// "Techniques used in the GEM code for Monte Carlo neutronics calculations", ANL-7050, 1965.
#pragma once

#include <algorithm>
#include <cstdint>

#include "math/functions.h"
#include "math/ray.h"
#include "math/splitmix64.h"
#include "media/majorants.h"
#include "sampling/sequence.h"
#include "tracer/path_limits.h"

namespace nocturne {

/// A stream of uniform numbers for one flight in one medium, of SplitMix64.
class FlightNumbers {
 public:
  explicit FlightNumbers(std::uint64_t seed) : state_(seed) {}
  /// The first number is given.
  FlightNumbers(std::uint64_t seed, float first) : state_(seed), first_(first) {}

  /// Where a distance starts.
  float first() { return first_ >= 0.0f ? first_ : (*this)(); }

  float operator()() {
    const std::uint64_t bits = splitmix64(state_);
    state_ += kSplitMix64Step;
    return to_unit(static_cast<std::uint32_t>(bits >> 32));
  }

 private:
  std::uint64_t state_;
  float first_ = -1.0f;
};

/// Optical depths are exponentially distributed. Numbers have 32 bits, so depths end at 22.2 (and
/// a share of 2e-10 that lies beyond is moved there).
inline float exponential(float u) { return -math::log(std::max(u, 0x1p-33f)); }

struct Tentative {
  /// Along the ray, m.
  float distance;
  float density;
  /// The majorant there, times the extinction, 1/m.
  float majorant;
};

/// f(tentative collision) for each before `end`, in order, until it says false. `extinction`: the
/// largest of all photons, 1/m at density 1. False where there are more than a flight may have.
template <class Density, class F>
bool for_each_tentative(const Density& density, float extinction, const Ray& ray, float end,
                        FlightNumbers& numbers, const PathLimits& limits, const F& f) {
  std::uint32_t tried = 0;
  typename Density::Majorants majorants(density, ray, end);
  float position = 0.0f, depth = exponential(numbers.first());
  for (MajorantSegment segment; majorants.next(segment); position = segment.end) {
    const float majorant = segment.majorant * extinction;
    if (!(majorant > 0.0f)) continue;
    for (;;) {
      const float left = (segment.end - position) * majorant;
      if (depth >= left) {
        depth -= left;
        break;
      }
      position += depth / majorant;
      depth = exponential(numbers());
      // Rounding may lift a density above its majorant by a unit in the last place.
      const float here = std::min(majorants.density(position), segment.majorant);
      if (!f(Tentative{position, here, majorant})) return true;
      if (++tried % PathLimits::kTentativeUnwatched == 0) {
        limits.check_stop();
        if (tried == PathLimits::kMaxTentative) return false;
      }
    }
  }
  return true;
}

}  // namespace nocturne
