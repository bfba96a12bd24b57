#include "sensors/wavelength_density.h"

#include <stdexcept>

namespace nocturne {

WavelengthDensity::WavelengthDensity(const std::vector<float>& knots,
                                     const std::vector<float>& density) {
  if (knots.size() < 2 || density.size() != knots.size()) {
    throw std::invalid_argument("a wavelength density needs two knots, and a value at each");
  }
  std::vector<double> sums{0.0};
  for (std::size_t i = 0; i < knots.size(); ++i) {
    if (!std::isfinite(knots[i]) || !std::isfinite(density[i]) || !(density[i] >= 0.0f)) {
      throw std::invalid_argument("a wavelength density that is negative or not finite");
    }
    if (i == 0) continue;
    const double width = static_cast<double>(knots[i]) - knots[i - 1];
    if (width < 0.0) throw std::invalid_argument("a wavelength density whose knots go back");
    sums.push_back(sums.back() + 0.5 * width * (static_cast<double>(density[i - 1]) + density[i]));
  }
  const double total = sums.back();
  if (!(total > 0.0)) throw std::invalid_argument("a wavelength density that is zero everywhere");
  for (std::size_t i = 0; i < knots.size(); ++i) {
    const double both =
        i + 1 < knots.size() ? static_cast<double>(density[i]) + density[i + 1] : 0.0;
    cells_.push_back({knots[i], static_cast<float>(sums[i] / total),
                      both > 0.0 ? static_cast<float>(2.0 * density[i] / both) : 1.0f});
  }
  cells_.back().before = 1.0f;

  // So many that hardly a draw looks further than at its slice's first cell.
  const std::size_t slices = 8 * (cells_.size() - 1);
  std::uint32_t cell = 0;
  for (std::size_t slice = 0; slice < slices; ++slice) {
    const float u = static_cast<float>(slice) / static_cast<float>(slices);
    while (cells_[cell + 1].before <= u) ++cell;
    guide_.push_back(cell);
  }
}

float WavelengthDensity::pdf(float nm) const {
  if (!(nm >= cells_.front().nm && nm < cells_.back().nm)) return 0.0f;
  const auto after = std::upper_bound(cells_.begin(), cells_.end(), nm,
                                      [](float at, const Cell& cell) { return at < cell.nm; });
  const Cell& cell = *(after - 1);
  const float width = after->nm - cell.nm;
  const float t = (nm - cell.nm) / width;
  return (after->before - cell.before) / width * (cell.low + t * 2.0f * (1.0f - cell.low));
}

}  // namespace nocturne
