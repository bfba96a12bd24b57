// The immutable scene that all threads of a worker share.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "kernels/any_kernel.h"
#include "luminaires/light_sampler.h"
#include "luminaires/luminaire.h"
#include "luminaires/photon_emitter.h"
#include "luminaires/widened_lamps.h"
#include "math/functions.h"
#include "media/medium.h"
#include "sampling/sequence.h"
#include "scene/bump_map.h"
#include "scene/interior_list.h"
#include "scene/tracing_options.h"
#include "sensors/sensor.h"
#include "sensors/wavelengths.h"
#include "surfaces/geometry.h"

namespace nocturne {

/// What a surface, or a medium where it is hit, is made of: indices into the scene's lists, or
/// kNone.
struct SurfaceMaterial {
  static constexpr std::uint32_t kNone = ~0u;
  /// For photons from the side that the normal points to, and from the other.
  std::uint32_t front_kernel = 0, back_kernel = 0;
  std::uint32_t luminaire = kNone;
  std::uint32_t interior = kNone;
  /// The interior whose index and `outside` are on its two sides, whatever is around: it bounds no
  /// body.
  std::uint32_t boundary = kNone;
  std::uint32_t bump_map = kNone;
  /// One of its kernels has a delta lobe, or it bounds a body and may be no boundary at all,
  /// between equal indices or within a body of higher priority: photons may pass or be mirrored.
  bool has_delta_lobe = false;
  /// Photons may go through.
  bool may_pass = false;
  /// Something is so close to it that single precision does not resolve which comes first
  /// (contacts.h).
  bool close = false;
  /// Bounds an index-matched body and does nothing else.
  bool index_matched_only = false;
  /// Something depends on texture coordinates, tangents or shading normals.
  bool needs_detail = false;
};

/// The bodies that samples of a sensor start inside of (bodies_around.h); `differ`: not all may.
struct SensorSurroundings {
  InteriorList inside;
  bool differ = false;
};
/// The same of photons from the two sides of a luminaire, by its normal.
struct LuminaireSurroundings {
  InteriorList in_front, behind;
  bool differ = false;
};

struct Scene {
  Geometry geometry;
  /// By surface; then by medium, as a hit on a medium is one on its own surface.
  std::vector<SurfaceMaterial> materials;
  std::vector<AnyKernel> kernels;
  std::vector<Interior> interiors;
  std::vector<Medium> media;
  std::vector<BumpMap> bump_maps;
  std::vector<Luminaire> luminaires;
  LightSampler lights;
  /// Empty unless the direction is forward.
  PhotonEmitter emitter;
  Sensor sensor;
  WavelengthSampler wavelengths;
  TracingOptions options;
  /// Bodies that are around all else, the sensor, and each luminaire.
  InteriorList everywhere;
  SensorSurroundings sensor_around;
  std::vector<LuminaireSurroundings> luminaires_around;
  /// Nothing between a vertex and a light can let light through, and all luminaires are elements of
  /// `lights`: a photon towards lights needs to know only whether it is occluded. Light by mirrors
  /// is left to photons from kernels.
  bool shadow_rays_suffice = false;
  /// Holds all that photons can end at, where unbounded fog hides everything beyond it.
  std::optional<Geometry::Ball> all_in_fog;
  /// By kernel: whether it is specular-like (load_kernels.h). What scatters light closer to the
  /// sensor than near_ends, m, is left to photons from there, and so closer to a luminaire. For
  /// Direction::kBoth.
  std::vector<bool> specular_like;
  /// Whether any kernel is a mirror, or has one as the coat of paint has: then forward photons
  /// bring something in addition to adjoint ones.
  bool has_mirrors = false;
  float near_ends = 0.0f;
  /// For a pilot that counts the lamps that photons nearly meet.
  WidenedLamps widened_lamps = {};
  /// Photons know how light is polarised: a filter is there, or the sensor asks.
  bool polarised = false;

  bool has_distant_light() const { return lights.environment() || !lights.discs().empty(); }

  /// Radiance of a luminaire at a hit, towards `direction`.
  template <int N>
  Spectral<N> emitted(const Luminaire& luminaire, const Hit& hit, Vec3 direction, float time,
                      const Spectral<N>& wavelengths_nm) const {
    return luminaire.emitted(hit.normal, direction, point_of(luminaire, hit, time), wavelengths_nm);
  }
  /// Whether there is any, at whichever wavelengths.
  bool emits(const Luminaire& luminaire, const Hit& hit, Vec3 direction, float time) const {
    return luminaire.emits(hit.normal, direction, point_of(luminaire, hit, time));
  }

