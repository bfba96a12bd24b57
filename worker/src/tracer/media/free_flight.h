// How far photons get in media. A medium is a surface that is there by chance: each medium on the
// path is tried separately, with its own numbers, and the nearest hit wins (Morley et al. 2006,
// section 5), so that media may overlap as they like.
//
// Photons of a group meet a medium at different places where its extinction depends on the
// wavelength. One of them, drawn by the path pdf ratios, decides for all; each weight is then
// multiplied by the photon's own probability of what happened over the mean of all photons'
// (balance heuristic over the choice of the one that leads; Wilkie et al., "Hero wavelength
// spectral sampling", EGSR 2014, with null collisions as in Miller, Georgiev and Jarosz, "A
// null-scattering path integral formulation of light transport", SIGGRAPH 2019). In grey media all
// of this is 1.
//
// Long, as the methods of meeting media (collide, force, pass) share one state: the media present
// where a group is. The walk through one varying medium lies in delta_tracking.h.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <type_traits>
#include <variant>

#include "math/functions.h"
#include "scene/scene.h"
#include "tracer/fixed_stack.h"
#include "tracer/group.h"
#include "tracer/media/delta_tracking.h"
#include "tracer/path_limits.h"

namespace nocturne {

template <int N>
class FreeFlight {
 public:
  FreeFlight(const Scene& scene, const Spectral<N>& wavelengths_nm, PathLimits& limits)
      : scene_(scene), wavelengths_(wavelengths_nm), limits_(limits) {}

  /// Later calls are about the media in these bodies; false where there are none.
  bool enter(const InteriorList& inside) {
    if (!(inside == inside_)) find_present(inside);
    return !present_.empty();
  }

  /// The nearest collision before `end`, as the hit of a surface, and its weight for each photon.
  std::optional<Hit> collide(Group<N>& group, float nearest) const {
    const Ray ray = from_surface(group);
    const float end = nearest + group.ray_offset;
    const Uniform4 u = group.sequence.next();
    const std::size_t lead = draw_lead(group, u[1]);
    Way way{end, kNone, 1.0f};
    if (constant_[lead] > 0.0f) {
      const float distance = exponential(u[0]) / constant_[lead];
      if (distance < end) {
        way.distance = distance;
        way.medium = choose_constant(lead, FlightNumbers(seed(u, kMaxPresent))());
      }
    }
    if (!fly(ray, u, lead, end, way)) {
      truncate(group);
      return std::nullopt;
    }
    weigh(group, lead, way);
    if (way.medium == kNone) return std::nullopt;
    return hit_at(group, way.medium, way.distance);
  }

  /// Media so thin that a photon would seldom meet them by chance. To be asked before force.
  /// Never of those that fluoresce, which photons meet more often than light does.
  bool thin(const Group<N>& group, float nearest) {
    if (collides_in_vain_) return false;
    const Ray ray = from_surface(group);
    const float end = nearest + group.ray_offset;
    depth_ = 0.0f;
    for (std::size_t i = 0; i < present_.size(); ++i)
      depth_ += depths_[i] = majorant_depth(i, ray, end);
    return depth_ < kThin;
  }

  /// How many forced collisions are worth the while in thin media: one for so much depth.
  std::uint32_t collisions_worthwhile() const {
    return std::max(1u, static_cast<std::uint32_t>(depth_ / kWorthwhile));
  }

  /// Which of several collisions, each with its part of the weight.
  struct OneOf {
    std::uint32_t index = 0, count = 1;
  };

  /// A collision before `end` in thin media, whose weight is the probability that there would have
  /// been one: what pass leaves of another group is the rest. Placed by the bounds, so that it is
  /// the same for all photons; none where it is not worth the while. Several are spread evenly.
  std::optional<Hit> force(Group<N>& group, float nearest, OneOf which = {}) const {
    const Ray ray = from_surface(group);
    const float end = nearest + group.ray_offset;
    Uniform4 u = group.sequence.next();
    const auto count = static_cast<float>(which.count);
    u[0] = (static_cast<float>(which.index) + u[0]) / count;
    const float chance = std::min(1.0f, depth_ / kWorthwhile);
    if (u[1] >= chance) return std::nullopt;
    const std::size_t i = choose(std::span(depths_), u[1] / chance * depth_);
    if (i == kNone) return std::nullopt;
    const Present& present = present_[i];
    const float depth = depths_[i], all = -math::expm1(-depth), at = -math::log1p(-u[0] * all);
    const auto [distance, of_majorant] = place(i, ray, end, at);
    if (!(distance < end)) return std::nullopt;
    const float factor = of_majorant / largest(present.extinction) * math::exp(at) * all * depth_ /
                         (depth * chance * count);
    group.weight *= factor * present.extinction;
    transmit(group, ray, group.sequence.next(), distance);
    return hit_at(group, i, distance);
  }

