// Numbers by the golden ratio: any few of them in a row are spread over [0, 1) almost evenly.
#pragma once

#include <cmath>

namespace nocturne {

/// The i-th of them, a whole number as float.
inline float by_golden_ratio(float i) {
  const float turn = i * 0.618034f;
  return turn - std::floor(turn);
}

}  // namespace nocturne
