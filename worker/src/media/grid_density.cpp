#include "media/grid_density.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <utility>

namespace nocturne {
namespace {

constexpr double kNever = std::numeric_limits<double>::infinity();

bool finite(Double3 v) { return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z); }

Double3 as_double3(const std::array<std::int64_t, 3>& v, double more) {
  return {static_cast<double>(v[0]) + more, static_cast<double>(v[1]) + more,
          static_cast<double>(v[2]) + more};
}

std::array<double, 3> coordinates(Double3 v) { return {v.x, v.y, v.z}; }

// Rounded down; c > 0.
std::int64_t floor_divided(std::int64_t a, std::int64_t c) {
  return a >= 0 ? a / c : -((c - 1 - a) / c);
}

// Cells of size c to which voxels from a to b belong: those that interpolate them, or a neighbour.
struct Span {
  std::int64_t first, last;
};
Span cells_of(std::int64_t a, std::int64_t b, std::int64_t c) {
  return {floor_divided(a - 2, c), floor_divided(b + 1, c)};
}

float mix(float a, float b, float t) { return a + t * (b - a); }

}  // namespace

GridField::GridField(std::shared_ptr<const FloatGrid> grid, const std::array<double, 12>& transform,
                     double scale, bool nearest)
    : grid_(std::move(grid)), scale_(static_cast<float>(scale)), nearest_(nearest) {
  if (!(scale >= 0.0) || !std::isfinite(scale_ * grid_->majorant())) {
    throw std::invalid_argument("a scale of a grid that is negative, or too large for its values");
  }
  const auto& m = transform;
  const Matrix3 linear{{m[0], m[1], m[2]}, {m[4], m[5], m[6]}, {m[8], m[9], m[10]}};
  const Double3 moved{m[3], m[7], m[11]};
  const Matrix3 from_grid = grid_->matrix();
  const auto column = [&](Double3 axis) { return linear * (from_grid * axis); };
  const Matrix3 to_scene =
      Matrix3{column({1, 0, 0}), column({0, 1, 0}), column({0, 0, 1})}.transposed();
  to_index_ = to_scene.inverse();
  shift_ = -1.0 * (to_index_ * (linear * grid_->shift() + moved));
  if (!finite(to_index_.x) || !finite(to_index_.y) || !finite(to_index_.z) || !finite(shift_)) {
    throw std::invalid_argument("a grid with a transform that has no inverse");
  }
  low_ = as_double3(grid_->box().low, -1.0);
  high_ = as_double3(grid_->box().high, 1.0);
}

float GridField::at_index(Double3 x) const {
  const bool inside = x.x > low_.x && x.y > low_.y && x.z > low_.z && x.x < high_.x &&
                      x.y < high_.y && x.z < high_.z;
  if (!inside) return grid_->background() * scale_;
  if (nearest_) x = x + Double3(0.5, 0.5, 0.5);
  const Double3 whole{std::floor(x.x), std::floor(x.y), std::floor(x.z)};
  const int i = static_cast<int>(whole.x), j = static_cast<int>(whole.y),
            k = static_cast<int>(whole.z);
  if (nearest_) return grid_->value(i, j, k) * scale_;
  const Vec3 t = (x - whole).rounded();
  const std::array<float, 8> v = grid_->corners(i, j, k);
  return mix(mix(mix(v[0], v[1], t.z), mix(v[2], v[3], t.z), t.y),
             mix(mix(v[4], v[5], t.z), mix(v[6], v[7], t.z), t.y), t.x) *
         scale_;
}

GridDensity::GridDensity(GridField field, std::int64_t cell)
    : field_(std::move(field)), cell_(cell) {
  const FloatGrid& grid = field_.grid();
  const FloatGrid::Box& box = grid.box();
  const std::size_t most_cells = std::max(std::size_t{1} << 20, grid.size() / 8) / sizeof(float);
  for (;; cell_ *= 2) {
    double cells = 1.0;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const Span span = cells_of(box.low[axis], box.high[axis], cell_);
      first_[axis] = span.first;
      count_[axis] = span.last - span.first + 1;
      cells *= static_cast<double>(count_[axis]);
    }
    if (cells <= static_cast<double>(most_cells)) break;
  }
  majorant_.assign(static_cast<std::size_t>(count_[0] * count_[1] * count_[2]), grid.background());
  grid.for_each_block([this](const FloatGrid::Block& block) { add(block); });
}