  /// Radiance that arrives from outside all surfaces, from `direction`.
  template <int N>
  Spectral<N> distant_radiance(Vec3 direction, const Spectral<N>& wavelengths_nm) const {
    return distant_radiance(direction, wavelengths_nm, [](HiddenFrom) { return false; });
  }
  /// Along a direction that was drawn towards light.
  template <int N>
  Spectral<N> distant_radiance(const LightSampler::LightSample& light,
                               const Spectral<N>& wavelengths_nm) const {
    if (!light.environment) return distant_radiance(light.direction, wavelengths_nm);
    return with_discs(lights.environment()->radiance(*light.environment, wavelengths_nm),
                      light.direction, wavelengths_nm, [](HiddenFrom) { return false; });
  }
  /// Without that for which `sees_past`, of a HiddenFrom, is true; its place in the environment for
  /// those who know.
  template <int N, class SeesPast>
  Spectral<N> distant_radiance(Vec3 direction, const Spectral<N>& wavelengths_nm,
                               const SeesPast& sees_past,
                               const LightSampler::SkyTexel& place = {}) const {
    const auto& environment = lights.environment();
    Spectral<N> around = 0.0f;
    if (environment && !sees_past(environment->hidden_from)) {
      around = place ? environment->radiance(*place, wavelengths_nm)
                     : environment->radiance(direction, wavelengths_nm);
    }
    return with_discs(around, direction, wavelengths_nm, sees_past);
  }
  /// More of it, from discs.
  template <int N, class SeesPast>
  Spectral<N> with_discs(Spectral<N> radiance, Vec3 direction, const Spectral<N>& wavelengths_nm,
                         const SeesPast& sees_past) const {
    for (const DistantDisc& disc : lights.discs()) {
      if (!sees_past(disc.hidden_from)) radiance += disc.radiance(direction, wavelengths_nm);
    }
    return radiance;
  }
  /// f(light group, radiance) for each source of what distant_radiance has together. `place` in the
  /// environment, as a SkyTexel or as it was drawn, or none.
  template <int N, class SeesPast, class Place, class F>
  void for_each_distant_group(Vec3 direction, const Spectral<N>& wavelengths_nm,
                              const SeesPast& sees_past, const std::optional<Place>& place,
                              const F& f) const {
    const auto& environment = lights.environment();
    if (environment && !sees_past(environment->hidden_from)) {
      f(environment->light_group, place ? environment->radiance(*place, wavelengths_nm)
                                        : environment->radiance(direction, wavelengths_nm));
    }
    for (const DistantDisc& disc : lights.discs()) {
      if (sees_past(disc.hidden_from)) continue;
      f(disc.light_group, disc.radiance(direction, wavelengths_nm));
    }
  }
  /// Of the luminaire on a surface.
  HiddenFrom hidden_from(std::uint32_t surface) const {
    const std::uint32_t luminaire = materials[surface].luminaire;
    return luminaire == SurfaceMaterial::kNone ? HiddenFrom::kNobody
                                               : luminaires[luminaire].hidden_from;
  }

  /// Where a hit is on a luminaire's texture.
  SurfacePoint point_of(const Luminaire& luminaire, const Hit& hit, float time) const {
    SurfacePoint point;
    if (luminaire.textured()) {
      const SurfaceDetail detail = geometry.detail(hit, time);
      point = {detail.u, detail.v, 0.0f};
    }
    return point;
  }

  std::uint32_t surface_of(std::size_t medium) const {
    return static_cast<std::uint32_t>(materials.size() - media.size() + medium);
  }
  const Medium& medium(std::uint32_t surface) const { return media[surface - surface_of(0)]; }
  bool is_medium(std::uint32_t surface) const { return surface >= surface_of(0); }

  /// The transmittance over `distance` metres in the bodies that are there (Beer, Lambert,
  /// Bouguer); their media are not part of it.
  template <int N>
  Spectral<N> transmittance(const InteriorList& inside, float distance,
                            const Spectral<N>& wavelengths_nm) const {
    Spectral<N> left = 1.0f;
    inside.for_each_present(interiors, [&](const Interior& body) {
      if (!body.absorbs) return;
      left *= each([distance](float a) { return math::exp(-a * distance); },
                   body.absorption(wavelengths_nm));
    });
    return left;
  }
};

}  // namespace nocturne
