// The directions in which photons go on from a vertex: from its kernel, and towards lights and
// important shapes (docs/decisions/0011-two-photons-at-a-vertex.md).
#pragma once

#include <bit>

#include "tracer/sharing/record_vertices.h"

namespace nocturne {

/// Whether light that mirrors and glass gather counts for an adjoint photon that leaves a vertex.
template <class Batch, int N>
bool owns_caustics(const Batch& batch, const Group<N>& group, const Vertex<N>& vertex) {
  if (!batch.both) return true;
  if (group.depth > 1) return !group.ends.diffuse_like_at_camera;
  return batch.scene.specular_like[vertex.kernel] || near_camera(batch, group, vertex);
}

template <class Batch, int N>
std::uint32_t learned_at(const Batch& batch, const Group<N>& group, const Vertex<N>& vertex) {
  const LearnedLight& learned = batch.scene.lights.learned();
  const bool guides =
      !learned.empty() && batch.options.guide && owns_caustics(batch, group, vertex);
  return guides ? learned.find(vertex.hit.position) : LearnedLight::kNone;
}

template <class Batch, int N, class Kernel>
LightSamplingContext light_context(const Batch& batch, const Group<N>& group,
                                   const Vertex<N>& vertex, const Kernel& kernel) {
  return {vertex.hit.position,         vertex.normal,  kernel.transmits(),
          batch.sample_of(group).time, vertex.learned, vertex.visible_sky};
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
    const std::uint32_t together = draw ? draw->coherent & left : 1u << lead;
    left &= ~together;
    if (!draw) continue;
    if constexpr (N > 1 && requires { kernel.likelihood(vertex.wo, draw->wi); }) {
      group.path_pdf_ratio *= kernel.likelihood(vertex.wo, draw->wi);
    }
    spawn_ray(batch, group, vertex, draw->wi, draw->delta, [&](Group<N>& on) {
      if (together != all) on.weight = only(group.weight, together);
      weigh(on, *draw);
      polarise(batch, on, vertex, kernel, *draw);
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
      if (batch.shadow_rays_suffice) on.mis.technique = MisTechnique::kNone;
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

template <class Batch, int N, class Kernel>
void continue_through_specular(Batch& batch, Group<N>& group, const Vertex<N>& vertex,
                               const Kernel& kernel, const KernelNumbers& numbers, float survival) {
  for_each_draw(batch, group, vertex, kernel, numbers, [&](Group<N>& on, const Draw<N>& draw) {
    on.weight = draw.delta ? (1.0f / survival) * on.weight * draw.factor : Spectral<N>(0.0f);
  });
}

/// A ball of glass shows a lamp by 4 % of a photon in some hundred: half of all that meet glass
/// first are mirrored where lamps are widened.
template <int N>
KernelNumbers::Halves halves(const TracingOptions& options, const Group<N>& group) {
  using Gathered = TracingOptions::Gathered;
  if (options.gathered < Gathered::kNearlyMet || group.depth - group.passes > 1) {
    return KernelNumbers::Halves::kNo;
  }
  return options.gathered == Gathered::kNearlyMetSquared ? KernelNumbers::Halves::kOfSquare
                                                         : KernelNumbers::Halves::kYes;
}

}  // namespace nocturne