void GridDensity::add(const FloatGrid::Block& block) {
  const float background = field_.grid().background();
  if (block.values == nullptr) {
    if (block.value <= background) return;
    std::array<std::int64_t, 3> first, last;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const Span span = cells_of(block.origin[axis], block.origin[axis] + block.size - 1, cell_);
      first[axis] = span.first;
      last[axis] = span.last;
    }
    raise(first, last, block.value);
    return;
  }
  if (*std::max_element(block.values, block.values + 512) <= background) return;
  // All voxels belong to the cell around them; the first two and the last also to a neighbour.
  struct Part {
    int from, to;
  };
  constexpr std::array<Part, 3> kParts{Part{0, 1}, Part{0, 7}, Part{7, 7}};
  std::array<std::array<std::int64_t, 3>, 3> cells;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const std::int64_t o = block.origin[axis];
    cells[axis] = {cells_of(o, o, cell_).first, floor_divided(o, cell_),
                   cells_of(o + 7, o + 7, cell_).last};
  }
  for (std::size_t n = 0; n < 27; ++n) {
    const std::array<std::size_t, 3> part{n / 9, n / 3 % 3, n % 3};
    std::array<std::int64_t, 3> cell;
    bool own = false;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      cell[axis] = cells[axis][part[axis]];
      own |= part[axis] != 1 && cell[axis] == cells[axis][1];
    }
    if (own) continue;
    float majorant = background;
    for (int x = kParts[part[0]].from; x <= kParts[part[0]].to; ++x) {
      for (int y = kParts[part[1]].from; y <= kParts[part[1]].to; ++y) {
        for (int z = kParts[part[2]].from; z <= kParts[part[2]].to; ++z) {
          majorant = std::max(majorant, block.values[x << 6 | y << 3 | z]);
        }
      }
    }
    raise(cell, cell, majorant);
  }
}

void GridDensity::raise(const std::array<std::int64_t, 3>& first,
                        const std::array<std::int64_t, 3>& last, float value) {
  for (std::int64_t z = first[2] - first_[2]; z <= last[2] - first_[2]; ++z) {
    for (std::int64_t y = first[1] - first_[1]; y <= last[1] - first_[1]; ++y) {
      for (std::int64_t x = first[0] - first_[0]; x <= last[0] - first_[0]; ++x) {
        float& majorant = majorant_[static_cast<std::size_t>((z * count_[1] + y) * count_[0] + x)];
        majorant = std::max(majorant, value);
      }
    }
  }
}

GridMajorants::GridMajorants(const GridDensity& density, const Ray& ray, float end)
    : density_(&density), ray_(ray), end_(end), in_(0.0), out_(static_cast<double>(end)) {
  const GridField& field = density.field_;
  const double size = 1.0 / static_cast<double>(density.cell_);
  origin_ = size * (field.to_index() * Double3(ray.origin) + field.shift()) -
            as_double3(density.first_, 0.0);
  direction_ = size * (field.to_index() * Double3(ray.direction));
  const auto o = coordinates(origin_), d = coordinates(direction_);
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const auto count = static_cast<double>(density.count_[axis]);
    if (d[axis] == 0.0) {
      if (o[axis] < 0.0 || o[axis] > count) out_ = -1.0;
      continue;
    }
    const double a = -o[axis] / d[axis], b = (count - o[axis]) / d[axis];
    in_ = std::fmax(in_, std::fmin(a, b));
    out_ = std::fmin(out_, std::fmax(a, b));
  }
}

// The cell at t, and where its sides are crossed.
void GridMajorants::enter(double t) {
  inside_ = true;
  const auto o = coordinates(origin_), d = coordinates(direction_);
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const std::int64_t last = density_->count_[axis] - 1;
    const double here = std::clamp(o[axis] + t * d[axis], 0.0, static_cast<double>(last));
    where_[axis] = static_cast<std::int64_t>(here);
    const double side = static_cast<double>(where_[axis] + (d[axis] > 0.0 ? 1 : 0));
    crossing_[axis] = d[axis] == 0.0 ? kNever : (side - o[axis]) / d[axis];
  }
}

void GridMajorants::step() {
  const auto next =
      static_cast<std::size_t>(std::ranges::min_element(crossing_) - crossing_.begin());
  const auto o = coordinates(origin_), d = coordinates(direction_);
  where_[next] += d[next] > 0.0 ? 1 : -1;
  if (where_[next] < 0 || where_[next] >= density_->count_[next]) {
    out_ = -1.0;
    return;
  }
  const double side = static_cast<double>(where_[next] + (d[next] > 0.0 ? 1 : 0));
  crossing_[next] = (side - o[next]) / d[next];
}

bool GridMajorants::advance(MajorantSegment& segment) {
  if (!(at_ < end_)) return false;
  const float scale = density_->field_.scale();
  const float outside = density_->field_.grid().background() * scale;
  if (!inside_ && in_ < out_) {
    enter(in_);
    const auto in = static_cast<float>(in_);
    if (in > at_) {
      at_ = std::min(in, end_);
      segment = {at_, outside};
      return true;
    }
  }
  while (in_ < out_) {
    const auto& n = density_->count_;
    const auto index = static_cast<std::size_t>((where_[2] * n[1] + where_[1]) * n[0] + where_[0]);
    const double t = std::min({crossing_[0], crossing_[1], crossing_[2], out_});
    const auto to = static_cast<float>(t);
    if (t >= out_) {
      out_ = -1.0;
    } else {
      step();
    }
    if (to <= at_) continue;
    at_ = std::min(to, end_);
    segment = {at_, density_->majorant_[index] * scale};
    return true;
  }
  at_ = end_;
  segment = {end_, outside};
  return true;
}

}  // namespace nocturne
