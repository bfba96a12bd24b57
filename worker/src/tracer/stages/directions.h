// Ways to draw the directions in which photons go on from a vertex
// (docs/decisions/0011-two-photons-at-a-vertex.md; Morley et al. 2006, section 4).
#pragma once

#include <bit>

#include "tracer/stages/offer.h"

namespace nocturne {

/// Whether light that mirrors and glass gather counts for an adjoint photon that leaves a vertex.
template <class Batch, int N>
bool brings_what_is_gathered(const Batch& batch, const Group<N>& group, const Vertex<N>& vertex) {
  if (!batch.both) return true;
  if (group.depth > 1) return !group.ends.diffuse_like_at_camera;
  return batch.scene.specular_like[vertex.kernel] || near_camera(batch, group, vertex);
}

template <class Batch, int N>
std::uint32_t learned_at(const Batch& batch, const Group<N>& group, const Vertex<N>& vertex) {
  const LearnedLight& learned = batch.scene.lights.learned();
  const bool guides =
      !learned.empty() && batch.options.guide && brings_what_is_gathered(batch, group, vertex);
  return guides ? learned.find(vertex.hit.position) : LearnedLight::kNone;
}

template <class Batch, int N, class Kernel>
LightSamplingContext light_context(const Batch& batch, const Group<N>& group,
                                   const Vertex<N>& vertex, const Kernel& kernel) {
  return {vertex.hit.position, vertex.normal, kernel.transmits(), batch.sample_of(group).time,
          vertex.learned};
}

/// The same context for what leaves in `direction`.
template <class Batch, int N, class Kernel>
LightSamplingContext light_context(const Batch& batch, const Group<N>& group,
                                   const Vertex<N>& vertex, const Kernel& kernel, Vec3 direction) {
  LightSamplingContext from = light_context(batch, group, vertex, kernel);
  from.position = leaves_from(batch, vertex, direction);
  return from;
}

/// A direction towards light, from where its ray starts; three uniform numbers.
struct TowardsLight {
  LightSamplingContext from;
  DrawnDirection drawn;
};
template <class Batch, int N, class Kernel>
std::optional<TowardsLight> draw_towards_light(const Batch& batch, const Group<N>& group,
                                               const Vertex<N>& vertex, const Kernel& kernel,
                                               float choice, float u1, float u2) {
  const auto draw = [&](Vec3 side) -> std::optional<TowardsLight> {
    const LightSamplingContext from = light_context(batch, group, vertex, kernel, side);
    const auto drawn = batch.scene.lights.sample(from, choice, u1, u2);
    if (!drawn) return std::nullopt;
    return TowardsLight{from, *drawn};
  };
  const auto is_beyond = [&](const TowardsLight& light) {
    return dot(vertex.normal, light.drawn.direction) < 0.0f;
  };
  const auto on_this_side = draw(vertex.normal);
  if (!on_this_side || !is_beyond(*on_this_side)) return on_this_side;
  const auto beyond = draw(-vertex.normal);
  return beyond && is_beyond(*beyond) ? beyond : std::nullopt;
}

template <class Kernel>
Vec3 uniform_sample(const Kernel& kernel, float u, float v) {
  return kernel.transmits() ? UniformSphere::sample(u, v) : UniformHemisphere::sample(u, v);
}
template <class Kernel>
float uniform_pdf(const Kernel& kernel, Vec3 wi) {
  return kernel.transmits() ? UniformSphere::pdf() : UniformHemisphere::pdf(wi);
}

/// A draw for each photon of the group; those that draw the same go on together. `weigh` multiplies
/// the weights by value over density. A phase function that depends on the wavelength turns all
/// alike, and moves the path pdf ratios with the weights.
template <class Batch, int N, class Kernel, class Weigh>
void for_each_draw(Batch& batch, Group<N>& group, const Vertex<N>& vertex, const Kernel& kernel,
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
    go_on(batch, group, vertex, draw->wi, draw->delta, [&](Group<N>& on) {
      if (together != all) on.weight = only(group.weight, together);
      weigh(on, *draw);
    });
  }
}

/// One photon from the kernel alone. Where another goes towards lights (`shared`), lights that are
/// found count with a MIS weight.
template <class Batch, int N, class Kernel>
void draw_from_kernel(Batch& batch, Group<N>& group, const Vertex<N>& vertex, const Kernel& kernel,
                      const KernelNumbers& numbers, float survival, bool shared) {
  for_each_draw(batch, group, vertex, kernel, numbers, [&](Group<N>& on, const Draw<N>& draw) {
    if (draw.delta) {
      // Towards lights nothing was drawn from this part: an earlier MIS state goes on, unless
      // photons that were sent there end at mirrors.
      if (batch.occlusion_decides) on.mis.technique = MisTechnique::kNone;
      on.shares = false;
      on.weight *= (1.0f / survival) * draw.factor;
      return;
    }
    if (on.shares) on.sequence = batch.sharing.sequences[on.sample];
    const Evaluation<N> there = evaluate<N>(kernel, vertex.wo, draw.wi);
    const Spectral<N> pdf = survival * there.pdf;
    on.weight *= ratio(there.value, pdf);
    on.mis.technique = MisTechnique::kNone;
    if (shared) {
      const Vec3 direction = vertex.to_world(draw.wi);
      on.mis = {MisTechnique::kKernel, light_context(batch, group, vertex, kernel, direction),
                direction, pdf};
    }
  });
}

