// The tracing loop, for both directions: from the sensor to the luminaires, counting light, and
// from the luminaires to the sensor, counting what meets it. Morley et al., "Image Synthesis using
// Adjoint Photons", GI 2006, sections 2 to 4; groups and the two photons at a vertex:
// docs/decisions/0010 and 0011.
#pragma once

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>
#include <type_traits>

#include "tracer/fixed_stack.h"
#include "tracer/free_flight.h"
#include "tracer/group.h"
#include "tracer/vertex.h"

namespace nocturne {

/// How a group of photons starts.
template <int N>
struct Start {
  Ray ray;
  /// nm.
  Spectral<N> wavelengths;
  /// Bodies that it starts inside of.
  InteriorList inside;
  /// Of the shutter, [0, 1].
  float time = 0.0f;
  /// Footprint, for the sharpness of textures: width at the start, m, and growth per metre.
  float width = 0.0f, spread = 0.0f;
};

/// Follows a group of photons until all are absorbed or out of the scene. They share their numbers,
/// and so every decision that does not depend on the wavelength; where one differs they part.
///
/// Photons in both directions: light whose last interaction before a diffuse-like one, which the
/// camera sees first (or whatever lies between the two), is specular-like is brought by photons
/// from the luminaires, which are connected to the camera wherever they meet what is diffuse-like
/// after their first, specular-like interaction; all other light is found from the camera
/// (docs/decisions/0032). What passes straight through a pane or a mask is as if it were not there,
/// but for the camera.
///
/// PathEstimator has kTransport; connect(place, u, v) and reaches(group, way) if forward photons
/// are to be sent to the sensor; flies(group, hit), called for every ray with the nearest hit or
/// none, before the body on the way absorbs; arrives(group, hit) for a surface and glows(group,
/// hit) for a medium, called after.
///
/// A scene without media is walked without a thought of them: Media says which.
template <int N, class PathEstimator, bool Media>
class Walk {
 public:
  Walk(const Scene& scene, const Start<N>& start, PathEstimator& estimator)
      : scene_(scene),
        options_(scene.options),
        wavelengths_(start.wavelengths),
        time_(start.time),
        spread_(start.spread),
        both_(scene.options.direction == Direction::kBoth),
        estimator_(estimator),
        flight_(scene, start.wavelengths) {}

  /// Returns the number of rays cast.
  std::uint32_t run(const Start<N>& start, const PhotonSequence& sequence) {
    Group<N> group{.ray = start.ray,
                   .weight = 1.0f,
                   .inside = start.inside,
                   .depth = 0,
                   .collisions = 0,
                   .width = start.width,
                   .mis = {},
                   .sequence = sequence};
    follow(group);
    return rays_;
  }

 private:
  static constexpr bool kAdjoint = PathEstimator::kTransport == Transport::kAdjoint;
  static constexpr bool kToCamera = requires(PathEstimator & estimator, Vec3 place) {
    estimator.connect(place, 0.0f, 0.0f);
  };

  struct NoFlight {
    NoFlight(const Scene&, const Spectral<N>&) {}
  };
  using Flight = std::conditional_t<Media, FreeFlight<N>, NoFlight>;

  // What can wait at once: for each vertex that splits two branches, and the members of each that
  // part.
  using Waiting = FixedStack<Group<N>, N*(2 * TracingOptions::kMaxSplitVertices + 2)>;

  // To the end of a group and of all that it leaves behind.
  void follow(Group<N>& group) {
    const std::size_t before = waiting_.size();
    for (;;) {
      while (step(group)) {
      }
      if (waiting_.size() == before) return;
      group = waiting_.pop();
    }
  }

  // To the next surface and off it; false where the group ends.
  bool step(Group<N>& group) {
    const auto vertex = next_vertex(group);
    return vertex && leave_vertex(group, *vertex);
  }

  bool leave_vertex(Group<N>& group, const Vertex<N>& vertex) {
    return visit_bound<N>(scene_.kernels, vertex.kernel, vertex.shading, [&](const auto& kernel) {
      if constexpr (kAdjoint) {
        if (group.mis.technique == MisTechnique::kLights) return pass_on(group, vertex, kernel);
      }
      return scatter(group, vertex, kernel);
    });
  }

