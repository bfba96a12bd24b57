// Spectral lines: triangles over wavelength, as a monochromator's slit makes them. At a distance d
// from its centre a line of power P (integral, the spectrum's unit times nm) and full width at half
// maximum w has P / w (1 - |d| / w), and nothing from w on.
#pragma once

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <vector>

namespace nocturne {

struct Line {
  float centre_nm, power, width_nm;
};

class Lines {
 public:
  /// Single precision has 16 wavelengths over so narrow a line.
  static constexpr float kMinWidth = 1e-3f;

  Lines() = default;

  /// In any order. Throws std::invalid_argument where a width is below kMinWidth, a power is
  /// negative or what a line rises to is not finite.
  explicit Lines(const std::vector<Line>& lines) {
    for (const Line& line : lines) {
      const float height = line.power / line.width_nm;
      if (!std::isfinite(line.centre_nm) || !(line.width_nm >= kMinWidth) ||
          !std::isfinite(line.width_nm) || !(height >= 0.0f) || !std::isfinite(height)) {
        throw std::invalid_argument(
            "a spectral line that is narrower than 0.001 nm, negative or not finite");
      }
      widest_ = std::max(widest_, line.width_nm);
      triangles_.push_back({line.centre_nm, height, 1.0f / line.width_nm});
    }
    std::sort(triangles_.begin(), triangles_.end(),
              [](const Triangle& a, const Triangle& b) { return a.centre < b.centre; });
  }

  bool empty() const { return triangles_.empty(); }

  /// Sum of all lines.
  float operator()(float nm) const {
    const auto before = [](const Triangle& line, float at) { return line.centre < at; };
    float sum = 0.0f;
    for (auto line = std::lower_bound(triangles_.begin(), triangles_.end(), nm - widest_, before);
         line != triangles_.end() && line->centre < nm + widest_; ++line) {
      sum +=
          line->height * std::max(0.0f, 1.0f - std::fabs(nm - line->centre) * line->inverse_width);
    }
    return sum;
  }

  /// From `first` to `last`, nm; exact.
  double integral(double first, double last) const {
    double sum = 0.0;
    for (const Triangle& line : triangles_) {
      sum += line.height / line.inverse_width * (line.share_below(last) - line.share_below(first));
    }
    return sum;
  }

 private:
  struct Triangle {
    float centre, height, inverse_width;

    double share_below(double nm) const {
      const double x = std::clamp((nm - centre) * inverse_width, -1.0, 1.0);
      return x < 0.0 ? 0.5 * (1.0 + x) * (1.0 + x) : 1.0 - 0.5 * (1.0 - x) * (1.0 - x);
    }
  };

  std::vector<Triangle> triangles_;  // by centre
  float widest_ = 0.0f;
};

}  // namespace nocturne
