// Photons that leave the luminaires, distributed over area and direction as the luminaires emit:
// where forward tracing starts (Morley et al. 2006, section 2). A luminaire is chosen in proportion
// to an estimate of its flux.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "luminaires/distant_disc.h"
#include "luminaires/distant_start.h"
#include "luminaires/environment.h"
#include "luminaires/light_sampler.h"
#include "luminaires/luminaire.h"
#include "luminaires/ray_set.h"
#include "sampling/sequence.h"
#include "surfaces/geometry.h"

namespace nocturne {

/// Where a photon leaves, and the flux that a group carries: its mean over emissions is the flux of
/// all luminaires at each wavelength, W/nm.
template <int N>
struct Emitted {
  static constexpr std::uint32_t kDistant = ~0u, kRays = kDistant - 1;

  Ray ray;
  Departure departure;
  Spectral<N> flux;
  /// Index of the luminaire, kDistant, or kRays: light that starts as given rays.
  std::uint32_t luminaire;
  /// Of the luminaire there, W m-2 sr-1 nm-1.
  Spectral<N> radiance;
  /// Of what emits it.
  std::uint32_t light_group;
  /// The point of a luminaire, as if it had been hit.
  Hit from{};
};

class PhotonEmitter {
 public:
  /// Of a mesh, as Hit names it.
  struct Triangle {
    std::uint32_t instance, primitive;
  };

  /// Corners or centres at equally spaced times over the shutter, at least one.
  void add_triangle(std::uint32_t luminaire, const Luminaire& what,
                    std::vector<std::array<Vec3, 3>> corners, Triangle triangle);
  /// `sphere`: as it stands in the scene or, shown by instance `instance` of `geometry`, in its
  /// group; there it may be an ellipsoid.
  void add_sphere(std::uint32_t luminaire, const Luminaire& what, const Sphere& sphere,
                  const Geometry& geometry, std::uint32_t instance = Hit::kNoInstance);
  void add_rays(RaySet rays) { rays_.push_back(std::move(rays)); }
  /// After the last element and set of rays. `bounds` is about as large as what distant light is
  /// emitted towards, or it is emitted towards `gathering` alone: with photons from the sensor too,
  /// those of luminaires bring what mirrors and glass gather first. Photons start in proportion to
  /// flux; where `each_group` is told apart, half of them in proportion to it within light groups
  /// that have as many each, as a dim group would get none.
  void finish(const LightSampler& lights, Geometry::Ball bounds, bool each_group = false,
              std::optional<Geometry::Ball> gathering = {});

  /// Time in [0, 1]; eight uniform numbers. The part `aimed` of the photons, in [0, 1), is
  /// drawn towards the important shapes of `lights`, and all carry what that changes. `lit` holds
  /// all that photons are to reach: distant light is emitted from a disc of its size, outside it.
  /// Empty where nothing is emitted from the drawn place.
  template <int N>
  std::optional<Emitted<N>> emit(std::span<const Luminaire> luminaires, const LightSampler& lights,
                                 const Geometry& geometry, const Geometry::Ball& lit, float aimed,
                                 float time, const Spectral<N>& wavelengths_nm, const Uniform4& a,
                                 const Uniform4& b) const {
    if (cumulative_.empty()) return std::nullopt;
    const auto [chosen, probability, rest] = choose(a[2], a[3]);
    const std::size_t near = elements_.size() + rays_.size();
    if (chosen >= near) {
      return emit_distant<N>(chosen - near, lights.discs(), lights.environment(), lit, aimed,
                             wavelengths_nm, {a[0], a[1], a[2], rest}, b, probability);
    }
    if (chosen >= elements_.size()) {
      const RaySet& rays = rays_[chosen - elements_.size()];
      const Spectral<N> flux = (1.0f / probability) * rays.flux(wavelengths_nm);
      return Emitted<N>{rays.draw(a[0], a[1], b[0]), {},   flux,
                        Emitted<N>::kRays,           flux, rays.light_group};
    }
    const Element& element = elements_[chosen];
    const Luminaire& luminaire = luminaires[element.luminaire];
    const bool back = luminaire.two_sided() && rest < 0.5f;
    const float sides = luminaire.two_sided() ? 2.0f : 1.0f;
    auto [from, area] = point_on(element, geometry, time, a[0], a[1]);
    from.surface = luminaire.surface;
    const Vec3 normal = back ? -from.normal : from.normal;
    const auto leaving = leave({from.position, normal, false, time}, lights.important(), aimed, b);
    if (!leaving) return std::nullopt;
    const Vec3 direction = leaving->direction;
    // Radiance x cosine over the density of the direction x 1/area x 1/sides.
    const float scale = leaving->cosine_over_pdf * area * sides / probability;
    const DepartingRay leaves = geometry.depart(from, direction, time);
    const Spectral<N> radiance =
        luminaire.emitted(from.normal, direction, SurfacePoint{}, wavelengths_nm);
    return Emitted<N>{leaves.ray,
                      leaves.departure,
                      scale * radiance,
                      element.luminaire,
                      radiance,
                      luminaire.light_group,
                      from};
  }

