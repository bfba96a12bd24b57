// Measured isotropic reflection, tabulated over half-vector and difference angles: Rusinkiewicz, "A
// New Change of Variables for Efficient BRDF Representation", EGWR 1998; spacing as in Matusik et
// al., "A Data-Driven Reflectance Model", SIGGRAPH 2003. The blob is specified in
// docs/how-to/measured-brdf.md.
//
// Between nodes the table is interpolated linearly in all three angles, and held beyond the last
// node. Directions are drawn from an even mixture: half vectors in proportion to the table's mean
// over wavelengths and difference angles, and the cosine, which reaches wherever the table does.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "kernels/ggx.h"
#include "kernels/kernel.h"

namespace nocturne {

class MeasuredTable {
 public:
  /// Eight nodes around a pair of directions, with their weights; the same for all planes.
  struct Nodes {
    std::array<std::uint32_t, 8> index;
    std::array<float, 8> weight;
  };
  /// A wavelength's share of planes.
  struct Planes {
    std::array<std::uint32_t, 3> plane;
    std::array<float, 3> weight;
  };

  /// Throws std::invalid_argument, in words, for anything but a table as specified. Takes memory
  /// only after the sizes are known to fit the blob.
  explicit MeasuredTable(std::span<const std::byte> blob);

  Planes planes(float wavelength_nm) const;
  /// Both above the surface.
  Nodes nodes(Vec3 wo, Vec3 wi) const;
  /// BRDF, 1/sr.
  float brdf(const Nodes& nodes, const Planes& planes) const;
  /// Share of the energy that is reflected, at most 1 and above 0 wherever brdf is.
  float albedo(float cosine, const Planes& planes) const;

  /// Of what even light along the normal brings to all directions, the part by half vectors whose
  /// slope against the normal is so much or less; 0 where nothing is reflected.
  double share_within(double slope) const;

  /// A half vector from the table's marginal, and its density per steradian.
  Vec3 sample_half(float u, float v) const;
  float half_pdf(Vec3 h) const;

 private:
  void read_marginal();
  void read_albedo();

  std::uint32_t n_theta_h_, n_theta_d_, n_phi_d_, n_planes_;
  std::size_t plane_size_;
  float first_nm_, inverse_step_;
  std::vector<float> values_;
  // Wavelengths x 3, for planes that are weights of basis spectra.
  std::vector<float> basis_;
  // Over cells of theta_h: probability up to the upper edge, 1 - cos of the edges, density.
  std::vector<float> cumulative_, edge_, density_;
  // Planes x cosines.
  std::vector<float> albedo_;
};

template <int N>
struct BoundMeasured {
  const MeasuredTable* table;
  std::array<MeasuredTable::Planes, N> planes;

  Spectral<N> albedo(Vec3 wo) const {
    return of_each([&](const auto& p) { return table->albedo(wo.z, p); });
  }
  Spectral<N> value(Vec3 wo, Vec3 wi) const {
    if (wi.z <= 0.0f) return 0.0f;
    const auto nodes = table->nodes(wo, wi);
    return of_each([&](const auto& p) { return wi.z * table->brdf(nodes, p); });
  }
  std::optional<Draw<N>> sample(Vec3 wo, const KernelNumbers& numbers, std::size_t) const {
    if (numbers.part < 0.5f) return Draw<N>{.wi = CosineHemisphere::sample(numbers.u, numbers.v)};
    const Vec3 h = table->sample_half(numbers.u, numbers.v);
    if (dot(wo, h) <= 0.0f) return std::nullopt;
    const Vec3 wi = normalized(reflected(wo, h));
    if (wi.z <= 0.0f) return std::nullopt;
    return Draw<N>{.wi = wi};
  }
  Spectral<N> pdf(Vec3 wo, Vec3 wi) const {
    if (wi.z <= 0.0f) return 0.0f;
    const Vec3 h = half_vector(wo, wi);
    const float facing = dot(wo, h);
    const float half = facing > 0.0f ? table->half_pdf(h) / (4.0f * facing) : 0.0f;
    return 0.5f * (half + CosineHemisphere::pdf(wi));
  }
  static constexpr bool smooth() { return true; }
  static constexpr bool transmits() { return false; }

 private:
  template <class F>
  Spectral<N> of_each(const F& f) const {
    Spectral<N> r;
    for (std::size_t i = 0; i < N; ++i) r[i] = f(planes[i]);
    return r;
  }
};
static_assert(BoundKernel<BoundMeasured<1>, 1> && BoundKernel<BoundMeasured<4>, 4>);

struct Measured {
  /// Not null; shared by all kernels of the same blob.
  std::shared_ptr<const MeasuredTable> table;

  static constexpr bool has_delta_lobe() { return false; }
  static constexpr bool may_transmit() { return false; }

  template <int N>
  BoundMeasured<N> bind(const Shading<N>& shading) const& {
    BoundMeasured<N> bound;
    bound.table = table.get();
    for (std::size_t i = 0; i < N; ++i) bound.planes[i] = table->planes(shading.wavelengths[i]);
    return bound;
  }
  /// The bound kernel points into the table.
  template <int N>
  BoundMeasured<N> bind(const Shading<N>&) const&& = delete;
};

}  // namespace nocturne
