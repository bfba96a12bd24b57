#include "luminaires/environment_map.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <numbers>
#include <stdexcept>
#include <utility>

#include "math/constants.h"
#include "math/functions.h"

namespace nocturne {
namespace {

constexpr int kVisibleFirst = 380, kVisibleLast = 780;  // nm

// Windows are whole strips: at least so many, and of at most so many columns.
constexpr std::uint32_t kStrips = 32, kWidestStrip = 32;

// The spectrum's mean in bands of 20 nm, so that no line in it goes unseen.
struct Bands {
  static constexpr int kCount = 20, kWidth = (kVisibleLast - kVisibleFirst) / kCount;
  static constexpr int kTogether = 4;
  std::array<float, kCount> mean;

  explicit Bands(const Spectrum& spectrum) {
    for (int i = 0; i < kCount; ++i) {
      const int first = kVisibleFirst + i * kWidth;
      mean[static_cast<std::size_t>(i)] =
          static_cast<float>(spectrum.mean_between(first, first + kWidth));
    }
  }

  float mean_radiance(const EnvironmentMap::Texel& texel) const {
    if (texel.scale == 0.0f) return 0.0f;
    const SigmoidSpectrum shape{texel.c0, texel.c1, texel.c2};
    float sum = 0.0f;
    for (int first = 0; first < kCount; first += kTogether) {
      Spectral<kTogether> centres;
      for (int k = 0; k < kTogether; ++k) {
        centres[static_cast<std::size_t>(k)] =
            static_cast<float>(kVisibleFirst + (first + k) * kWidth) + 0.5f * kWidth;
      }
      const Spectral<kTogether> shapes = shape(centres);
      for (int k = 0; k < kTogether; ++k) {
        sum += shapes[static_cast<std::size_t>(k)] * mean[static_cast<std::size_t>(first + k)];
      }
    }
    return texel.scale * sum / kCount;
  }
};

void check(const EnvironmentMap::Texel& t) {
  if (!(t.scale >= 0.0f) || !std::isfinite(t.scale) || !std::isfinite(t.c0) ||
      !std::isfinite(t.c1) || !std::isfinite(t.c2)) {
    throw std::invalid_argument("a texel of the environment map is negative or not finite");
  }
}

void check(const EnvironmentMap::Axes& a) {
  const auto small = [](float x) { return std::fabs(x) < 1e-4f; };
  if (!small(dot(a.x, a.x) - 1.0f) || !small(dot(a.y, a.y) - 1.0f) ||
      !small(dot(a.z, a.z) - 1.0f) || !small(dot(a.x, a.y)) || !small(dot(a.y, a.z)) ||
      !small(dot(a.z, a.x))) {
    throw std::invalid_argument("the axes of the environment map are not orthonormal");
  }
}

// The largest i in [low, high) with sum(i) <= target, for a sum that does not decrease.
template <class Sum>
std::uint32_t bisect(std::uint32_t low, std::uint32_t high, std::uint64_t target, const Sum& sum) {
  while (high - low > 1) {
    const std::uint32_t middle = low + (high - low) / 2;
    (sum(middle) <= target ? low : high) = middle;
  }
  return low;
}

// Sums are far below 2^63, where signed numbers take one instruction.
double number_of(std::uint64_t sum) { return static_cast<double>(static_cast<std::int64_t>(sum)); }

EnvironmentMap::Target target_of(float u, std::uint64_t total) {
  const double exact = u * number_of(total);
  const auto whole = static_cast<std::uint64_t>(static_cast<std::int64_t>(exact));
  return {exact, std::min(whole, total - 1)};
}

// Where it is in the cell that it fell into.
double inside(const EnvironmentMap::Target& target, std::uint64_t before, std::uint64_t cell) {
  return std::clamp((target.exact - number_of(before)) / number_of(cell), 0.0, 1.0);
}

}  // namespace

EnvironmentMap::EnvironmentMap(std::uint32_t columns, std::uint32_t rows, std::vector<Texel> texels,
                               Spectrum spectrum, Axes axes)
    : columns_(columns),
      rows_(rows),
      strip_columns_(std::clamp(std::bit_floor(columns / kStrips), 1u, kWidestStrip)),
      strips_((columns + strip_columns_ - 1) / strip_columns_),
      texels_(std::move(texels)),
      spectrum_(std::move(spectrum)),
      axes_(axes),
      row_height_(2.0 / rows),
      column_width_(2.0 * std::numbers::pi / columns),
      texels_per_steradian_(0.25 * std::numbers::inv_pi * columns * rows),
      guide_of_columns_(columns),
      guide_of_rows_(rows) {
  if (columns == 0 || rows == 0 || columns > kMaxColumns || rows > kMaxRows) {
    throw std::invalid_argument("the environment map has no texels, or more than 8192 x 4096");
  }
  if (texels_.size() != std::size_t{columns} * rows) {
    throw std::invalid_argument("the environment map's texels are not columns x rows");
  }
  check(axes_);
  const Bands bands(spectrum_);
  std::vector<float> means;
  means.reserve(texels_.size());
  for (const Texel& texel : texels_) {
    check(texel);
    means.push_back(bands.mean_radiance(texel));
  }
  sum_up(means);
}

void EnvironmentMap::sum_up(const std::vector<float>& means) {
  double total = 0.0;
  for (const float mean : means) total += mean;
  mean_radiance_ = total / static_cast<double>(means.size());
  const double scale = total > 0.0 ? 0x1p61 / total : 0.0;
  left_.reserve(std::size_t{rows_} * (columns_ + 1));
  sums_.assign(std::size_t{rows_ + 1} * (strips_ + 1), 0);
  sums_of_rows_.assign(1, 0);
  for (std::size_t row = 0; row < rows_; ++row) {
    const std::uint64_t* above = &sums_[row * (strips_ + 1)];
    std::uint64_t* below = &sums_[(row + 1) * (strips_ + 1)];
    std::uint64_t sum = 0;
    for (std::size_t column = 0; column < columns_; ++column) {
      if (column % strip_columns_ == 0) {
        below[column / strip_columns_] = above[column / strip_columns_] + sum;
      }
      left_.push_back(sum);
      const float mean = means[row * columns_ + column];
      if (mean > 0.0f) sum += std::max<std::uint64_t>(1, static_cast<std::uint64_t>(mean * scale));
    }
    left_.push_back(sum);
    guide_of_columns_.add(left_of(static_cast<std::uint32_t>(row)));
    below[strips_] = above[strips_] + sum;
    sums_of_rows_.push_back(below[strips_]);
  }
  guide_of_rows_.add(sums_of_rows_.data());
}

// The row of the window that the number falls into.
std::uint32_t EnvironmentMap::row_at(const Window& w, std::uint64_t target) const {
  if (w.strips != strips_) {
    const auto above = [&](std::uint32_t row) { return weight({w.row0, row, w.strip0, w.strips}); };
    return bisect(w.row0, w.row1, target, above);
  }
  const std::uint64_t from_top = target + sums_of_rows_[w.row0];
  return CutpointTable::find(guide_of_rows_.range(0, sums_of_rows_[rows_], from_top),
                             sums_of_rows_.data(), from_top);
}

EnvironmentMap::Place EnvironmentMap::place_of(Vec3 direction) const {
  const Vec3 in_map = to_map(direction);
  const float row = 0.5f * (1.0f - in_map.z) * static_cast<float>(rows_);
  const float turn = math::atan2(in_map.y, in_map.x) * (0.5f * kInvPi);
  const float column = (turn < 0.0f ? turn + 1.0f : turn) * static_cast<float>(columns_);
  return {std::min(static_cast<std::uint32_t>(std::max(row, 0.0f)), rows_ - 1),
          std::min(static_cast<std::uint32_t>(column), columns_ - 1)};
}

// The hemisphere above a tilted plane reaches in z from -sin(tilt) to the pole. Only for a vertical
// plane is it narrower than all around in azimuth, and half a turn then.
EnvironmentMap::Window EnvironmentMap::window(const LightSamplingContext& from) const {
  Window window{0, rows_, 0, strips_};
  if (from.both_sides) return window;
  const Vec3 n = to_map(from.normal);
  const float level = std::sqrt(n.x * n.x + n.y * n.y) + 1e-5f;
  const auto row_of = [&](float z) { return 0.5f * (1.0f - z) * static_cast<float>(rows_); };
  if (n.z > 0.0f && level < 1.0f) {
    window.row1 = std::min(rows_, static_cast<std::uint32_t>(row_of(-level)) + 1);
  } else if (n.z < 0.0f && level < 1.0f) {
    window.row0 = std::min(rows_ - 1, static_cast<std::uint32_t>(row_of(level)));
  }
  // What such a plane sees beyond the half turn has a cosine of at most 1e-6: nothing, in float.
  if (std::fabs(n.z) <= 1e-6f && columns_ >= 8) {
    const float turn = math::atan2(n.y, n.x) * (0.5f * kInvPi) - 0.25f - 1e-5f;
    const float first = (turn - std::floor(turn)) * static_cast<float>(columns_);
    const std::uint32_t column0 = std::min(static_cast<std::uint32_t>(first), columns_ - 1);
    // Whole ones, both rims and the margin.
    const std::uint32_t last = column0 + columns_ / 2 + 2;
    window.strip0 = column0 / strip_columns_;
    const std::uint32_t last_strip =
        last < columns_ ? last / strip_columns_ : strips_ + (last - columns_) / strip_columns_;
    window.strips = std::min(last_strip + 1 - window.strip0, strips_);
    if (window.strips == strips_) window.strip0 = 0;
  }
  return window;
}

EnvironmentMap::PartialSample EnvironmentMap::begin(const LightSamplingContext& from, float u1,
                                                    float u2) const {
  PartialSample draft{};
  const Window w = window(from);
  draft.total = weight(w);
  if (draft.total == 0) return draft;
  const Target down = target_of(u1, draft.total);
  draft.row = row_at(w, down.whole);
  const std::uint64_t above = weight({w.row0, draft.row, w.strip0, w.strips});
  const std::uint64_t row_weight = weight({draft.row, draft.row + 1, w.strip0, w.strips});
  draft.z = 1.0 - row_height_ * (draft.row + inside(down, above, row_weight));

  // From the map's edge, around the back if need be.
  draft.across = target_of(u2, row_weight);
  const std::uint64_t* left = left_of(draft.row);
  draft.before = w.strip0 == 0 ? 0 : left[w.strip0 * strip_columns_];
  const std::uint64_t all = sums_of_rows_[draft.row + 1] - sums_of_rows_[draft.row];
  draft.around = draft.across.whole + draft.before >= all ? all : 0;
  const std::uint64_t from_edge = draft.across.whole + draft.before - draft.around;
  draft.columns = guide_of_columns_.range(draft.row, all, from_edge);
  __builtin_prefetch(left + draft.columns.first + draft.columns.count / 2);
  return draft;
}

std::optional<EnvironmentMap::Drawn> EnvironmentMap::finish(const LightSamplingContext& from,
                                                            const PartialSample& draft) const {
  if (draft.total == 0) return std::nullopt;
  const std::uint64_t* left = left_of(draft.row);
  const std::uint32_t column =
      CutpointTable::find(draft.columns, left, draft.across.whole + draft.before - draft.around);
  const std::uint32_t texel = number({draft.row, column});
  __builtin_prefetch(&texels_[texel]);
  const std::uint64_t share = left[column + 1] - left[column];

  const double in_texel = inside(draft.across, left[column] + draft.around - draft.before, share);
  const auto phi = static_cast<float>(column_width_ * (column + in_texel));
  const double r = std::sqrt(std::max(0.0, (1.0 - draft.z) * (1.0 + draft.z)));
  const Vec3 direction = static_cast<float>(r) * math::cos(phi) * axes_.x +
                         static_cast<float>(r) * math::sin(phi) * axes_.y +
                         static_cast<float>(draft.z) * axes_.z;
  if (!from.sees(direction)) return std::nullopt;
  return Drawn{direction, density(share, draft.total), texel};
}

float EnvironmentMap::density(std::uint64_t share, std::uint64_t total) const {
  return static_cast<float>(number_of(share) / number_of(total) * texels_per_steradian_);
}

float EnvironmentMap::pdf(const LightSamplingContext& from, Vec3 direction, Place place) const {
  if (!from.sees(direction)) return 0.0f;
  const Window w = window(from);
  if (place.row < w.row0 || place.row >= w.row1) return 0.0f;
  const std::uint32_t strip = place.column / strip_columns_;
  const std::uint32_t turned = strip + (strip < w.strip0 ? strips_ : 0);
  if (turned - w.strip0 >= w.strips) return 0.0f;
  const std::uint64_t total = weight(w);
  if (total == 0) return 0.0f;
  const std::uint64_t* left = left_of(place.row) + place.column;
  return density(left[1] - left[0], total);
}

}  // namespace nocturne