  /// Multiplies the weights by the transmittance up to `end`, or by an unbiased estimate of it
  /// (ratio tracking; Novak, Selle and Jarosz, "Residual ratio tracking for estimating attenuation
  /// in participating media", SIGGRAPH Asia 2014). The group may end.
  void pass(Group<N>& group, float nearest) const {
    transmit(group, from_surface(group), group.sequence.next(), nearest + group.ray_offset);
  }

 private:
  // Media begin at the surface, not where the ray does.
  static Ray from_surface(const Group<N>& group) {
    return {group.ray.origin - group.ray_offset * group.ray.direction, group.ray.direction};
  }

  void transmit(Group<N>& group, const Ray& ray, const Uniform4& u, float end) const {
    group.weight *=
        each([end](float sigma) { return math::exp(-sigma * end); }, constant_ - constant_null_);
    for (std::size_t i = 0; i < present_.size(); ++i) {
      if (!(largest(group.weight) > 0.0f)) return;
      const Present& present = present_[i];
      std::visit(
          [&](const auto& density) {
            if constexpr (!kIsConstant<decltype(density)>) {
              const auto left =
                  transmitted(density, extinction_of(present), ray, end, numbers(u, i));
              if (!left) return truncate(group);
              group.weight *= *left;
            }
          },
          scene_.media[present.index].density);
    }
  }

  // The group ends here, though something might have come of it.
  void truncate(Group<N>& group) const {
    limits_.truncate(static_cast<std::uint32_t>(std::popcount(alive(group.weight))));
    group.weight = 0.0f;
  }

  // Of media at one point.
  static constexpr std::size_t kMaxPresent = 32;
  static constexpr std::size_t kNone = ~std::size_t{0};
  // An estimate below this goes on by roulette.
  static constexpr float kSmallTransmittance = 0.05f;
  // Depths up to which a photon is made to collide, and below which only some are.
  static constexpr float kThin = 2.0f, kWorthwhile = 0.05f;

  template <class Density>
  static constexpr bool kIsConstant = std::is_same_v<std::remove_cvref_t<Density>, ConstantDensity>;

  struct Present {
    std::uint32_t index;
    /// 1/m at density 1, with null collisions.
    Spectral<N> extinction;
    /// Zero unless it is the same everywhere.
    float density;
  };

  struct Way {
    float distance;
    // Which medium was hit.
    std::size_t medium;
    // Probability of what happened, for each photon, up to a common factor.
    Spectral<N> probability;
  };

  void find_present(const InteriorList& inside) {
    inside_ = inside;
    present_.clear();
    first_varying_ = kNone;
    constant_ = 0.0f;
    constant_null_ = 0.0f;
    collides_in_vain_ = false;
    inside.for_each_present(scene_.interiors, [&](const Interior& body) {
      for (const std::uint32_t medium : body.media) add(medium);
    });
  }

  // Not so near to the surface that the next ray might start behind it.
  Hit hit_at(const Group<N>& group, std::size_t medium, float from_surface) const {
    const Ray& ray = group.ray;
    const float distance = std::max(0.0f, from_surface - group.ray_offset);
    return {.position = ray.origin + distance * ray.direction,
            .normal = -ray.direction,
            .surface = scene_.surface_of(present_[medium].index),
            .distance = distance,
            .clearance = 0.0f,
            .instance = Hit::kNoInstance,
            .primitive = 0,
            .u = 0.0f,
            .v = 0.0f};
  }

  // f(segment, where it begins, majorants) for every segment of a medium along a ray; it says
  // whether to go on.
  template <class F>
  void for_each_segment(std::size_t i, const Ray& ray, float end, const F& f) const {
    std::visit(
        [&](const auto& density) {
          typename std::remove_cvref_t<decltype(density)>::Majorants majorants(density, ray, end);
          float from = 0.0f;
          for (MajorantSegment segment; majorants.next(segment); from = segment.end) {
            if (!f(segment, from, majorants)) return;
          }
        },
        scene_.media[present_[i].index].density);
  }

