// The bodies that a photon is inside of. Where dielectric bodies overlap, the one with the highest
// priority is there, and boundaries of others are not seen: a liquid may reach into its glass.
// Schmidt and Budge, "Simple nested dielectrics in ray traced images", J. Graphics Tools 7(2),
// 2002. Matched bodies, such as a bank of fog, overlap each other freely; a dielectric keeps out
// those of no higher priority.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "spectrum/spectrum.h"

namespace nocturne {

/// What a body is filled with, behind its boundary.
struct Interior {
  /// Of refraction; not looked at where index-matched.
  Spectrum index;
  /// 1/m; not looked at where the body is clear.
  Spectrum absorption;
  bool absorbs;
  /// Where bodies overlap, the one with the highest is there.
  std::int32_t priority;
  /// Has the index of its surroundings.
  bool index_matched = false;
  /// That fill it: indices into the scene's list.
  std::vector<std::uint32_t> media = {};
  /// Of refraction, on the side that the normal points to, where the surface bounds no body
  /// (SurfaceMaterial::boundary).
  Spectrum outside = Spectrum(1.0f);
  /// All of its boundaries are closed shapes: a photon that will meet nothing more is outside.
  bool closed = false;
};

class InteriorList {
 public:
  static constexpr std::uint32_t kOutside = ~0u;
  static constexpr std::uint32_t kMaxBodies = 0xFFFF;
  /// Bodies that overlap at one point; a boundary that would make more is not seen.
  static constexpr std::size_t kMax = 7;

  bool empty() const { return count_ == 0; }

  /// In the same order.
  friend bool operator==(const InteriorList& a, const InteriorList& b) {
    return std::ranges::equal(std::span(a.body_).first(a.count_),
                              std::span(b.body_).first(b.count_));
  }

  /// The dielectric body that is there: highest priority, of equals the one entered first.
  std::uint32_t current(std::span<const Interior> interiors) const {
    std::uint32_t best = kOutside;
    for (std::size_t i = 0; i < count_; ++i) {
      const Interior& body = interiors[body_[i]];
      if (body.index_matched) continue;
      if (best == kOutside || body.priority > interiors[best].priority) best = body_[i];
    }
    return best;
  }

  /// f(medium interface) for every body that is there: the dielectric, and the index-matched ones
  /// that it does not keep out.
  template <class F>
  void for_each_present(std::span<const Interior> interiors, const F& f) const {
    const std::uint32_t dielectric = current(interiors);
    for (std::size_t i = 0; i < count_; ++i) {
      const Interior& body = interiors[body_[i]];
      const bool there = body.index_matched ? dielectric == kOutside ||
                                                  body.priority > interiors[dielectric].priority
                                            : body_[i] == dielectric;
      if (there) f(body);
    }
  }

  bool holds(std::uint32_t body) const {
    return std::find(body_.begin(), body_.begin() + count_, body) != body_.begin() + count_;
  }

  void enter(std::uint32_t body) {
    if (count_ < kMax) body_[count_++] = static_cast<std::uint16_t>(body);
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

  /// For a photon that will meet nothing more: it is outside of all closed bodies, though it may
  /// count as in one. At an edge rounding can put it beyond the next face, and it enters twice.
  InteriorList without_closed(std::span<const Interior> interiors) const {
    InteriorList open;
    for (std::size_t i = 0; i < count_; ++i) {
      if (!interiors[body_[i]].closed) open.enter(body_[i]);
    }
    return open;
  }

 private:
  std::array<std::uint16_t, kMax> body_;
  std::uint16_t count_ = 0;
};

/// What a photon finds at the boundary of a body.
struct Boundary {
  /// Bodies before and behind; equal where the boundary is hidden inside another body.
  std::uint32_t from, to;
  /// The list behind.
  InteriorList beyond;
};

struct Crossing {
  std::uint32_t body;
  bool entering;
};

/// What else is crossed in the same place.
class Contacts {
 public:
  static constexpr std::size_t kMax = 8;

  Contacts() {}  // what is not there need not be zero

  bool empty() const { return count_ == 0; }
  const Crossing* begin() const { return all_.data(); }
  const Crossing* end() const { return all_.data() + count_; }

  /// Once each; beyond what fits they are not seen.
  void add(Crossing crossing) {
    const bool known = std::any_of(begin(), end(), [&](const Crossing& c) {
      return c.body == crossing.body && c.entering == crossing.entering;
    });
    if (!known && count_ < kMax) all_[count_++] = crossing;
  }

 private:
  std::array<Crossing, kMax> all_;
  std::size_t count_ = 0;
};

/// `own` is empty for a surface that bounds no body. The entered body is there before the left one
/// is gone: nothing lies between bodies that touch.
inline Boundary cross_boundary(const InteriorList& inside, std::span<const Interior> interiors,
                               std::optional<Crossing> own, const Contacts& contacts) {
  Boundary boundary{inside.current(interiors), 0, inside};
  const auto enter = [&](const Crossing& c) {
    if (c.entering) boundary.beyond.enter(c.body);
  };
  const auto leave = [&](const Crossing& c) {
    if (c.entering) return;
    // A photon that leaves a body it never entered started inside, in an open shape.
    if (boundary.from == InteriorList::kOutside && !interiors[c.body].index_matched &&
        !boundary.beyond.holds(c.body)) {
      boundary.from = c.body;
    }
    boundary.beyond.leave(c.body);
  };
  if (own) enter(*own);
  for (const Crossing& c : contacts) enter(c);
  if (own) leave(*own);
  for (const Crossing& c : contacts) leave(c);
  boundary.to = boundary.beyond.current(interiors);
  return boundary;
}

}  // namespace nocturne