  // Media up to the nearest surface, if there is one; a medium that is hit takes its place.
  void fly(Group<N>& group, std::optional<Hit>& hit) {
    if (!flight_.enter(group.inside)) return;
    const float end = hit ? hit->distance : std::numeric_limits<float>::max();
    if constexpr (kToCamera) {
      sent_ = group.specular_like && flight_.thin(group, end);
      if (sent_) {
        connect_from_media(group, end);
        flight_.enter(group.inside);  // the way to the camera leads elsewhere
      }
    }
    if (group.mis.technique == MisTechnique::kLights) {
      flight_.pass(group, end);
    } else if (kAdjoint && group.depth == 0 && options_.estimator == Estimator::kTwoPhotons &&
               flight_.thin(group, end)) {
      part_in_media(group, end);
    } else if (const auto collision = flight_.collide(group, end)) {
      hit = collision;
      ++group.collisions;
    }
  }

  // To the camera from thin media without waiting for a collision there, which would seldom be;
  // what collides on the way is not sent again.
  void connect_from_media(const Group<N>& group, float end) {
    Group<N> met = group;
    const auto vertex = collide_surely(met, end);
    if (!vertex) return;
    visit_bound<N>(scene_.kernels, vertex->kernel, vertex->shading,
                   [&](const auto& kernel) { connect_to_camera(met, *vertex, kernel); });
  }

  // A sensor's photons meet thin media and what is behind them, too: one group collides, the other
  // passes, and each carries its part.
  void part_in_media(Group<N>& group, float end) {
    Group<N> met = group;
    const auto vertex = collide_surely(met, end);
    flight_.pass(group, end);
    if (vertex && leave_vertex(met, *vertex)) follow(met);
  }

  // Where a copy of a group in thin media meets them, its weight being the probability of that;
  // empty where there is nothing to meet, or it has gone deep enough.
  std::optional<Vertex<N>> collide_surely(Group<N>& met, float end) {
    met.sequence = met.sequence.branch(2);
    const auto hit = flight_.force(met, end);
    if (!hit || !(largest(met.weight) > 0.0f)) return std::nullopt;
    travel(met, *hit);
    ++met.collisions;
    if (met.depth++ - met.passes == options_.max_depth) return std::nullopt;
    return make_vertex(scene_, *hit, {}, met, wavelengths_, time_, PathEstimator::kTransport);
  }

  // From the surface that a group left. Its ray is the one from there, moved off the surface: how
  // much sooner it meets the next one depends on how that stands, as in a wedge.
  float way_to(const Group<N>& group, const Hit& hit) const {
    constexpr float kMinCosine = 1e-3f;
    const float cosine = dot(hit.normal, group.ray.direction);
    if (hit.clearance == 0.0f || std::fabs(cosine) < kMinCosine) {
      return hit.distance + group.skipped;
    }
    return std::max(0.0f, hit.distance + dot(group.step, hit.normal) / cosine);
  }

  bool is_medium(const Hit& hit) const {
    if constexpr (Media) return scene_.is_medium(hit.surface);
    return false;
  }

  // What the bodies around it leave of a group.
  void absorb(Group<N>& group, float way) const {
    group.weight *= scene_.transmittance(group.inside, way, wavelengths_);
  }

  // Up to a hit; what the estimator looks for there is counted.
  void travel(Group<N>& group, const Hit& hit) {
    if (!group.inside.empty()) absorb(group, way_to(group, hit));
    group.width += spread_ * hit.distance;
    if (is_medium(hit)) {
      estimator_.glows(group, hit);
    } else {
      estimator_.arrives(group, hit);
    }
  }

  // The nearest surface that is seen; empty where the group leaves the scene or has gone deep
  // enough. What the estimator looks for on the way is counted.
  std::optional<Vertex<N>> next_vertex(Group<N>& group) {
    for (;;) {
      ++rays_;
      auto hit = scene_.geometry.intersect(group.ray, time_);
      if constexpr (Media) fly(group, hit);
      const Contacts contacts = hit ? contacts_of(scene_, group.ray, time_, *hit) : Contacts();
      estimator_.flies(group, hit);
      if (!hit) return std::nullopt;
      travel(group, *hit);
      if (ends_here(group, *hit)) return std::nullopt;
      auto vertex = make_vertex(scene_, *hit, contacts, group, wavelengths_, time_,
                                PathEstimator::kTransport);
      if (vertex) {
        // At the limit light still goes straight on, which does not count.
        if (group.depth++ - group.passes == options_.max_depth &&
            !scene_.materials[hit->surface].has_delta_lobe) {
          return std::nullopt;
        }
        return vertex;
      }
      pass_index_matched(group, *hit, contacts);
    }
  }

