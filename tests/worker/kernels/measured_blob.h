// Tables for the tests of measured reflection, as docs/how-to/measured-brdf.md lays them out.
#pragma once

#include <cmath>
#include <cstdint>
#include <cstring>
#include <functional>
#include <memory>
#include <numbers>
#include <vector>

#include "kernels/measured.h"

namespace nocturne::test {

struct MeasuredBlob {
  std::uint32_t n_theta_h = 90, n_theta_d = 90, n_phi_d = 2, n_planes = 1, n_basis = 0;
  float first_nm = 400.0f, step_nm = 300.0f;
  std::uint32_t version = 1;
  std::vector<float> basis;
  /// Value at angles and plane.
  std::function<double(double theta_h, double theta_d, double phi_d, std::uint32_t plane)> f;

  std::vector<std::byte> bytes() const {
    std::vector<std::byte> out;
    const auto put = [&](const void* from, std::size_t size) {
      const auto* p = static_cast<const std::byte*>(from);
      for (std::size_t i = 0; i < size; ++i) out.push_back(p[i]);
    };
    put("NOCTBRDF", 8);
    for (const std::uint32_t n : {version, n_theta_h, n_theta_d, n_phi_d, n_planes, n_basis})
      put(&n, 4);
    put(&first_nm, 4);
    put(&step_nm, 4);
    put(basis.data(), basis.size() * 4);
    for (std::uint32_t p = 0; p < n_planes; ++p) {
      for (std::uint32_t i = 0; i < n_theta_h; ++i) {
        for (std::uint32_t j = 0; j < n_theta_d; ++j) {
          for (std::uint32_t k = 0; k < n_phi_d; ++k) {
            const double x = static_cast<double>(i) / n_theta_h;
            const auto value = static_cast<float>(f(0.5 * std::numbers::pi * x * x,
                                                    0.5 * std::numbers::pi * j / n_theta_d,
                                                    std::numbers::pi * k / n_phi_d, p));
            put(&value, 4);
          }
        }
      }
    }
    return out;
  }
  Measured kernel() const { return {std::make_shared<const MeasuredTable>(bytes())}; }
};

/// A lobe around the half vector over a diffuse floor; darker in the second plane.
inline MeasuredBlob glossy_blob() {
  MeasuredBlob blob;
  blob.n_planes = 2;
  blob.f = [](double theta_h, double, double, std::uint32_t plane) {
    return (0.05 + 2.0 * std::exp(-std::pow(theta_h / 0.1, 2))) / (1.0 + plane);
  };
  return blob;
}

}  // namespace nocturne::test
