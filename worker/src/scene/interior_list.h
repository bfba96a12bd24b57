// The dielectric bodies that a photon is inside of. Where bodies overlap, the one with the highest
// priority is there, and boundaries of others are not seen: a liquid may reach into its glass.
// Schmidt and Budge, "Simple nested dielectrics in ray traced images", J. Graphics Tools 7(2),
// 2002.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "spectrum/spectrum.h"

namespace nocturne {

/// The inside of a dielectric body.
struct Interior {
  /// Of refraction.
  Spectrum index;
  /// 1/m; not looked at where the body is clear.
  Spectrum absorption;
  bool absorbs;
  /// Where bodies overlap, the one with the highest is there.
  std::int32_t priority;
};

class InteriorList {
 public:
  static constexpr std::uint32_t kOutside = ~0u;
  static constexpr std::uint32_t kMostBodies = 0xFFFF;
  /// Bodies that overlap at one point; a boundary that would make more is not seen.
  static constexpr std::size_t kMost = 7;

  bool empty() const { return count_ == 0; }

  /// The body that is there: highest priority, of equals the one entered first.
  std::uint32_t current(std::span<const Interior> interiors) const {
    std::uint32_t best = kOutside;
    for (std::size_t i = 0; i < count_; ++i) {
      if (best == kOutside || interiors[body_[i]].priority > interiors[best].priority) {
        best = body_[i];
      }
    }
    return best;
  }

  void enter(std::uint32_t body) {
    if (count_ < kMost) body_[count_++] = static_cast<std::uint16_t>(body);
  }

  /// Nothing happens where the photon is not inside.
  void leave(std::uint32_t body) {
    for (std::size_t i = count_; i-- > 0;) {
      if (body_[i] != body) continue;
      --count_;
      for (; i < count_; ++i) body_[i] = body_[i + 1];
      return;
    }
  }

 private:
  std::array<std::uint16_t, kMost> body_;
  std::uint16_t count_ = 0;
};

/// What a photon finds at the boundary of a body.
struct Boundary {
  /// Bodies before and behind; equal where the boundary is hidden inside another body.
  std::uint32_t from, to;
  /// The list behind.
  InteriorList beyond;
};

inline Boundary cross_boundary(const InteriorList& inside, std::span<const Interior> interiors,
                               std::uint32_t body, bool entering) {
  Boundary boundary{inside.current(interiors), 0, inside};
  if (entering) {
    boundary.beyond.enter(body);
  } else {
    // A photon that leaves what it never entered started inside, in an open shape.
    if (boundary.from == InteriorList::kOutside) boundary.from = body;
    boundary.beyond.leave(body);
  }
  boundary.to = boundary.beyond.current(interiors);
  return boundary;
}

}  // namespace nocturne
