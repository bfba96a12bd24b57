// Values on a grid, as a function of position: what a simulation of smoke or fire gives.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

#include "math/ray.h"
#include "media/float_grid.h"
#include "media/majorants.h"

namespace nocturne {

class GridField {
 public:
  /// `transform`: rows of the 3 x 4 matrix from the grid's own space to the scene. `scale`: factor
  /// of the values, not negative. Constant over voxels if `nearest`, else linear between their
  /// centres, which is where a voxel's index maps to. Throws std::invalid_argument.
  GridField(std::shared_ptr<const FloatGrid> grid, const std::array<double, 12>& transform,
            double scale, bool nearest);

  float at(Vec3 p) const { return at_index(to_index_ * Double3(p) + shift_); }
  /// At voxel coordinates.
  float at_index(Double3 x) const;

  const FloatGrid& grid() const { return *grid_; }
  float scale() const { return scale_; }
  const Matrix3& to_index() const { return to_index_; }
  Double3 shift() const { return shift_; }

 private:
  std::shared_ptr<const FloatGrid> grid_;
  // From the scene to voxels: matrix x position + shift.
  Matrix3 to_index_;
  Double3 shift_;
  // Beyond, all is background.
  Double3 low_, high_;
  float scale_;
  bool nearest_;
};

class GridMajorants;

class GridDensity {
 public:
  using Majorants = GridMajorants;

  /// Majorants are kept for cells of `cell` voxels a side, 8 times a power of two; larger ones
  /// where they would take more than an eighth of the grid's memory (or a megabyte).
  explicit GridDensity(GridField field, std::int64_t cell = 8);

  const GridField& field() const { return field_; }
  std::int64_t cell() const { return cell_; }

 private:
  friend class GridMajorants;

  void add(const FloatGrid::Block& block);
  void raise(const std::array<std::int64_t, 3>& first, const std::array<std::int64_t, 3>& last,
             float value);

  GridField field_;
  std::int64_t cell_;
  // Of cells: the first, and how many.
  std::array<std::int64_t, 3> first_, count_;
  // Most that the field can be in each cell, without its scale; x fastest.
  std::vector<float> majorant_;
};

/// Walks from cell to cell: Amanatides and Woo, "A Fast Voxel Traversal Algorithm for Ray Tracing",
/// Eurographics 1987.
///
/// Cells know of voxels one beyond those that they interpolate, so that bounds hold where positions
/// are rounded by less than a voxel.
class GridMajorants {
 public:
  /// `density` must outlive this.
  GridMajorants(const GridDensity& density, const Ray& ray, float end);
  float density(float distance) const {
    return density_->field().at(ray_.origin + distance * ray_.direction);
  }
  bool next(MajorantSegment& segment) {
    return empty_.next(segment, [this](MajorantSegment& s) { return advance(s); });
  }

 private:
  bool advance(MajorantSegment& segment);
  void enter(double t);
  void step();

  const GridDensity* density_;
  Ray ray_;
  float at_ = 0.0f, end_;
  // Where the ray is among the cells, and where it enters and leaves them.
  Double3 origin_, direction_;
  double in_, out_;
  std::array<std::int64_t, 3> where_{};
  std::array<double, 3> crossing_{};
  bool inside_ = false;
  EmptySpace empty_;
};

}  // namespace nocturne
