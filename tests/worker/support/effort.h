// How much is drawn and traced: all in `make accuracy`, a part in `make test`.
#pragma once

#include <cstdint>
#include <cstdlib>

namespace nocturne::test {

/// By the variable of the environment that tests/accuracy/tracing.py reads.
inline bool in_full() {
  static const bool full = std::getenv("NOCTURNE_ACCURACY") != nullptr;
  return full;
}

/// A quarter of the draws of a test whose bound follows from their scatter: false alarms stay as
/// rare, and an error is noticed where it is twice as large.
inline std::uint32_t part_of(std::uint32_t draws) { return in_full() ? draws : draws / 4; }

/// The edge of a film: half as long, so that a quarter of the pixels are traced, each in full.
inline std::uint32_t film_edge(std::uint32_t edge) { return in_full() ? edge : edge / 2; }

}  // namespace nocturne::test