  // Optical depth of the majorants, of the photon for which it is largest.
  float majorant_depth(std::size_t i, const Ray& ray, float end) const {
    const float extinction = largest(present_[i].extinction);
    float depth = 0.0f;
    for_each_segment(i, ray, end, [&](const MajorantSegment& segment, float from, const auto&) {
      if (segment.majorant > 0.0f) depth += extinction * segment.majorant * (segment.end - from);
      return depth < kThin;
    });
    return depth;
  }

  struct Placed {
    float distance;
    /// The density there over the majorant.
    float of_majorant;
  };
  // Where that depth of majorants is reached.
  Placed place(std::size_t i, const Ray& ray, float end, float depth) const {
    const float extinction = largest(present_[i].extinction);
    Placed found{end, 0.0f};
    for_each_segment(
        i, ray, end, [&](const MajorantSegment& segment, float from, const auto& along) {
          const float majorant = segment.majorant;
          if (!(majorant > 0.0f)) return true;
          const float here = extinction * majorant * (segment.end - from);
          if (depth >= here) {
            depth -= here;
            return true;
          }
          found.distance = from + depth / (extinction * majorant);
          found.of_majorant = std::min(along.density(found.distance), majorant) / majorant;
          return false;
        });
    return found;
  }

  // The one in whose share `left` falls.
  std::size_t choose(std::span<const float> shares, float left) const {
    std::size_t last = kNone;
    for (std::size_t i = 0; i < present_.size(); ++i) {
      if (!(shares[i] > 0.0f)) continue;
      last = i;
      if (left < shares[i]) return i;
      left -= shares[i];
    }
    return last;
  }

  // Media beyond what fits are not seen, as bodies beyond InteriorList::kMax are not.
  void add(std::uint32_t index) {
    if (present_.size() == kMaxPresent) return;
    const Medium& medium = scene_.media[index];
    Present present{index, medium.collisions(wavelengths_), 0.0f};
    collides_in_vain_ = collides_in_vain_ || medium.null_collisions;
    if (const auto* constant = std::get_if<ConstantDensity>(&medium.density)) {
      present.density = constant->value;
      constant_ += present.density * present.extinction;
      if (medium.null_collisions) {
        constant_null_ += present.density * (*medium.null_collisions)(wavelengths_);
      }
    } else if (first_varying_ == kNone) {
      first_varying_ = present_.size();
    }
    present_.push(present);
  }

  // What light loses, without null collisions.
  Spectral<N> extinction_of(const Present& present) const {
    const Medium& medium = scene_.media[present.index];
    return medium.null_collisions ? medium.extinction(wavelengths_) : present.extinction;
  }

  // The first of the flight's own numbers is better spread than any: it goes to the first medium
  // that is asked for a distance.
  FlightNumbers numbers(const Uniform4& u, std::size_t medium) const {
    return medium == first_varying_ && !(largest(constant_) > 0.0f)
               ? FlightNumbers(seed(u, medium), u[0])
               : FlightNumbers(seed(u, medium));
  }

  static std::uint64_t seed(const Uniform4& u, std::size_t medium) {
    const auto bits = [](float x) { return std::uint64_t{std::bit_cast<std::uint32_t>(x)}; };
    return (bits(u[2]) << 32 | bits(u[3])) + medium * 0xD1B54A32D192ED03u;
  }

  // By the path pdf ratios of those that still carry something.
  static std::size_t draw_lead(Group<N>& group, float u) {
    if constexpr (N == 1) return 0;
    Spectral<N> path_pdf_ratio = only(group.path_pdf_ratio, alive(group.weight));
    const float all = sum(path_pdf_ratio);
    if (!(all > 0.0f)) {
      const std::uint32_t mask = alive(group.weight);
      path_pdf_ratio = only(Spectral<N>(1.0f / static_cast<float>(std::popcount(mask))), mask);
    } else {
      path_pdf_ratio = path_pdf_ratio / all;
    }
    group.path_pdf_ratio = path_pdf_ratio;
    std::size_t last = 0;
    for (std::size_t i = 0; i < N; ++i) {
      if (!(path_pdf_ratio[i] > 0.0f)) continue;
      last = i;
      if (u < path_pdf_ratio[i]) return i;
      u -= path_pdf_ratio[i];
    }
    return last;
  }

  std::size_t choose_constant(std::size_t lead, float u) const {
    std::array<float, kMaxPresent> shares;
    for (std::size_t i = 0; i < present_.size(); ++i) {
      shares[i] = present_[i].density * present_[i].extinction[lead];
    }
    return choose(shares, u * constant_[lead]);
  }

