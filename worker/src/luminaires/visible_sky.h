// Which part of the sky is visible from where, as a density over directions: in a room most
// directions to the sky end at a wall, and the environment's own density does not know the windows.
// After Mueller, Gross and Novak, "Practical Path Guiding for Efficient Light-Transport
// Simulation", EGSR 2017, for the sky alone (docs/decisions/0116-visible-sky.md).
//
// For each of six sides that a surface may face, a k-d tree over places at which photons from the
// sensor met the sky; each cell of it has a histogram of their directions.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "math/vec3.h"

namespace nocturne {

class VisibleSky {
 public:
  /// The sky met in a direction from a surface.
  struct Sighting {
    Vec3 position;
    /// Of the six that the surface faces, and bin of the direction.
    std::uint16_t side, bin;
    /// Positive; how much of the light from there other densities leave to this one, per 1/sr.
    float worth;
  };
  static constexpr std::uint32_t kNone = ~0u;
  static constexpr std::size_t kMaxSightings = 1u << 16;
  /// Part of the directions to the environment that is drawn from here; the rest limits the
  /// variance where the learned sky is wrong to 1 / (1 - kPart) of the former.
  static constexpr float kPart = 0.5f;

  VisibleSky() = default;
  explicit VisibleSky(const std::vector<Sighting>& sightings);

  /// Unit vectors.
  static Sighting sighting(Vec3 position, Vec3 normal, Vec3 direction, float worth);
  /// As CompiledScene.visible_sky has them, and back, worth to 8 bits. The latter throws
  /// std::invalid_argument for too many, for parts of one, and for invalid numbers.
  static std::string packed(const std::vector<Sighting>& sightings);
  static std::vector<Sighting> unpacked(std::string_view bytes);

  bool empty() const { return cells_.empty(); }
  /// The cell of a place on a surface that faces there, or kNone.
  std::uint32_t find(Vec3 position, Vec3 normal) const;
  /// A unit direction; two uniform numbers.
  Vec3 sample(std::uint32_t cell, float u1, float u2) const;
  /// Density of `sample`, 1/sr.
  float pdf(std::uint32_t cell, Vec3 direction) const;

 private:
  // Bins: rows of equal steps of z, columns of equal steps of a quarter turn's x / (x + y).
  static constexpr std::size_t kRows = 16, kColumns = 32, kBins = kRows * kColumns;
  static constexpr std::size_t kSides = 6;
  static constexpr std::uint32_t kIsCell = 1u << 31;
  /// Sightings of a cell, and how many are enough.
  static constexpr std::size_t kInCell = 48, kEnough = 8;

  struct Node {
    /// Of the lower and the upper part: a node, or a cell if it has kIsCell, or kNone.
    std::array<std::uint32_t, 2> parts;
    std::uint32_t axis;
    float split;
  };
  struct Cell {
    /// Sums of all bins before, in parts of kWhole.
    std::array<std::uint16_t, kBins + 1> before;
  };
  static constexpr std::uint16_t kWhole = 65535;

  static std::size_t bin_of(Vec3 direction);
  static std::size_t side_of(Vec3 normal);
  std::uint32_t build(std::vector<Sighting>& sightings, std::size_t begin, std::size_t end);
  std::uint32_t add_cell(const std::vector<Sighting>& sightings, std::size_t begin,
                         std::size_t end);

  std::array<std::uint32_t, kSides> roots_{kNone, kNone, kNone, kNone, kNone, kNone};
  std::vector<Node> nodes_;
  std::vector<Cell> cells_;
};

}  // namespace nocturne
