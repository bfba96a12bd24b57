// Henyey and Greenstein's phase function, "Diffuse radiation in the Galaxy", Astrophysical Journal
// 93, 1941, equation 2: (1 - g^2) / (4 pi (1 + g^2 - 2 g cos)^(3/2)); and a sum of two.
#pragma once

#include <cmath>
#include <stdexcept>

#include "kernels/kernel.h"
#include "kernels/scattering_angle.h"

namespace nocturne {

class HenyeyGreenstein {
 public:
  /// Mean cosine g in (-1, 1); 0 is isotropic. Throws std::invalid_argument.
  explicit HenyeyGreenstein(double g)
      : size_(static_cast<float>(std::fabs(g))),
        gap_(static_cast<float>(1.0 - std::fabs(g))),
        backward_(g < 0.0) {
    if (!(std::fabs(g) < 1.0)) throw std::invalid_argument("a mean cosine g outside (-1, 1)");
  }

  /// 1/sr.
  float density(const ScatteringAngle& angle) const {
    const float off = backward_ ? angle.more : angle.less;
    // Of (1 - |g|)^2 + 2 |g| (1 - |cos|), which is the denominator without cancellation.
    const float root = std::sqrt(gap_ * gap_ + 2.0f * size_ * off);
    // In this order nothing underflows.
    return 0.25f * kInvPi * (1.0f + size_) * (gap_ / root) / root / root;
  }

  /// By inversion; free of cancellation, and right for g = 0.
  ScatteringAngle sample(const KernelNumbers& numbers) const {
    const float q = gap_ + 2.0f * size_ * (1.0f - numbers.u);
    const float root = gap_ * (1.0f + size_) / q;
    const auto angle =
        ScatteringAngle::from_less(std::fmin(2.0f, gap_ * numbers.u * (root + gap_) / q));
    return backward_ ? angle.reversed() : angle;
  }

  template <int N>
  HenyeyGreenstein bind(const Shading<N>&) const& {
    return *this;
  }

 private:
  // |g| and 1 - |g|.
  float size_, gap_;
  bool backward_;
};

class DoubleHenyeyGreenstein {
 public:
  /// `weight` in [0, 1], of the first; the remainder to 1, of the second. Throws
  /// std::invalid_argument.
  DoubleHenyeyGreenstein(double g_first, double g_second, double weight)
      : first_(g_first), second_(g_second), weight_(static_cast<float>(weight)) {
    if (!(weight >= 0.0 && weight <= 1.0)) {
      throw std::invalid_argument("a weight of a phase function outside [0, 1]");
    }
  }

  float density(const ScatteringAngle& angle) const {
    return weight_ * first_.density(angle) + (1.0f - weight_) * second_.density(angle);
  }
  ScatteringAngle sample(const KernelNumbers& numbers) const {
    return (numbers.part < weight_ ? first_ : second_).sample(numbers);
  }

  template <int N>
  DoubleHenyeyGreenstein bind(const Shading<N>&) const& {
    return *this;
  }

 private:
  HenyeyGreenstein first_, second_;
  float weight_;
};

}  // namespace nocturne