  // Most photons that went towards lights end without another look at the surface.
  bool ends_here(const Group<N>& group, const Hit& hit) const {
    return group.mis.technique == MisTechnique::kLights &&
           !scene_.materials[hit.surface].has_delta_lobe;
  }

  // Inside a body radiance is n^2 times what it is outside, and the photon's weight as much less:
  // it is worth what it will be outside.
  Spectral<N> square_of_index(const InteriorList& inside) const {
    const std::uint32_t body = inside.current(scene_.medium_interfaces);
    if (body == InteriorList::kOutside) return 1.0f;
    const Spectral<N> n = scene_.medium_interfaces[body].index(wavelengths_);
    return n * n;
  }

  void pass_index_matched(Group<N>& group, const Hit& hit, const Contacts& contacts) const {
    const bool front = dot(hit.normal, group.ray.direction) < 0.0f;
    group.inside = boundary_at(scene_, hit, contacts, group.inside, front).beyond;
    start_off(group, hit, group.ray.direction);
  }

  // What absorbs begins at the surface.
  static void start_off(Group<N>& group, const Hit& hit, Vec3 direction) {
    group.ray = {leave_surface(hit, direction), direction};
    if (group.inside.empty()) return;
    group.skipped = way_skipped(hit, direction);
    group.step = group.ray.origin - hit.position;
  }

  // From within glass no light lies where it seems to. A surface that spreads light in there may
  // still stand before one in the same glass; a medium has too many vertices to try at each.
  bool may_see_lights(const Group<N>& group, const Vertex<N>& vertex) const {
    return !is_medium(vertex.hit) ||
           group.inside.current(scene_.medium_interfaces) == InteriorList::kOutside;
  }

  // In fog without end that absorbs little, photons would wander for ever. From a distance r one
  // flight meets a ball of radius R with (R / r)^2, and a long walk with R / r. At the latter its
  // expected length were endless still, as a walk to r takes r^2 flights.
  float chance_to_stay(const Group<N>& group, Vec3 position) const {
    const auto& [centre, radius] = *scene_.all_in_fog;
    const Vec3 away = position - centre;
    return std::min(1.0f, largest(group.weight) * radius * radius / dot(away, away));
  }

  // What the interaction that a group leaves by makes of it; false where the other direction has
  // all that could come of it. A specular-like kernel is so whichever of its lobes is drawn.
  bool keep_in_partition(Group<N>& group, const Vertex<N>& vertex, Vec3 wi, bool delta) const {
    const bool specular_like = scene_.specular_like[vertex.kernel];
    const bool straight = delta && !specular_like && wi == -vertex.wo;
    if constexpr (kAdjoint) {
      if (group.depth == 1)
        group.diffuse_like_first = !delta && !specular_like && !too_near(vertex);
      if (!straight) group.specular_like = specular_like;
      return !(group.diffuse_like_first && specular_like &&
               group.mis.technique == MisTechnique::kLights);
    } else {
      if (!straight && !group.specular_like) group.specular_like = specular_like;
      return straight || group.specular_like;
    }
  }

  bool too_near(const Vertex<N>& vertex) const {
    return scene_.sensor.distance_from(vertex.hit.position, time_) < scene_.near_sensor;
  }

  // A photon from a luminaire to the camera; whatever is in between stops it.
  template <class Kernel>
  void connect_to_camera(const Group<N>& group, const Vertex<N>& vertex, const Kernel& kernel) {
    if (!group.specular_like || scene_.specular_like[vertex.kernel] || !kernel.smooth()) return;
    if (too_near(vertex)) return;
    PhotonSequence sequence = group.sequence.branch(1);
    const Uniform4 u = sequence.next();
    const auto way = estimator_.connect(vertex.hit.position, u[0], u[1]);
    if (!way) return;
    const Vec3 wi = vertex.to_local(way->direction);
    if (wi.z <= 0.0f && !kernel.transmits()) return;
    Group<N> photon = group;
    photon.sequence = sequence;
    photon.weight *= kernel.value(vertex.wo, wi);
    if (leave(photon, vertex, wi) && gets_to(photon, way->distance)) {
      estimator_.reaches(photon, *way);
    }
  }

