// Density that depends on the altitude alone: air, haze, a layer of ozone, ground fog.
#pragma once

#include <cstddef>
#include <vector>

#include "math/ray.h"
#include "media/ground.h"
#include "media/majorants.h"

namespace nocturne {

class AltitudeMajorants;

class AltitudeDensity {
 public:
  using Majorants = AltitudeMajorants;

  /// exp(-altitude / scale_height), metres; held below -80 scale heights, where it is 5e34, and
  /// zero above 100, where it is 4e-44. The ground's `up` need not be a unit vector. Throws
  /// std::invalid_argument.
  static AltitudeDensity exponential(const Ground& ground, double scale_height);
  /// Linear between altitudes (metres, increasing, two at least), zero outside. Throws
  /// std::invalid_argument.
  static AltitudeDensity table(const Ground& ground, std::vector<double> altitudes,
                               std::vector<float> densities);

  float at(double altitude) const;

 private:
  friend class AltitudeMajorants;

  explicit AltitudeDensity(const Ground& ground);
  void add_layer(float majorant, double upper_edge);
  void add_space_above();
  float majorant_between(double low, double high) const;
  std::vector<std::size_t> layers_of_table(double tolerance) const;

  Ground ground_;
  // 0: a table.
  double scale_height_ = 0.0;
  std::vector<double> altitudes_;
  std::vector<float> densities_;
  // Layers of air, for bounds: layer i is between edges i - 1 and i, and holds at most
  // majorant_[i].
  std::vector<double> edges_;
  std::vector<float> majorant_;
};

/// Walks a ray from layer to layer.
class AltitudeMajorants {
 public:
  /// `end` may be infinite. `density` must outlive this.
  AltitudeMajorants(const AltitudeDensity& density, const Ray& ray, float end);
  /// By the altitude in double precision: far away, a position in single precision may be many
  /// scale heights off.
  float density(float distance) const {
    return density_->at(altitude_(static_cast<double>(distance)));
  }
  bool next(MajorantSegment& segment) {
    return empty_.next(segment, [this](MajorantSegment& s) { return advance(s); });
  }

 private:
  bool advance(MajorantSegment& segment);
  float way_out();
  float majorant_between(float from, float to) const;

  const AltitudeDensity* density_;
  AltitudeAlong altitude_;
  float at_ = 0.0f, end_;
  std::size_t layer_;
  bool rising_ = false;
  EmptySpace empty_;
};

}  // namespace nocturne