/// Density of directions towards light, where `wi` (in the vertex's frame) was drawn with `drawn`
/// towards one, or 0.
template <class Batch, int N, class Kernel>
float pdf_of_lights(const Batch& batch, const Group<N>& group, const Vertex<N>& vertex,
                    const Kernel& kernel, Vec3 wi, float drawn) {
  const Vec3 direction = vertex.to_world(wi);
  return batch.scene.lights.pdf(light_context(batch, group, vertex, kernel, direction),
                                {direction, drawn});
}

/// One photon from the mixture of kernel, lights and uniform domain: the density is the sum of all,
/// whichever drew.
template <class Batch, int N, class Kernel>
void draw_from_mixture(Batch& batch, Group<N>& group, const Vertex<N>& vertex, const Kernel& kernel,
                       const KernelNumbers& numbers, float part, float survival) {
  const MixtureWeights& weights = batch.options.mixture;
  const bool from_lights = part >= weights.kernel && part < weights.kernel + weights.lights;
  float drawn_pdf = 0.0f;
  const auto weigh = [&](Group<N>& on, const Draw<N>& draw) {
    if (draw.delta) {
      on.weight *= (1.0f / (survival * weights.kernel)) * draw.factor;
      return;
    }
    const float by_lights =
        weights.lights > 0.0f
            ? weights.lights * pdf_of_lights(batch, group, vertex, kernel, draw.wi, drawn_pdf)
            : 0.0f;
    // Drawn at a rim and rounded off it, where only the other techniques can have drawn it.
    if (from_lights && !(by_lights > 0.0f)) {
      on.weight = 0.0f;
      return;
    }
    const float others =
        (weights.uniform > 0.0f ? weights.uniform * uniform_pdf(kernel, draw.wi) : 0.0f) +
        by_lights;
    const Evaluation<N> there = evaluate<N>(kernel, vertex.wo, draw.wi);
    const Spectral<N> pdf = survival * (weights.kernel * there.pdf + others);
    on.weight *= ratio(there.value, pdf);
    on.mis.technique = MisTechnique::kNone;
  };
  if (part < weights.kernel) return for_each_draw(batch, group, vertex, kernel, numbers, weigh);
  Draw<N> draw;
  if (from_lights) {
    const auto light =
        draw_towards_light(batch, group, vertex, kernel, numbers.part, numbers.u, numbers.v);
    if (!light) return;
    draw.wi = vertex.to_local(light->drawn.direction);
    drawn_pdf = light->drawn.pdf;
  } else {
    draw.wi = uniform_sample(kernel, numbers.u, numbers.v);
  }
  go_on(batch, group, vertex, draw.wi, false, [&](Group<N>& on) { weigh(on, draw); });
}

/// A photon from each density, weighted by the power heuristic with exponent 2 (Veach and Guibas,
/// SIGGRAPH 1995).
template <class Batch, int N, class Kernel>
void split(Batch& batch, Group<N>& group, const Vertex<N>& vertex, const Kernel& kernel,
           const KernelNumbers& numbers, float survival) {
  const bool uniform = batch.options.mixture.uniform > 0.0f;
  float drawn_pdf = 0.0f;
  const auto weigh = [&](Group<N>& on, const Draw<N>& draw, int drawn_by) {
    if (draw.delta) {
      on.weight *= (1.0f / survival) * draw.factor;
      return;
    }
    const Evaluation<N> there = evaluate<N>(kernel, vertex.wo, draw.wi);
    const float by_lights = pdf_of_lights(batch, group, vertex, kernel, draw.wi, drawn_pdf);
    const float by_uniform = uniform ? uniform_pdf(kernel, draw.wi) : 0.0f;
    on.mis.technique = MisTechnique::kNone;
    // value / p times p^2 over the sum of squares.
    on.weight *= each(
        [&](float v, float k) {
          const float p = drawn_by == 0 ? k : drawn_by == 1 ? by_lights : by_uniform;
          const float squares = k * k + by_lights * by_lights + by_uniform * by_uniform;
          return squares > 0.0f ? v * p / (survival * squares) : 0.0f;
        },
        there.value, there.pdf);
  };
  for (int drawn_by = 1; drawn_by <= (uniform ? 2 : 1); ++drawn_by) {
    PhotonSequence sequence = group.sequence.branch(static_cast<std::uint32_t>(drawn_by));
    const Uniform4 u = sequence.next();
    Draw<N> draw;
    if (drawn_by == 1) {
      const auto light = draw_towards_light(batch, group, vertex, kernel, u[2], u[0], u[1]);
      if (!light) continue;
      draw.wi = vertex.to_local(light->drawn.direction);
      drawn_pdf = light->drawn.pdf;
    } else {
      draw.wi = uniform_sample(kernel, u[0], u[1]);
      drawn_pdf = 0.0f;
    }
    go_on(batch, group, vertex, draw.wi, false, [&](Group<N>& on) {
      on.sequence = sequence;
      weigh(on, draw, drawn_by);
    });
  }
  drawn_pdf = 0.0f;
  for_each_draw(batch, group, vertex, kernel, numbers,
                [&](Group<N>& on, const Draw<N>& draw) { weigh(on, draw, 0); });
}

}  // namespace nocturne
