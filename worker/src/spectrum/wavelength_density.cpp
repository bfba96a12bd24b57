#include "spectrum/wavelength_density.h"

#include <algorithm>
#include <limits>
#include <optional>
#include <stdexcept>

namespace nocturne {
namespace {

// Between two knots, where there is anything.
struct ExactCell {
  std::uint32_t number;
  double knot, width, before, share, low;

  struct Point {
    double offset, inverse_density;  // nm; from the knot
  };
  Point at(double u) const {
    const double v = std::clamp((u - before) / share, 0.0, 1.0), high = 2.0 - low;
    const double here = std::sqrt((1.0 - v) * low * low + v * high * high);
    return {v > 0.0 ? width * std::min(1.0, 2.0 * v / (low + here)) : 0.0,
            here > 0.0 ? width / (share * here) : std::numeric_limits<double>::infinity()};
  }
};

std::vector<ExactCell> cells_of(const std::vector<float>& knots,
                                const std::vector<float>& density) {
  if (knots.size() < 2 || density.size() != knots.size()) {
    throw std::invalid_argument("a wavelength density needs two knots, and a value at each");
  }
  std::vector<ExactCell> cells;
  double sum = 0.0;
  for (std::size_t i = 0; i < knots.size(); ++i) {
    if (!std::isfinite(knots[i]) || !std::isfinite(density[i]) || !(density[i] >= 0.0f)) {
      throw std::invalid_argument("a wavelength density that is negative or not finite");
    }
    if (i == 0) continue;
    const double width = static_cast<double>(knots[i]) - knots[i - 1];
    if (width < 0.0) throw std::invalid_argument("a wavelength density whose knots go back");
    const double both = static_cast<double>(density[i - 1]) + density[i];
    const double area = 0.5 * width * both;
    if (!(area > 0.0)) continue;
    cells.push_back({static_cast<std::uint32_t>(i - 1), knots[i - 1], width, sum, area,
                     2.0 * density[i - 1] / both});
    sum += area;
  }
  if (cells.empty()) throw std::invalid_argument("a wavelength density that is zero everywhere");
  for (ExactCell& cell : cells) {
    cell.before /= sum;
    cell.share /= sum;
  }
  return cells;
}

// The one that a u above 0 ends in, or 0 begins in.
std::size_t cell_at(const std::vector<ExactCell>& cells, double u) {
  const auto after = std::ranges::lower_bound(cells, u, {}, &ExactCell::before);
  return after == cells.begin() ? 0 : static_cast<std::size_t>(after - cells.begin()) - 1;
}

struct Parabola {
  double knot, offset, slope, bend;
};

// Of the slice [begin, begin + width) of the unit interval; nothing where the inverse density
// is not nearly linear.
std::optional<Parabola> parabola(const std::vector<ExactCell>& cells, double begin, double width) {
  constexpr int kLooks = 8;
  const auto exact = [&](double u) { return cells[cell_at(cells, u)].at(u).inverse_density; };
  const ExactCell& last = cells[cell_at(cells, begin + width)];
  // What ends exactly at a knot goes on behind it.
  std::size_t first_cell = cell_at(cells, begin);
  if (first_cell + 1 < cells.size() && cells[first_cell + 1].before <= begin) ++first_cell;
  const ExactCell& first = cells[first_cell];
  const auto from = first.at(begin), to = last.at(begin + width);
  const double mean = (last.knot - first.knot + to.offset - from.offset) / width;
  const double bend = 0.5 * (to.inverse_density - from.inverse_density);
  const auto agrees = [&](double is, double asked) {
    return std::fabs(is - asked) <= WavelengthDensity::kSmooth * asked;
  };
  if (!agrees(mean - bend, from.inverse_density) || !agrees(mean + bend, to.inverse_density)) {
    return std::nullopt;
  }
  for (int i = 0; i < kLooks; ++i) {
    const double x = (i + 0.5) / kLooks;
    if (!agrees(mean + (2.0 * x - 1.0) * bend, exact(begin + x * width))) return std::nullopt;
  }
  return Parabola{first.knot, from.offset, mean - bend, bend / width};
}

}  // namespace

WavelengthDensity::WavelengthDensity(const std::vector<float>& knots,
                                     const std::vector<float>& density) {
  const std::vector<ExactCell> cells = cells_of(knots, density);
  double before = 0.0;
  for (std::size_t i = 0, next = 0; i < knots.size(); ++i) {
    const bool there = next < cells.size() && cells[next].number == i;
    cells_.push_back(
        {knots[i], static_cast<float>(before), there ? static_cast<float>(cells[next].low) : 1.0f});
    if (!there) continue;
    before = cells[next].before + cells[next].share;
    ++next;
  }
  // Behind the last cell that has anything.
  for (std::size_t i = cells.back().number + 1; i < cells_.size(); ++i) cells_[i].before = 1.0f;

  slices_.resize(kSlices);
  for (std::uint32_t slice = 0; slice < kSlices; ++slice) {
    const double begin = static_cast<double>(slice) / kSlices;
    const auto found = parabola(cells, begin, 1.0 / kSlices);
    slices_[place(slice)] =
        found ? Slice{static_cast<float>(found->knot), static_cast<float>(found->offset),
                      static_cast<float>(found->slope), static_cast<float>(found->bend)}
              : Slice::steep(cells[cell_at(cells, begin)].number);
  }
}

WavelengthDensity::Inverted WavelengthDensity::invert(float u, std::uint32_t cell) const {
  while (cells_[cell + 1].before <= u) ++cell;
  const Cell& here = cells_[cell];
  const float width = cells_[cell + 1].nm - here.nm, share = cells_[cell + 1].before - here.before;
  // Where the density falls to zero, half of the last bit away from it.
  const float v = std::clamp((u - here.before) / share, 0x1p-25f, 1.0f - 0x1p-24f);
  const float high = 2.0f - here.low;  // over the cell's mean
  const float root = std::sqrt((1.0f - v) * here.low * here.low + v * high * high);
  const float t = std::min(1.0f, 2.0f * v / (here.low + root));
  return {here.nm + t * width, width / (share * root)};
}

float WavelengthDensity::pdf(float nm) const {
  if (!(nm >= cells_.front().nm && nm < cells_.back().nm)) return 0.0f;
  const auto after = std::upper_bound(cells_.begin(), cells_.end(), nm,
                                      [](float at, const Cell& cell) { return at < cell.nm; });
  const Cell& cell = *(after - 1);
  const float width = after->nm - cell.nm, share = after->before - cell.before;
  const float t = (nm - cell.nm) / width;
  const float below = cell.before + share * t * (cell.low + t * (1.0f - cell.low));
  const auto number = std::min(static_cast<std::uint32_t>(below * kSlices), kSlices - 1);
  const Slice& slice = slices_[place(number)];
  if (slice.slope == 0.0f || share == 0.0f) {
    return share / width * (cell.low + t * 2.0f * (1.0f - cell.low));
  }
  const double x = std::max(0.0, static_cast<double>(nm) - static_cast<double>(slice.knot) -
                                     static_cast<double>(slice.offset));
  const double slope = slice.slope, bend = slice.bend;
  return static_cast<float>(1.0 / std::sqrt(slope * slope + 4.0 * bend * x));
}

}  // namespace nocturne