  // Straight on through all that is not seen; false where something else is met before.
  bool gets_to(Group<N>& group, float left) {
    for (;;) {
      ++rays_;
      auto hit = scene_.geometry.intersect(group.ray, time_);
      if (hit && hit->distance >= left) hit.reset();
      if constexpr (Media) {
        if (flight_.enter(group.inside)) flight_.pass(group, hit ? hit->distance : left);
      }
      if (!group.inside.empty()) absorb(group, hit ? way_to(group, *hit) : left + group.skipped);
      if (!hit) return true;
      const Contacts contacts = contacts_of(scene_, group.ray, time_, *hit);
      if (make_vertex(scene_, *hit, contacts, group, wavelengths_, time_,
                      PathEstimator::kTransport)) {
        return false;
      }
      pass_index_matched(group, *hit, contacts);
      left -= hit->distance;
    }
  }

  template <class Kernel>
  bool scatter(Group<N>& group, const Vertex<N>& vertex, const Kernel& kernel) {
    const Uniform4 u = group.sequence.next();
    // The paper's survival probability is H h. Times the weight that the photon carries, light
    // photons die and heavy ones stay (docs/decisions/0004-roulette-by-weight.md). One probability
    // for the group: it stays together as long as one of them is worth it.
    float survival = 1.0f;
    if (group.depth > options_.roulette_after) {
      Spectral<N> albedo = kernel.albedo(vertex.wo);
      if (kAdjoint && !group.inside.empty()) albedo *= square_of_index(group.inside);
      survival = std::min(1.0f, options_.h * largest(options_.roulette_by_weight
                                                         ? albedo * group.weight
                                                         : only(albedo, alive(group.weight))));
    }
    if (group.depth - group.collisions > TracingOptions::kManyBounces) {
      survival = std::min(survival, TracingOptions::kSurvivalOfMany);
    }
    if constexpr (Media) {
      if (scene_.all_in_fog) {
        survival = std::min(survival, chance_to_stay(group, vertex.hit.position));
      }
    }
    const KernelNumbers numbers{u[3], u[0], u[1]};
    if constexpr (kAdjoint) {
      const bool two_photons = options_.estimator == Estimator::kTwoPhotons && kernel.smooth() &&
                               !scene_.lights.empty() && may_see_lights(group, vertex);
      if (two_photons) next_event_estimation(group, vertex, kernel, survival);
      if (u[2] >= survival) return false;
      if (options_.estimator == Estimator::kTwoPhotons || !kernel.smooth()) {
        return draw_from_kernel(group, vertex, kernel, numbers, survival, two_photons);
      }
      if (options_.estimator == Estimator::kSplit && group.depth <= options_.split_vertices) {
        return split(group, vertex, kernel, numbers, survival);
      }
      // What is left of the number is uniform once more.
      return draw_from_mixture(group, vertex, kernel, numbers, u[2] / survival, survival);
    } else {
      if constexpr (kToCamera) {
        if (!(sent_ && is_medium(vertex.hit))) connect_to_camera(group, vertex, kernel);
      }
      if (u[2] >= survival) return false;
      return draw_from_kernel(group, vertex, kernel, numbers, survival, false);
    }
  }

  // A draw for each photon of the group; those that draw the same go on together, the others wait.
  // `weigh` multiplies the weights by value over density. A phase function that depends on the
  // wavelength turns all alike, and moves the path pdf ratios with the weights.
  template <class Kernel, class Weigh>
  bool for_each_draw(Group<N>& group, const Vertex<N>& vertex, const Kernel& kernel,
                     const KernelNumbers& numbers, const Weigh& weigh) {
    const std::uint32_t all = alive(group.weight);
    for (std::uint32_t left = all; left != 0;) {
      const auto lead = static_cast<std::size_t>(std::countr_zero(left));
      const auto draw = kernel.sample(vertex.wo, numbers, lead);
      const std::uint32_t together = draw ? draw->together & left : 1u << lead;
      left &= ~together;
      if (!draw) continue;
      if constexpr (N > 1 && requires { kernel.likelihood(vertex.wo, draw->wi); }) {
        group.path_pdf_ratio *= kernel.likelihood(vertex.wo, draw->wi);
      }
      if (together == all) {
        weigh(group, *draw);
        return leave(group, vertex, draw->wi, draw->delta);
      }
      Group<N> part = group;
      part.weight = only(group.weight, together);
      weigh(part, *draw);
      if (leave(part, vertex, draw->wi, draw->delta)) waiting_.push(part);
    }
    return false;
  }