 private:
  struct Element {
    std::uint32_t luminaire;
    /// At the first time, m2.
    float area;
    /// Three corners for each time step.
    std::vector<Vec3> corners;
    /// Or a sphere.
    std::optional<Sphere> sphere;
    /// Of a sphere the instance alone.
    Triangle triangle;
  };

  struct Leaving {
    Vec3 direction;
    float cosine_over_pdf;
  };
  /// As a Lambertian surface emits, or towards an important shape; by the density of both.
  static std::optional<Leaving> leave(const LightSamplingContext& from,
                                      const AreaLightSampler& important, float aimed,
                                      const Uniform4& u);

  struct Choice {
    std::size_t index;
    float probability;
    /// The remainder of the two numbers, uniform in [0, 1).
    float rest;
  };
  /// By two uniform numbers, as one float alone has steps that are wider than the share of a weak
  /// luminaire next to a strong one.
  Choice choose(float coarse, float fine) const;
  /// A point, and the element's area at that time, m2: motion may change it.
  struct EmissionPoint {
    Hit hit;
    float area;
  };
  static EmissionPoint point_on(const Element& element, const Geometry& geometry, float time,
                                float u, float v);
  static EmissionPoint point_on_sphere(const Element& element, const Geometry& geometry, float time,
                                       float u, float v);
  void add(Element element, const Luminaire& what);
  void add(double flux, std::uint32_t light_group);

  template <int N>
  std::optional<Emitted<N>> emit_distant(std::size_t which, std::span<const DistantDisc> discs,
                                         const std::optional<Environment>& environment,
                                         const Geometry::Ball& lit, float aimed,
                                         const Spectral<N>& wavelengths_nm, const Uniform4& a,
                                         const Uniform4& b, float probability) const {
    Vec3 towards;
    float pdf;
    Spectral<N> radiance;
    std::uint32_t light_group;
    if (which < discs.size()) {
      light_group = discs[which].light_group;
      towards = discs[which].sample(a[0], a[1]);
      pdf = discs[which].pdf(towards);
      radiance = discs[which].radiance(towards, wavelengths_nm);
    } else {
      const auto drawn = environment->draw_all_around(a[0], a[1]);
      if (!drawn) return std::nullopt;
      towards = drawn->direction;
      pdf = drawn->pdf;
      radiance = environment->radiance(*drawn, wavelengths_nm);
      light_group = environment->light_group;
    }
    if (!(pdf > 0.0f)) return std::nullopt;
    const DistantStart::Start start = distant_start_.sample(towards, lit, aimed, b);
    return Emitted<N>{
        {start.origin, -towards}, {},       (1.0f / (start.pdf * pdf * probability)) * radiance,
        Emitted<N>::kDistant,     radiance, light_group};
  }

  std::vector<Element> elements_;
  std::vector<RaySet> rays_;
  // Only while building.
  std::vector<double> fluxes_;
  std::vector<std::uint32_t> groups_;
  std::vector<double> cumulative_;  // elements, rays, discs, environment
  DistantStart distant_start_;
};

}  // namespace nocturne
