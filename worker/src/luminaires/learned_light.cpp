#include "luminaires/learned_light.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <numeric>
#include <stdexcept>

#include "math/constants.h"
#include "math/frame.h"
#include "math/functions.h"
#include "surfaces/octahedron.h"

namespace nocturne {
namespace {

/// A cone reaches so many times as far as the neighbour of this rank.
constexpr std::size_t kNeighbour = 4;
constexpr float kReach = 2.0f;
/// Of the chord of a cone: above the rounding of directions; the sphere.
constexpr float kLeastSquare = 4e-6f, kMostSquare = 4.0f;
/// A cell is wider than its arrivals by this part of its largest edge.
constexpr float kMargin = 0.25f;

struct Packed {
  std::array<float, 3> position;
  std::array<std::int16_t, 2> direction;
};
static_assert(sizeof(Packed) == 16);
constexpr float kOctahedronSteps = 32767.0f;

float along(Vec3 p, std::size_t axis) { return axis == 0 ? p.x : axis == 1 ? p.y : p.z; }

float square_of_chord(Vec3 a, Vec3 b) {
  const Vec3 apart = a - b;
  return dot(apart, apart);
}

}  // namespace

LearnedLight::LearnedLight(const std::vector<Arrival>& arrivals) {
  if (arrivals.size() < kEnough) return;
  std::vector<std::uint32_t> order(arrivals.size());
  std::iota(order.begin(), order.end(), 0u);
  root_ = build(arrivals, order, 0, order.size());
}

std::string LearnedLight::packed(const std::vector<Arrival>& arrivals) {
  std::string bytes;
  for (const auto& [p, d] : arrivals) {
    const OctahedronPoint point = unfold(d);
    const auto step = [](float at) {
      return static_cast<std::int16_t>(std::lround(kOctahedronSteps * at));
    };
    const Packed one{{p.x, p.y, p.z}, {step(point.u), step(point.v)}};
    bytes.append(reinterpret_cast<const char*>(&one), sizeof(one));
  }
  return bytes;
}

std::vector<LearnedLight::Arrival> LearnedLight::unpacked(std::string_view bytes) {
  if (bytes.size() % sizeof(Packed) != 0 || bytes.size() / sizeof(Packed) > kMaxArrivals) {
    throw std::invalid_argument("learned light that is no list of at most 65,536 arrivals");
  }
  std::vector<Arrival> arrivals;
  for (std::size_t at = 0; at < bytes.size(); at += sizeof(Packed)) {
    Packed one;
    std::memcpy(&one, bytes.data() + at, sizeof(one));
    const auto& [position, direction] = one;
    if (!std::ranges::all_of(position, [](float each) { return std::isfinite(each); })) {
      throw std::invalid_argument("learned light at no place");
    }
    const auto coordinate = [](std::int16_t step) {
      return std::max(-1.0f, static_cast<float>(step) / kOctahedronSteps);
    };
    const Double3 d = fold(coordinate(direction[0]), coordinate(direction[1]));
    arrivals.push_back({{position[0], position[1], position[2]}, d.rounded()});
  }
  return arrivals;
}

std::uint32_t LearnedLight::build(const std::vector<Arrival>& arrivals,
                                  std::vector<std::uint32_t>& order, std::size_t begin,
                                  std::size_t end) {
  if (end - begin <= kArrivals) return add_cell(arrivals, order, begin, end) | kIsCell;
  std::array<float, 3> low, high;
  low.fill(std::numeric_limits<float>::infinity());
  high.fill(-std::numeric_limits<float>::infinity());
  for (std::size_t i = begin; i < end; ++i) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const float at = along(arrivals[order[i]].position, axis);
      low[axis] = std::min(low[axis], at);
      high[axis] = std::max(high[axis], at);
    }
  }
  std::uint32_t widest = 0;
  for (std::uint32_t axis = 1; axis < 3; ++axis) {
    if (high[axis] - low[axis] > high[widest] - low[widest]) widest = axis;
  }
  // Places on a plane have one coordinate in common: all that have it are on the same side.
  std::vector<float> coordinates;
  for (std::size_t i = begin; i < end; ++i) {
    coordinates.push_back(along(arrivals[order[i]].position, widest));
  }
  const auto half = coordinates.begin() + static_cast<std::ptrdiff_t>(coordinates.size() / 2);
  std::ranges::nth_element(coordinates, half);
  float split = *half;
  if (split == low[widest]) {
    split = high[widest];
    for (const float at : coordinates) {
      if (at > low[widest]) split = std::min(split, at);
    }
  }
  if (!(split > low[widest])) return add_cell(arrivals, order, begin, begin + kArrivals) | kIsCell;
  const auto at = [&](std::size_t i) { return order.begin() + static_cast<std::ptrdiff_t>(i); };
  const auto upper_half = std::partition(at(begin), at(end), [&](std::uint32_t i) {
    return along(arrivals[i].position, widest) < split;
  });
  const auto middle = static_cast<std::size_t>(upper_half - order.begin());
  const auto index = static_cast<std::uint32_t>(nodes_.size());
  nodes_.push_back({{}, widest, split});
  const std::uint32_t lower = build(arrivals, order, begin, middle);
  const std::uint32_t upper = build(arrivals, order, middle, end);
  nodes_[index].parts = {lower, upper};
  return index;
}