  bool leave(Group<N>& group, const Vertex<N>& vertex, Vec3 wi, bool delta = false) const {
    if (!(largest(group.weight) > 0.0f)) return false;
    if (both_ && !keep_in_partition(group, vertex, wi, delta)) return false;
    // What passes straight through a pane or a hole has met nothing.
    if (delta && wi == -vertex.wo) {
      ++group.passes;
    } else if (group.depth - group.passes > options_.max_depth) {
      return false;
    }
    const Vec3 direction = vertex.to_world(wi);
    const float cosine = dot(vertex.normal, direction);
    // A medium has no sides, and turns one of 2^24 photons to go exactly across.
    if (!is_medium(vertex.hit)) {
      // Where a shading normal says one side and the surface the other, nothing goes on.
      if (cosine * wi.z <= 0.0f) return false;
      if (cosine < 0.0f) group.inside = vertex.beyond;
      if constexpr (!kAdjoint) {
        // A shading normal is not symmetric: flux is scaled by the cosines that radiance is not.
        // Veach, "Robust Monte Carlo Methods for Light Transport Simulation", 1997, eq. 5.19.
        group.weight *= Spectral<N>(
            std::fabs(cosine * vertex.wo.z / (dot(vertex.normal, group.ray.direction) * wi.z)));
      }
    }
    start_off(group, vertex.hit, direction);
    return true;
  }

  template <class Kernel>
  static Vec3 uniform_sample(const Kernel& kernel, float u, float v) {
    return kernel.transmits() ? UniformSphere::sample(u, v) : UniformHemisphere::sample(u, v);
  }
  template <class Kernel>
  static float uniform_pdf(const Kernel& kernel, Vec3 wi) {
    return kernel.transmits() ? UniformSphere::pdf() : UniformHemisphere::pdf(wi);
  }

  // One photon from the kernel alone. Where another goes towards lights, lights found are shared.
  template <class Kernel>
  bool draw_from_kernel(Group<N>& group, const Vertex<N>& vertex, const Kernel& kernel,
                        const KernelNumbers& numbers, float survival, bool shared) {
    return for_each_draw(group, vertex, kernel, numbers, [&](Group<N>& on, const Draw<N>& draw) {
      if (draw.delta) {
        // Towards lights nothing was drawn from this part: an earlier share goes on.
        on.weight *= (1.0f / survival) * draw.factor;
        return;
      }
      const Spectral<N> pdf = survival * kernel.pdf(vertex.wo, draw.wi);
      on.weight *= ratio(kernel.value(vertex.wo, draw.wi), pdf);
      on.mis.technique = MisTechnique::kNone;
      if (shared) {
        on.mis = {MisTechnique::kKernel, from(vertex, kernel), vertex.to_world(draw.wi), pdf};
      }
    });
  }

  // One photon from the mixture of kernel, lights and uniform domain: the density is the sum of
  // all, whichever drew. Morley et al. 2006, section 4.
  template <class Kernel>
  bool draw_from_mixture(Group<N>& group, const Vertex<N>& vertex, const Kernel& kernel,
                         const KernelNumbers& numbers, float part, float survival) {
    const MixtureWeights& weights = options_.mixture;
    const LightSamplingContext here = from(vertex, kernel);
    const bool from_lights = part >= weights.kernel && part < weights.kernel + weights.lights;
    const auto weigh = [&](Group<N>& on, const Draw<N>& draw) {
      if (draw.delta) {
        on.weight *= (1.0f / (survival * weights.kernel)) * draw.factor;
        return;
      }
      const float lights = weights.lights > 0.0f
                               ? weights.lights * scene_.lights.pdf(here, vertex.to_world(draw.wi))
                               : 0.0f;
      // Drawn at a rim and rounded off it, where only the other ways can have gone.
      if (from_lights && !(lights > 0.0f)) {
        on.weight = 0.0f;
        return;
      }
      const float others =
          (weights.uniform > 0.0f ? weights.uniform * uniform_pdf(kernel, draw.wi) : 0.0f) + lights;
      const Spectral<N> pdf = survival * (weights.kernel * kernel.pdf(vertex.wo, draw.wi) + others);
      on.weight *= ratio(kernel.value(vertex.wo, draw.wi), pdf);
    };
    if (part < weights.kernel) return for_each_draw(group, vertex, kernel, numbers, weigh);
    Draw<N> draw;
    if (from_lights) {
      const auto world = scene_.lights.sample(here, numbers.part, numbers.u, numbers.v);
      if (!world) return false;
      draw.wi = vertex.to_local(*world);
    } else {
      draw.wi = uniform_sample(kernel, numbers.u, numbers.v);
    }
    weigh(group, draw);
    return leave(group, vertex, draw.wi);
  }

