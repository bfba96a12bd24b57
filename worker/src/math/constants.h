#pragma once

#include <numbers>

namespace nocturne {

inline constexpr float kPi = std::numbers::pi_v<float>;
inline constexpr float kInvPi = std::numbers::inv_pi_v<float>;
inline constexpr float kTwoPi = 2.0f * kPi;

inline constexpr float kOneMinusEpsilon = 0x1.fffffep-1f;

}  // namespace nocturne