  // Through the media that vary. Where a later one is hit before an earlier one's flight ended, the
  // part of the earlier flight beyond is taken back by doing it once more. False where it took too
  // long.
  bool fly(const Ray& ray, const Uniform4& u, std::size_t lead, float end, Way& way) const {
    bool shortened = false;
    for (std::size_t i = 0; i < present_.size(); ++i) {
      const Tracked tracked = fly_one(i, ray, u, lead, end, way);
      if (tracked == Tracked::kTruncated) return false;
      shortened = shortened || (tracked == Tracked::kHit && i > 0);
    }
    if (!shortened || N == 1) return true;
    way.probability = 1.0f;
    for (std::size_t i = 0; i < present_.size(); ++i) fly_one(i, ray, u, lead, end, way);
    return true;
  }

  enum class Tracked { kPassed, kHit, kTruncated };

  Tracked fly_one(std::size_t i, const Ray& ray, const Uniform4& u, std::size_t lead, float end,
                  Way& way) const {
    return std::visit(
        [&](const auto& density) {
          if constexpr (!kIsConstant<decltype(density)>) {
            const Tracked tracked =
                track(density, present_[i].extinction, lead, ray, end, numbers(u, i), way);
            if (tracked == Tracked::kHit) way.medium = i;
            return tracked;
          } else {
            return Tracked::kPassed;
          }
        },
        scene_.media[present_[i].index].density);
  }

  // Delta tracking (Woodcock et al. 1965) under majorants that are constant over segments. One
  // serves the whole group, so that only the share of null collisions tells photons apart.
  template <class Density>
  Tracked track(const Density& density, const Spectral<N>& extinction, std::size_t lead,
                const Ray& ray, float end, FlightNumbers numbers, Way& way) const {
    bool hit = false;
    const auto meet = [&](const Tentative& at) {
      if (at.distance > way.distance) return false;
      hit = numbers() * at.majorant < at.density * extinction[lead];
      if (hit) way.distance = at.distance;
      if constexpr (N > 1) {
        way.probability *= hit ? extinction : Spectral<N>(at.majorant) - at.density * extinction;
        normalise(way.probability);
      }
      return !hit;
    };
    if (!for_each_tentative(density, largest(extinction), ray, end, numbers, limits_, meet)) {
      return Tracked::kTruncated;
    }
    return hit ? Tracked::kHit : Tracked::kPassed;
  }

  static void normalise(Spectral<N>& probability) {
    if constexpr (N > 1) {
      const float majorant = largest(probability);
      if (majorant > 0.0f) probability = probability / majorant;
    }
  }

  // Empty where it took too long.
  template <class Density>
  std::optional<Spectral<N>> transmitted(const Density& density, const Spectral<N>& extinction,
                                         const Ray& ray, float end, FlightNumbers numbers) const {
    Spectral<N> left = 1.0f;
    const auto meet = [&](const Tentative& at) {
      // By rounding it may be a little less than nothing.
      left *=
          each([&](float sigma) { return std::max(0.0f, 1.0f - at.density / at.majorant * sigma); },
               extinction);
      const float best = largest(left);
      if (best >= kSmallTransmittance) return true;
      const bool survives = numbers() * kSmallTransmittance < best;
      left = survives ? (kSmallTransmittance / best) * left : Spectral<N>(0.0f);
      return survives;
    };
    if (!for_each_tentative(density, largest(extinction), ray, end, numbers, limits_, meet)) {
      return std::nullopt;
    }
    return left;
  }

  // Constant media enter in closed form, now that the flight is known.
  void weigh(Group<N>& group, std::size_t lead, const Way& way) const {
    if constexpr (N > 1) {
      Spectral<N> p = way.probability;
      const float reference = constant_[lead];
      p *= each([&](float sigma) { return math::exp((reference - sigma) * way.distance); },
                constant_);
      if (way.medium != kNone && present_[way.medium].density > 0.0f) {
        p *= present_[way.medium].extinction;
      }
      const float mean = sum(group.path_pdf_ratio * p);
      if (!(mean > 0.0f)) return;
      p = p / mean;
      group.weight *= p;
      group.path_pdf_ratio *= p;
    }
  }

  const Scene& scene_;
  const Spectral<N> wavelengths_;
  PathLimits& limits_;
  InteriorList inside_;
  // Of all media that are the same everywhere, 1/m, with null collisions; and of these alone.
  Spectral<N> constant_ = 0.0f, constant_null_ = 0.0f;
  bool collides_in_vain_ = false;
  FixedStack<Present, kMaxPresent> present_;
  std::size_t first_varying_;
  // What thin found.
  std::array<float, kMaxPresent> depths_;
  float depth_;
};

}  // namespace nocturne