  // A photon from each density, weighted by the power heuristic with exponent 2 (Veach and Guibas,
  // SIGGRAPH 1995). The one from the kernel goes on, the others wait.
  template <class Kernel>
  bool split(Group<N>& group, const Vertex<N>& vertex, const Kernel& kernel,
             const KernelNumbers& numbers, float survival) {
    const LightSamplingContext here = from(vertex, kernel);
    const bool uniform = options_.mixture.uniform > 0.0f;
    const auto weigh = [&](Group<N>& on, const Draw<N>& draw, int drawn_by) {
      if (draw.delta) {
        on.weight *= (1.0f / survival) * draw.factor;
        return;
      }
      const Spectral<N> by_kernel = kernel.pdf(vertex.wo, draw.wi);
      const float by_lights = scene_.lights.pdf(here, vertex.to_world(draw.wi));
      const float by_uniform = uniform ? uniform_pdf(kernel, draw.wi) : 0.0f;
      const Spectral<N> value = kernel.value(vertex.wo, draw.wi);
      // value / p times p^2 over the sum of squares.
      on.weight *= each(
          [&](float v, float k) {
            const float p = drawn_by == 0 ? k : drawn_by == 1 ? by_lights : by_uniform;
            const float squares = k * k + by_lights * by_lights + by_uniform * by_uniform;
            return squares > 0.0f ? v * p / (survival * squares) : 0.0f;
          },
          value, by_kernel);
    };
    for (int drawn_by = 1; drawn_by <= (uniform ? 2 : 1); ++drawn_by) {
      Group<N> branch = group;
      branch.sequence = group.sequence.branch(static_cast<std::uint32_t>(drawn_by));
      const Uniform4 u = branch.sequence.next();
      Draw<N> draw;
      if (drawn_by == 1) {
        const auto world = scene_.lights.sample(here, u[2], u[0], u[1]);
        if (!world) continue;
        draw.wi = vertex.to_local(*world);
      } else {
        draw.wi = uniform_sample(kernel, u[0], u[1]);
      }
      weigh(branch, draw, drawn_by);
      if (leave(branch, vertex, draw.wi)) waiting_.push(branch);
    }
    return for_each_draw(group, vertex, kernel, numbers,
                         [&](Group<N>& on, const Draw<N>& draw) { weigh(on, draw, 0); });
  }

  // The photon towards lights counts what it meets, with its share, through mirrors and clear glass
  // too. It ends on the first surface that spreads light: there the one from the kernel carries the
  // whole weight.
  template <class Kernel>
  void next_event_estimation(const Group<N>& group, const Vertex<N>& vertex, const Kernel& kernel,
                             float survival) {
    Group<N> photon = group;
    photon.sequence = group.sequence.branch(1);
    const Uniform4 u = photon.sequence.next();
    const LightSamplingContext here = from(vertex, kernel);
    const auto direction = scene_.lights.sample(here, u[2], u[0], u[1]);
    if (!direction) return;
    const Vec3 wi = vertex.to_local(*direction);
    if (wi.z <= 0.0f && !kernel.transmits()) return;
    photon.weight *= kernel.value(vertex.wo, wi);
    photon.mis = {MisTechnique::kLights, here, *direction, survival * kernel.pdf(vertex.wo, wi)};
    if (leave(photon, vertex, wi)) follow(photon);
  }

  // A photon towards lights where it meets a surface that may be clear.
  template <class Kernel>
  bool pass_on(Group<N>& group, const Vertex<N>& vertex, const Kernel& kernel) {
    const Uniform4 u = group.sequence.next();
    const float survival =
        std::min(1.0f, largest(only(kernel.albedo(vertex.wo), alive(group.weight))));
    if (u[2] >= survival) return false;
    return for_each_draw(
        group, vertex, kernel, {u[3], u[0], u[1]}, [&](Group<N>& on, const Draw<N>& draw) {
          on.weight = draw.delta ? (1.0f / survival) * on.weight * draw.factor : Spectral<N>(0.0f);
        });
  }

  template <class Kernel>
  LightSamplingContext from(const Vertex<N>& vertex, const Kernel& kernel) const {
    return {vertex.hit.position, vertex.normal, kernel.transmits(), time_};
  }

  const Scene& scene_;
  const TracingOptions& options_;
  const Spectral<N> wavelengths_;
  const float time_, spread_;
  const bool both_;
  PathEstimator& estimator_;
  std::uint32_t rays_ = 0;
  bool sent_ = false;
  Flight flight_;
  Waiting waiting_;
};

}  // namespace nocturne
