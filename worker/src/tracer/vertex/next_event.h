// Next-event estimation: a second photon from a vertex, drawn towards lights and important shapes.
// It counts the light it meets with its MIS weight, through mirrors and clear glass too, and ends
// on the first surface without a delta lobe: there the one from the kernel carries the whole
// weight.
#pragma once

#include <span>

#include "tracer/vertex/directions.h"
#include "tracer/vertex/power_heuristic.h"

namespace nocturne {

/// From within glass no light lies where it seems to, unless that was learned. A surface that
/// scatters light in there may still stand before one in the same glass; a medium has too many
/// vertices to try at each.
template <class Batch, int N>
bool may_see_lights(const Batch& batch, const Group<N>& group, const Vertex<N>& vertex) {
  return !batch.is_medium(vertex.hit) ||
         group.inside.current(batch.scene.interiors) == InteriorList::kOutside ||
         vertex.learned != LearnedLight::kNone;
}

/// With both directions, whether a path from a light to this vertex is an adjoint photon's
/// (path_partition.h).
template <class Batch, int N>
bool brings_light(const Batch& batch, const Group<N>& group, const Vertex<N>& vertex) {
  return !batch.both || !batch.scene.specular_like[vertex.kernel] ||
         owns_caustics(batch, group, vertex);
}

/// A photon towards lights, through whatever lets it pass.
template <class Batch, int N, class Kernel>
void estimate_next_event(Batch& batch, const Group<N>& group, const Vertex<N>& vertex,
                         const Kernel& kernel, float survival) {
  PhotonSequence sequence = group.sequence.branch(1);
  const Uniform4 u = sequence.next();
  const auto light = draw_towards_light(batch, group, vertex, kernel, u[2], u[0], u[1]);
  if (!light) return;
  const DrawnDirection& drawn = light->drawn;
  const Vec3 wi = vertex.to_local(drawn.direction);
  if (wi.z <= 0.0f && !kernel.transmits()) return;
  spawn_ray(batch, group, vertex, wi, false, [&](Group<N>& photon) {
    photon.sequence = sequence;
    photon.shares = false;
    const Evaluation<N> there = evaluate<N>(kernel, vertex.wo, wi);
    photon.weight *= there.value;
    photon.mis = {MisTechnique::kLights, light->from, drawn.direction,
                  survival * there.pdf,  drawn.pdf,   worth_outside(batch, photon)};
    polarise(batch, photon, vertex, kernel, Draw<N>{.wi = wi});
  });
}

/// The light from the nearest luminaire if it is not occluded.
template <class Batch, int N, class Kernel>
void sample_direct_light(Batch& batch, const Group<N>& group, const Vertex<N>& vertex,
                         const Kernel& kernel, float survival,
                         const LightSampler::LightSample& light) {
  const Scene& scene = batch.scene;
  const BatchSample<N>& sample = batch.sample_of(group);
  if (batch.both) {
    // The path's ends after this vertex, and not after the one before.
    const PathEnds after = after_adjoint(
        group.ends, interaction_at(batch, group, vertex, false, false), group.depth == 1);
    const bool near = light.distance < scene.near_ends;
    const PathEnds ends = at_luminaire(after, group.depth - group.passes, near);
    if (owner_of(ends) != Transport::kAdjoint) return;
  }
  const Vec3 wi = vertex.to_local(light.direction);
  if (!may_send(kernel, dot(vertex.normal, light.direction), wi)) return;
  const Spectral<N> radiance = light.luminaire == Emission::kNoLuminaire
                                   ? scene.distant_radiance(light, sample.wavelengths)
                                   : scene.luminaires[light.luminaire].emitted(
                                         light.normal, -light.direction, {}, sample.wavelengths);
  if (!(largest(radiance) > 0.0f) || largest(radiance) < scene.options.least_radiance) return;
  if (scene.options.gathered != TracingOptions::Gathered::kWithAll) return;
  const Evaluation<N> there = evaluate<N>(kernel, vertex.wo, wi);
  Spectral<N> found = group.weight * there.value * radiance;
  const auto passed = polarise_light(batch, group, vertex, kernel, wi, found);
  if (!(largest(found) > 0.0f)) return;
  const Spectral<N> lights(light.pdf);
  found *= power_share(lights, survival * there.pdf) / lights;
  ShadowRay<N>& shadow = batch.shadow_rays.emplace_back();
  shadow.way.ray.origin = leave_surface(vertex.hit, light.direction);
  shadow.way.ray.direction = light.direction;
  shadow.way.time = sample.time;
  shadow.way.end = light.free_distance;
  shadow.tally = group.tally;
  shadow.light = found;
  shadow.direct = meets_direct_light(group);
  if (!batch.tells_groups) return;
  const auto add = [&](std::uint32_t light_group, const Spectral<N>& part) {
    add_shadow_light(batch, passed, light_group, found * ratio(part, radiance));
  };
  if (light.luminaire != Emission::kNoLuminaire) {
    add(scene.luminaires[light.luminaire].light_group, radiance);
  } else {
    scene.for_each_distant_group(
        light.direction, sample.wavelengths, [](HiddenFrom) { return false; }, light.environment,
        add);
  }
}

/// Where nothing between can let light through.
template <class Batch, int N, class Bound>
void sample_direct_lights(Batch& batch, const Chunk<N, Bound>& chunk,
                          std::span<const std::uint32_t> which) {
  std::array<std::optional<PhotonSequence>, kChunk> sequences;
  std::array<Uniform4, kChunk> numbers;
  std::array<LightSamplingContext, kChunk> contexts;
  std::array<std::optional<Environment::PartialSample>, kChunk> begun;
  std::array<LightSampler::LightSample, kChunk> lights;
  std::array<bool, kChunk> drawn;
  for (std::size_t k = 0; k < which.size(); ++k) {
    sequences[k] = chunk.groups[which[k]]->sequence.branch(1);
  }
  PhotonSequence::next_of_each(
      which.size(), [&](std::size_t k) -> PhotonSequence& { return *sequences[k]; },
      numbers.data());
  const LightSampler& lights_of_scene = batch.scene.lights;
  const auto context = [&](std::size_t k, Vec3 side) {
    const std::size_t i = which[k];
    return light_context(batch, *chunk.groups[i], *chunk.vertices[i], *chunk.kernels[i], side);
  };
  for (std::size_t k = 0; k < which.size(); ++k) {
    const Uniform4& u = numbers[k];
    contexts[k] = context(k, chunk.vertices[which[k]]->normal);
    begun[k] = lights_of_scene.begin_light(contexts[k], u[2], u[0], u[1]);
  }
  for (std::size_t k = 0; k < which.size(); ++k) {
    const Vec3 normal = chunk.vertices[which[k]]->normal;
    const Uniform4& u = numbers[k];
    const auto draw = [&](const LightSamplingContext& from) {
      return lights_of_scene.sample_light(from, u[2], u[0], u[1], begun[k], lights[k]);
    };
    const auto is_beyond = [&] { return dot(normal, lights[k].direction) < 0.0f; };
    drawn[k] = draw(contexts[k]);
    if (drawn[k] && is_beyond()) drawn[k] = draw(context(k, -normal)) && is_beyond();
  }
  for (std::size_t k = 0; k < which.size(); ++k) {
    const std::size_t i = which[k];
    if (!drawn[k]) continue;
    sample_direct_light(batch, *chunk.groups[i], *chunk.vertices[i], *chunk.kernels[i],
                        chunk.survival[i], lights[k]);
  }
}

template <class Batch, int N, class Bound>
void estimate_next_events(Batch& batch, const Chunk<N, Bound>& chunk) {
  std::array<std::uint32_t, kChunk> which;
  std::size_t count = 0;
  for (std::uint32_t i = 0; i < chunk.count; ++i) {
    which[count] = i;
    const Group<N>& group = *chunk.groups[i];
    const bool too_deep =
        batch.shadow_rays_suffice && group.depth - group.passes > batch.options.max_depth;
    count +=
        chunk.two_photons[i] && !too_deep && brings_light(batch, group, *chunk.vertices[i]) ? 1 : 0;
  }
  if (batch.shadow_rays_suffice)
    return sample_direct_lights(batch, chunk, std::span(which).first(count));
  for (std::size_t k = 0; k < count; ++k) {
    const std::size_t i = which[k];
    estimate_next_event(batch, *chunk.groups[i], *chunk.vertices[i], *chunk.kernels[i],
                        chunk.survival[i]);
  }
}

/// A film is a vertex whose kernel is the cosine: the photon that starts by it shares what lights
/// bring with another, which starts towards them.
template <int N, class Estimator, bool Media>
void start_towards_lights(Batch<N, Estimator, Media>& batch, Vec3 film_normal) {
  const LightSampler& lights = batch.scene.lights;
  if (lights.empty()) return;
  Group<N>& by_cosine = batch.groups.back();
  const LightSamplingContext here{
      .position = by_cosine.ray.origin,
      .normal = film_normal,
      .time = batch.sample_of(by_cosine).time,
      .visible_sky = lights.visible_sky().find(by_cosine.ray.origin, film_normal)};
  const auto density = [&](Vec3 direction) {
    return std::max(0.0f, dot(film_normal, direction)) / kPi;
  };
  by_cosine.mis = {MisTechnique::kKernel, here, by_cosine.ray.direction,
                   density(by_cosine.ray.direction)};
  PhotonSequence sequence = by_cosine.sequence.branch(1);
  const Uniform4 u = sequence.next();
  const auto drawn = lights.sample(here, u[2], u[0], u[1]);
  if (!drawn || !(density(drawn->direction) > 0.0f)) return;
  Group<N> photon = by_cosine;
  photon.sequence = sequence;
  photon.ray.direction = drawn->direction;
  photon.weight *= Spectral<N>(density(drawn->direction));
  photon.mis = {MisTechnique::kLights,     here,       drawn->direction,
                density(drawn->direction), drawn->pdf, worth_outside(batch, photon)};
  batch.groups.push_back(photon);
}

}  // namespace nocturne
