// The members of PixelBatches, for the files that instantiate it.
#pragma once

#include "math/in_place.h"
#include "tracer/joint_sets.h"
#include "tracer/photon_loop.h"
#include "tracer/pixel_batches.h"
#include "tracer/response.h"
#include "tracer/sharing/sharing_blocks.h"

namespace nocturne {

/// Whose numbers: a pixel's, or a block's by its first pixel; of these, those that replace its
/// pixels' own. Films are smaller.
inline constexpr std::uint32_t kOfBlock = 1u << 31, kInPlaceOfOwn = 1u << 30;

template <int N, bool Media, bool Polarised>
PixelBatches<N, Media, Polarised>::PixelBatches(const Scene& scene, Film film, std::uint32_t most,
                                                const std::stop_token& stop)
    : scene_(scene),
      film_(film),
      small_lights_(scene, film),
      estimator_(scene),
      batch_(scene, estimator_, stop) {
  sequences_.reserve(2 * static_cast<std::size_t>(most));  // groups point to them
}

/// Of responses that are sums of others, which polarised scenes alone have. Apart, so that `trace`
/// has the branches that its profile knows.
template <bool Polarised>
void put_sums(const WavelengthSampler& wavelengths, double* values) {
  if constexpr (Polarised) wavelengths.put_sums(values);
}

template <int N, bool Media, bool Polarised>
void PixelBatches<N, Media, Polarised>::trace(std::span<const PixelIndex> samples, TileSums& counts,
                                              double* values) {
  batch_.clear();
  samples_.clear();
  sequences_.clear();
  pixels_.clear();
  estimator_.reset(samples.size());
  const bool shares = scene_.options.sharing > 1;
  if (shares) batch_.sharing.firsts.resize(samples.size());
  PixelNumbers common{};
  WavelengthSamples<N> wavelengths{};
  std::uint32_t place = 0, leader = 0;  // in the block; the pixel of its first place
  for (std::uint32_t i = 0; i < samples.size(); ++i) {
    const PixelIndex& at = samples[i];
    PhotonSequence sequence(sequence_of(at.y * film_.width + at.x), at.sample);
    PixelNumbers numbers = next_pixel_numbers(scene_, sequence);
    if (shares) {
      place = at.leads ? 0 : place + 1;
      if (at.leads) {
        batch_.sharing.blocks.push_back(i);
        leader = at.y * film_.width + at.x;
      }
      PhotonSequence of_block(sequence_of(leader | kOfBlock), number_in_block(at.sample, place));
      skip_pixel_numbers(scene_, of_block);
      if (at.leads) {
        PhotonSequence in_place(sequence_of(leader | kOfBlock | kInPlaceOfOwn), at.sample);
        common = next_pixel_numbers(scene_, in_place);
      }
      numbers.time = common.time;
      batch_.sharing.sequences.push_back(of_block);
    }
    // All of a block have the same: they are computed once.
    if (at.leads) {
      wavelengths = scene_.wavelengths.template sample<N>((shares ? common : numbers).wavelengths);
    }
    const float weight = small_lights_.move(at.y * film_.width + at.x, numbers.x, numbers.y);
    samples_.emplace_back(
        InPlace{[&] { return sample_pixel(scene_, film_, at.x, at.y, numbers, wavelengths); }});
    samples_.back().weight *= weight;
    start(batch_, samples_.back().start, sequence);
  }
  trace_batch(batch_);
  counts.rays += batch_.rays;
  counts.truncated_paths += batch_.limits.truncated();
  for (std::size_t i = 0; i < samples.size(); ++i, values += counts.values()) {
    const Response<N> response(scene_.wavelengths, samples_[i].wavelengths);
    counts.invalid_samples += response.add(
        estimator_.radiance(i),
        [&](const CountedLight& light) { return estimator_.radiance(i, light); },
        samples_[i].weight, values);
    put_sums<Polarised>(scene_.wavelengths, values);
  }
}

/// Samples of one pixel, or of one block, come one after the other, and the pixels of a block
/// always in the same order.
template <int N, bool Media, bool Polarised>
PixelSequence& PixelBatches<N, Media, Polarised>::sequence_of(std::uint32_t pixel) {
  constexpr std::size_t kLookBack = 2 * kSharingPixels;
  const auto known = [&](std::size_t i) { return i < pixels_.size() && pixels_[i] == pixel; };
  if (known(latest_ + 1)) return sequences_[++latest_];
  const std::size_t end = pixels_.size(), begin = end > kLookBack ? end - kLookBack : 0;
  for (std::size_t i = begin; i < end; ++i) {
    if (known(i)) return sequences_[latest_ = i];
  }
  latest_ = end;
  pixels_.push_back(pixel);
  const std::uint32_t before = sets_of_pixel(scene_);
  const bool on_its_way = (pixel & (kOfBlock | kInPlaceOfOwn)) == kOfBlock;
  const bool lights_film = scene_.sensor.aims();
  const JointSets joint =
      on_its_way ? joint_sets_of_block(before) : joint_sets_of_pixel(before, lights_film);
  return sequences_.emplace_back(scene_.options.sequence, scene_.options.seed, pixel, joint);
}

}  // namespace nocturne
