#pragma once

#include <cstdint>

namespace nocturne {

/// From one state of the generator SplitMix64 to the next.
inline constexpr std::uint64_t kSplitMix64Step = 0x9E3779B97F4A7C15u;

/// What SplitMix64 gives for a state: a bijection in which every bit depends on all of x. G.
/// Steele, D. Lea and C. Flood, "Fast splittable pseudorandom number generators", OOPSLA 2014.
inline std::uint64_t splitmix64(std::uint64_t x) {
  x += kSplitMix64Step;
  x = (x ^ (x >> 30)) * 0xBF58476D1CE4E5B9u;
  x = (x ^ (x >> 27)) * 0x94D049BB133111EBu;
  return x ^ (x >> 31);
}

}  // namespace nocturne
