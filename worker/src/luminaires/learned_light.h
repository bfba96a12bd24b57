// Where light comes from at places that photons from the luminaires came to, as a density over
// directions: light that mirrors and glass gather comes in narrow cones that neither a surface nor
// a luminaire reveals. After Jensen, "Importance Driven Path Tracing Using the Photon Map", EGWR
// 1995, with cones in the place of a grid of directions.
//
// A k-d tree over places, with so few arrivals in each of its cells that all are asked. Around
// each arrival's direction is a cone as wide as its neighbours are apart.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "math/vec3.h"

namespace nocturne {

class LearnedLight {
 public:
  struct Arrival {
    Vec3 position;
    /// Unit, to where the photon came from.
    Vec3 direction;
  };
  /// Directions that are equally likely.
  struct Cone {
    Vec3 axis;
    /// Radians.
    float half_angle;
  };
  static constexpr std::uint32_t kNone = ~0u;
  static constexpr std::size_t kMaxArrivals = 1u << 16;

  LearnedLight() = default;
  /// Finite positions.
  explicit LearnedLight(const std::vector<Arrival>& arrivals);

  bool empty() const { return cells_.empty(); }
  /// Arrivals as CompiledScene.learned_light has them, and back, directions rounded to 1e-4. The
  /// latter throws std::invalid_argument for too many, for parts of one, and for invalid positions.
  static std::string packed(const std::vector<Arrival>& arrivals);
  static std::vector<Arrival> unpacked(std::string_view bytes);

  /// The cell that a place lies in, or kNone where too few photons came near.
  std::uint32_t find(Vec3 position) const;

  /// A unit direction; three uniform numbers.
  Vec3 sample(std::uint32_t cell, float choice, float u1, float u2) const;
  /// Density of `sample`, 1/sr.
  float pdf(std::uint32_t cell, Vec3 direction) const;
  /// Of which `sample` draws, each as likely.
  std::vector<Cone> cones(std::uint32_t cell) const;

 private:
  static constexpr std::size_t kArrivals = 32, kEnough = 8;

  struct Node {
    /// Of the lower and the upper part: a node, or a cell if it has kIsCell.
    std::array<std::uint32_t, 2> parts;
    std::uint32_t axis;
    float split;
  };
  static constexpr std::uint32_t kIsCell = 1u << 31;

  struct Cell {
    Vec3 low, high;
    std::uint32_t count = 0;
    std::array<float, kArrivals> x{}, y{}, z{};
    /// Square of the chord from a cone's axis to its rim, and density over all cones.
    std::array<float, kArrivals> square{}, density{};
  };

  std::uint32_t build(const std::vector<Arrival>& arrivals, std::vector<std::uint32_t>& order,
                      std::size_t begin, std::size_t end);
  std::uint32_t add_cell(const std::vector<Arrival>& arrivals, std::vector<std::uint32_t>& order,
                         std::size_t begin, std::size_t end);

  std::vector<Node> nodes_;
  std::vector<Cell> cells_;
  std::uint32_t root_ = kNone;
};

}  // namespace nocturne
