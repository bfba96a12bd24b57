// Two other ways to draw directions, which the paper compares: one photon from the mixture of all
// densities, and one from each (Morley et al. 2006, section 4).
#pragma once

#include "tracer/vertex/directions.h"

namespace nocturne {

template <class Kernel>
Vec3 uniform_sample(const Kernel& kernel, float u, float v) {
  return kernel.transmits() ? UniformSphere::sample(u, v) : UniformHemisphere::sample(u, v);
}
template <class Kernel>
float uniform_pdf(const Kernel& kernel, Vec3 wi) {
  return kernel.transmits() ? UniformSphere::pdf() : UniformHemisphere::pdf(wi);
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
    on.mis.worth = worth_outside(batch, on);
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
  spawn_ray(batch, group, vertex, draw.wi, false, [&](Group<N>& on) {
    weigh(on, draw);
    polarise(batch, on, vertex, kernel, draw);
  });
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
    on.mis.worth = worth_outside(batch, on);
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
    spawn_ray(batch, group, vertex, draw.wi, false, [&](Group<N>& on) {
      on.sequence = sequence;
      weigh(on, draw, drawn_by);
      polarise(batch, on, vertex, kernel, draw);
    });
  }
  drawn_pdf = 0.0f;
  for_each_draw(batch, group, vertex, kernel, numbers,
                [&](Group<N>& on, const Draw<N>& draw) { weigh(on, draw, 0); });
}

}  // namespace nocturne
