#pragma once

#include <cstdint>

namespace nocturne {

/// Film in pixels; x to the right, y down, from its top left corner.
struct Film {
  std::uint32_t width, height;
};

}  // namespace nocturne
