// What leaves the lamp that an intensity meter holds, as rays: a ray file for other programs.
#pragma once

#include <cstdint>
#include <functional>
#include <span>

#include "scene/scene.h"

namespace nocturne {

/// Where a photon leaves the meter's sphere, m, its direction, the power that it stands for, W, and
/// its wavelength, nm.
struct LeavingRay {
  float x, y, z, kx, ky, kz, watts, nm;
};

/// Those of `photons` forward photons, handed on in their order, whatever the threads: the same
/// bits anywhere. Throws std::invalid_argument where photons are not forward ones, or the sensor is
/// no intensity meter.
void trace_rays(const Scene& scene, std::uint64_t photons, unsigned threads,
                const std::function<void(std::span<const LeavingRay>)>& take);

}  // namespace nocturne
