#include "luminaires/visible_sky.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <stdexcept>

namespace nocturne {
namespace {

/// Weight of a sighting in the bin next to its own, and across a corner: bins are as wide as few
/// sightings are apart.
constexpr double kBeside = 0.25, kAcross = 0.1;

/// Of a bin: a part of its width.
constexpr float kEdge = 0x1p-18f;

struct Packed {
  std::array<float, 3> position;
  std::uint16_t place;  // side x bins + bin
  std::uint16_t worth;  // the upper half of a float
};
static_assert(sizeof(Packed) == 16);

float along(Vec3 p, std::uint32_t axis) { return axis == 0 ? p.x : axis == 1 ? p.y : p.z; }

// Of a full turn, [0, 4): the quarter, and how far in it by y / (x + y), which needs no angle.
float around(Vec3 d) {
  const float size = std::fabs(d.x) + std::fabs(d.y);
  if (!(size > 0.0f)) return 0.0f;
  const float t = d.y / size;
  return d.x >= 0.0f ? (t >= 0.0f ? t : 4.0f + t) : 2.0f - t;
}

// Radians in a step of `around` there.
float stretch(Vec3 d) {
  const float size = std::fabs(d.x) + std::fabs(d.y), square = d.x * d.x + d.y * d.y;
  return square > 0.0f ? size * size / square : 1.0f;
}

std::size_t part_of(float at, float whole, std::size_t count) {
  const float part = std::max(0.0f, at / whole * static_cast<float>(count));
  return std::min(count - 1, static_cast<std::size_t>(part));
}

}  // namespace

std::size_t VisibleSky::bin_of(Vec3 d) {
  return part_of(d.z + 1.0f, 2.0f, kRows) * kColumns + part_of(around(d), 4.0f, kColumns);
}

std::size_t VisibleSky::side_of(Vec3 n) {
  const float x = std::fabs(n.x), y = std::fabs(n.y), z = std::fabs(n.z);
  if (x >= y && x >= z) return n.x > 0.0f ? 0 : 1;
  if (y >= z) return n.y > 0.0f ? 2 : 3;
  return n.z > 0.0f ? 4 : 5;
}

VisibleSky::Sighting VisibleSky::sighting(Vec3 position, Vec3 normal, Vec3 direction, float worth) {
  return {position, static_cast<std::uint16_t>(side_of(normal)),
          static_cast<std::uint16_t>(bin_of(direction)), worth};
}

std::string VisibleSky::packed(const std::vector<Sighting>& sightings) {
  std::string bytes;
  for (const auto& [p, side, bin, worth] : sightings) {
    const Packed one{{p.x, p.y, p.z},
                     static_cast<std::uint16_t>(side * kBins + bin),
                     static_cast<std::uint16_t>(std::bit_cast<std::uint32_t>(worth) >> 16)};
    bytes.append(reinterpret_cast<const char*>(&one), sizeof(one));
  }
  return bytes;
}

std::vector<VisibleSky::Sighting> VisibleSky::unpacked(std::string_view bytes) {
  if (bytes.size() % sizeof(Packed) != 0 || bytes.size() / sizeof(Packed) > kMaxSightings) {
    throw std::invalid_argument("a visible sky that is no list of at most 65,536 sightings");
  }
  std::vector<Sighting> sightings;
  for (std::size_t at = 0; at < bytes.size(); at += sizeof(Packed)) {
    Packed one;
    std::memcpy(&one, bytes.data() + at, sizeof(one));
    const auto& [x, y, z] = one.position;
    const float worth = std::bit_cast<float>(std::uint32_t{one.worth} << 16);
    if (!std::isfinite(x) || !std::isfinite(y) || !std::isfinite(z) || !std::isfinite(worth) ||
        !(worth >= 0.0f) || one.place >= kSides * kBins) {
      throw std::invalid_argument("a visible sky with a sighting of no place, side or worth");
    }
    sightings.push_back({{x, y, z},
                         static_cast<std::uint16_t>(one.place / kBins),
                         static_cast<std::uint16_t>(one.place % kBins),
                         worth});
  }
  return sightings;
}

VisibleSky::VisibleSky(const std::vector<Sighting>& sightings) {
  for (std::size_t side = 0; side < kSides; ++side) {
    std::vector<Sighting> from;
    for (const Sighting& each : sightings) {
      if (each.side == side) from.push_back(each);
    }
    roots_[side] = build(from, 0, from.size());
  }
}

std::uint32_t VisibleSky::build(std::vector<Sighting>& all, std::size_t begin, std::size_t end) {
  if (end - begin < kEnough) return kNone;
  if (end - begin <= kInCell) return add_cell(all, begin, end);
  Vec3 low = all[begin].position, high = low;
  for (std::size_t i = begin; i < end; ++i) {
    const Vec3 p = all[i].position;
    low = {std::min(low.x, p.x), std::min(low.y, p.y), std::min(low.z, p.z)};
    high = {std::max(high.x, p.x), std::max(high.y, p.y), std::max(high.z, p.z)};
  }
  std::uint32_t widest = 0;
  for (std::uint32_t axis = 1; axis < 3; ++axis) {
    if (along(high, axis) - along(low, axis) > along(high, widest) - along(low, widest)) {
      widest = axis;
    }
  }
  const auto at = [&](std::size_t i) { return all.begin() + static_cast<std::ptrdiff_t>(i); };
  const std::size_t middle = begin + (end - begin) / 2;
  std::nth_element(at(begin), at(middle), at(end), [&](const Sighting& a, const Sighting& b) {
    return along(a.position, widest) < along(b.position, widest);
  });
  const float split = along(all[middle].position, widest);
  // All that are on one plane are on the same side of it.
  const auto upper = std::partition(at(begin), at(end), [&](const Sighting& each) {
    return along(each.position, widest) < split;
  });
  const auto first_above = static_cast<std::size_t>(upper - all.begin());
  if (first_above == begin) return add_cell(all, begin, end);
  const auto index = static_cast<std::uint32_t>(nodes_.size());
  nodes_.push_back({{kNone, kNone}, widest, split});
  const std::uint32_t below = build(all, begin, first_above), above = build(all, first_above, end);
  nodes_[index].parts = {below, above};
  return index;
}

std::uint32_t VisibleSky::add_cell(const std::vector<Sighting>& all, std::size_t begin,
                                   std::size_t end) {
  std::array<double, kBins> worth{};
  for (std::size_t i = begin; i < end; ++i) {
    const auto bin = static_cast<int>(all[i].bin), columns = static_cast<int>(kColumns);
    const int row = bin / columns, column = bin % columns;
    for (int down = -1; down <= 1; ++down) {
      if (row + down < 0 || row + down >= static_cast<int>(kRows)) continue;
      for (int right = -1; right <= 1; ++right) {
        const double part = down == 0 && right == 0   ? 1.0
                            : down == 0 || right == 0 ? kBeside
                                                      : kAcross;
        const auto c = static_cast<std::size_t>(column + right + static_cast<int>(kColumns));
        worth[static_cast<std::size_t>(row + down) * kColumns + c % kColumns] +=
            part * static_cast<double>(all[i].worth);
      }
    }
  }
  double whole = 0.0;
  for (const double each : worth) whole += each;
  if (!(whole > 0.0) || !std::isfinite(whole)) return kNone;
  Cell& cell = cells_.emplace_back();
  double before = 0.0;
  for (std::size_t bin = 0; bin < kBins; ++bin) {
    cell.before[bin] = static_cast<std::uint16_t>(std::lround(before / whole * kWhole));
    before += worth[bin];
  }
  cell.before[kBins] = kWhole;
  return static_cast<std::uint32_t>(cells_.size() - 1) | kIsCell;
}

std::uint32_t VisibleSky::find(Vec3 position, Vec3 normal) const {
  std::uint32_t at = roots_[side_of(normal)];
  while ((at & kIsCell) == 0) {
    const Node& node = nodes_[at];
    at = node.parts[along(position, node.axis) < node.split ? 0 : 1];
  }
  return at == kNone ? kNone : at & ~kIsCell;
}

Vec3 VisibleSky::sample(std::uint32_t index, float u1, float u2) const {
  const auto& before = cells_[index].before;
  const float target = u1 * static_cast<float>(kWhole);
  const auto whole = static_cast<std::uint16_t>(target);
  const auto after = std::upper_bound(before.begin(), before.end() - 1, whole);
  const auto bin = static_cast<std::size_t>(after - before.begin()) - 1;
  const auto width = static_cast<float>(before[bin + 1] - before[bin]);
  // So far within the bin that rounding does not put the direction into another.
  const auto within = [](float u) { return std::clamp(u, kEdge, 1.0f - kEdge); };
  const float in_row = within((target - static_cast<float>(before[bin])) / width);
  const float z =
      2.0f * (static_cast<float>(bin / kColumns) + in_row) / static_cast<float>(kRows) - 1.0f;
  const float turn =
      4.0f * (static_cast<float>(bin % kColumns) + within(u2)) / static_cast<float>(kColumns);
  const int quarter = std::min(3, static_cast<int>(turn));
  const float t = turn - static_cast<float>(quarter), s = 1.0f - t;
  const float radius = std::sqrt(std::max(0.0f, 1.0f - z * z) / (s * s + t * t));
  const float x = radius * s, y = radius * t;
  switch (quarter) {
    case 0:
      return {x, y, z};
    case 1:
      return {-y, x, z};
    case 2:
      return {-x, -y, z};
    default:
      return {y, -x, z};
  }
}

float VisibleSky::pdf(std::uint32_t index, Vec3 direction) const {
  // Area of a bin: 2 / rows times 4 / columns, stretched.
  constexpr float kPerBin = static_cast<float>(kBins) / 8.0f / static_cast<float>(kWhole);
  const auto& before = cells_[index].before;
  const std::size_t bin = bin_of(direction);
  return static_cast<float>(before[bin + 1] - before[bin]) * kPerBin / stretch(direction);
}

}  // namespace nocturne
