// Four numbers that lie side by side in a table, read at once for each photon of a group.
#pragma once

#include <array>
#include <cstddef>

#include "spectrum/spectral.h"

namespace nocturne {

using Row = LanesOf<4>::type;

/// The number at one place of each photon's row.
template <std::size_t N>
Spectral<static_cast<int>(N)> column(const std::array<Row, N>& rows, std::size_t place) {
  typename Spectral<static_cast<int>(N)>::Lanes lanes;
  for (std::size_t k = 0; k < N; ++k) lanes[k] = rows[k][place];
  return Spectral<static_cast<int>(N)>(lanes);
}

}  // namespace nocturne