std::uint32_t LearnedLight::add_cell(const std::vector<Arrival>& arrivals,
                                     std::vector<std::uint32_t>& order, std::size_t begin,
                                     std::size_t end) {
  std::sort(order.begin() + static_cast<std::ptrdiff_t>(begin),
            order.begin() + static_cast<std::ptrdiff_t>(end));
  Cell& cell = cells_.emplace_back();
  // Where one coordinate is common to most, few may be left on one side of a plane.
  if (end - begin < kEnough) return static_cast<std::uint32_t>(cells_.size() - 1);
  cell.count = static_cast<std::uint32_t>(end - begin);
  cell.low = cell.high = arrivals[order[begin]].position;
  for (std::uint32_t i = 0; i < cell.count; ++i) {
    const auto& [p, direction] = arrivals[order[begin + i]];
    cell.low = {std::min(cell.low.x, p.x), std::min(cell.low.y, p.y), std::min(cell.low.z, p.z)};
    cell.high = {std::max(cell.high.x, p.x), std::max(cell.high.y, p.y),
                 std::max(cell.high.z, p.z)};
    cell.x[i] = direction.x;
    cell.y[i] = direction.y;
    cell.z[i] = direction.z;
    std::vector<float> squares;
    for (std::size_t k = begin; k < end; ++k) {
      if (k != begin + i)
        squares.push_back(square_of_chord(direction, arrivals[order[k]].direction));
    }
    const std::size_t rank = std::min(kNeighbour, squares.size()) - 1;
    std::ranges::nth_element(squares, squares.begin() + static_cast<std::ptrdiff_t>(rank));
    cell.square[i] = std::clamp(kReach * kReach * squares[rank], kLeastSquare, kMostSquare);
    // Archimedes: a cap has the area of a disc with the chord as its radius.
    cell.density[i] = 1.0f / (kPi * cell.square[i] * static_cast<float>(cell.count));
  }
  const Vec3 size = cell.high - cell.low;
  const float margin = kMargin * std::max({size.x, size.y, size.z});
  cell.low = cell.low - Vec3{margin, margin, margin};
  cell.high = cell.high + Vec3{margin, margin, margin};
  return static_cast<std::uint32_t>(cells_.size() - 1);
}

std::uint32_t LearnedLight::find(Vec3 p) const {
  std::uint32_t at = root_;
  if (at == kNone) return kNone;
  while ((at & kIsCell) == 0) {
    const Node& node = nodes_[at];
    at = node.parts[along(p, node.axis) < node.split ? 0 : 1];
  }
  at &= ~kIsCell;
  const Cell& cell = cells_[at];
  const bool inside = cell.count > 0 && p.x >= cell.low.x && p.y >= cell.low.y &&
                      p.z >= cell.low.z && p.x <= cell.high.x && p.y <= cell.high.y &&
                      p.z <= cell.high.z;
  return inside ? at : kNone;
}

Vec3 LearnedLight::sample(std::uint32_t index, float choice, float u1, float u2) const {
  const Cell& cell = cells_[index];
  const auto count = static_cast<float>(cell.count);
  const auto i = std::min(static_cast<std::size_t>(choice * count), std::size_t{cell.count} - 1);
  // Uniform over the cap, by the chord.
  const float square = cell.square[i] * u1;
  const float z = 1.0f - 0.5f * square;
  const float r = std::sqrt(square * std::max(0.0f, 1.0f - 0.25f * square));
  const float phi = kTwoPi * u2;
  return Frame({cell.x[i], cell.y[i], cell.z[i]})
      .to_world({r * math::cos(phi), r * math::sin(phi), z});
}

float LearnedLight::pdf(std::uint32_t index, Vec3 direction) const {
  const Cell& cell = cells_[index];
  float sum = 0.0f;
  for (std::size_t i = 0; i < kArrivals; ++i) {
    const float x = direction.x - cell.x[i], y = direction.y - cell.y[i],
                z = direction.z - cell.z[i];
    sum += x * x + y * y + z * z <= cell.square[i] ? cell.density[i] : 0.0f;
  }
  return sum;
}

std::vector<LearnedLight::Cone> LearnedLight::cones(std::uint32_t index) const {
  const Cell& cell = cells_[index];
  std::vector<Cone> cones;
  for (std::size_t i = 0; i < cell.count; ++i) {
    const float sine = 0.5f * std::sqrt(cell.square[i]);  // of half the half angle
    const float half_angle = 2.0f * math::atan2(sine, std::sqrt(1.0f - sine * sine));
    cones.push_back({{cell.x[i], cell.y[i], cell.z[i]}, half_angle});
  }
  return cones;
}

}  // namespace nocturne
