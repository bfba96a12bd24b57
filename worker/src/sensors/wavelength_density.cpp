#include "sensors/wavelength_density.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <functional>
#include <stdexcept>

namespace nocturne {
namespace {

// At least so many slices in all, and for each part; what two of them are worth is little.
constexpr std::uint32_t kSlices = 2048, kSlicesOfPart = 8;
constexpr double kLittle = 2.0 / kSlices;

// What lies between two knots, or, where that is little, more.
struct Part {
  float knot;
  double width, area, highest;
  // Density at the beginning over the mean: linear, if this is one cell.
  double low;
};

std::vector<Part> cells_of(const std::vector<float>& knots, const std::vector<float>& density) {
  if (knots.size() < 2 || density.size() != knots.size()) {
    throw std::invalid_argument("a wavelength density needs two knots, and a value at each");
  }
  std::vector<Part> cells;
  for (std::size_t i = 0; i < knots.size(); ++i) {
    if (!std::isfinite(knots[i]) || !std::isfinite(density[i]) || !(density[i] >= 0.0f)) {
      throw std::invalid_argument("a wavelength density that is negative or not finite");
    }
    if (i == 0) continue;
    const double width = static_cast<double>(knots[i]) - knots[i - 1];
    if (width < 0.0) throw std::invalid_argument("a wavelength density whose knots go back");
    const double both = static_cast<double>(density[i - 1]) + density[i];
    if (width > 0.0 && both > 0.0) {
      cells.push_back({knots[i - 1], width, 0.5 * width * both,
                       std::max(density[i - 1], density[i]), 2.0 * density[i - 1] / both});
    }
  }
  if (cells.empty()) throw std::invalid_argument("a wavelength density that is zero everywhere");
  return cells;
}

double area_of(const std::vector<Part>& parts) {
  double sum = 0.0;
  for (const Part& part : parts) sum += part.area;
  return sum;
}

// Neighbours that together are at most `little`, were their density everywhere what it is at most,
// become one.
std::vector<Part> together(const std::vector<Part>& cells, double little) {
  std::vector<Part> parts;
  for (const Part& cell : cells) {
    if (!parts.empty()) {
      Part& last = parts.back();
      const double width = last.width + cell.width;
      const double highest = std::max(last.highest, cell.highest);
      // No gap between them.
      const bool touch = static_cast<double>(last.knot) + last.width == cell.knot;
      if (touch && highest * width <= little) {
        last = {last.knot, width, last.area + cell.area, highest, 1.0};
        continue;
      }
    }
    parts.push_back(cell);
  }
  return parts;
}

// One for each part, the others by area, those that are left where most is missing.
std::vector<std::uint32_t> slices_of(const std::vector<Part>& parts, std::uint32_t count) {
  const double total = area_of(parts);
  std::vector<std::uint32_t> slices, order;
  std::vector<double> missing;
  std::uint32_t left = count;
  for (const Part& part : parts) {
    const double share = part.area / total;
    const double others = static_cast<double>(count) - static_cast<double>(parts.size());
    slices.push_back(1 + static_cast<std::uint32_t>(share * others));
    missing.push_back(share * count - slices.back());
    order.push_back(static_cast<std::uint32_t>(order.size()));
    left -= slices.back();
  }
  std::ranges::stable_sort(order, std::greater(), [&](std::uint32_t p) { return missing[p]; });
  for (std::uint32_t i = 0; i < left; ++i) ++slices[order[i]];
  return slices;
}

// Where a share of a part's area lies to the left, over its width; half of the last bit away from
// where a density of zero ends.
double place_of(double share, double low) {
  const double high = 2.0 - low;
  const double here = std::sqrt((1.0 - share) * low * low + share * high * high);
  return share > 0.0 ? std::min(1.0, 2.0 * share / (low + here)) : 0.0;
}

}  // namespace

WavelengthDensity::WavelengthDensity(const std::vector<float>& knots,
                                     const std::vector<float>& density) {
  const std::vector<Part> cells = cells_of(knots, density);
  const std::vector<Part> parts = together(cells, kLittle * area_of(cells));
  const std::uint32_t count =
      std::bit_ceil(std::max(kSlices, kSlicesOfPart * static_cast<std::uint32_t>(parts.size())));
  count_ = static_cast<float>(count);
  inverse_count_ = 1.0f / count_;
  quarter_ = count / kTogether;
  shift_ = static_cast<std::uint32_t>(std::bit_width(quarter_)) - 1;
  pieces_.resize(count);
  const std::vector<std::uint32_t> slices = slices_of(parts, count);
  std::uint32_t slice = 0;
  for (std::size_t p = 0; p < parts.size(); ++p) {
    const auto at = [&](std::uint32_t i) {
      return parts[p].width * place_of(static_cast<double>(i) / slices[p], parts[p].low);
    };
    for (std::uint32_t i = 0; i < slices[p]; ++i) {
      pieces_[place(slice++)] = {parts[p].knot, static_cast<float>(at(i)),
                                 static_cast<float>((at(i + 1) - at(i)) * count), 0.0f};
    }
  }
}

float WavelengthDensity::pdf(float nm) const {
  std::uint32_t low = 0, high = kTogether * quarter_;
  while (high - low > 1) {
    const std::uint32_t middle = low + (high - low) / 2;
    (begin(middle) <= static_cast<double>(nm) ? low : high) = middle;
  }
  const float width = pieces_[place(low)].inverse_density;
  const double inside = static_cast<double>(nm) - begin(low);
  return inside >= 0.0 && inside < static_cast<double>(width * inverse_count_) ? 1.0f / width
                                                                               : 0.0f;
}

}  // namespace nocturne
