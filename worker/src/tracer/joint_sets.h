// Which sets of a photon's numbers are dimensions of one sequence: those of questions that jointly
// decide the light it brings (docs/decisions/0097). A photon has one set at each vertex, and
// numbers towards lights come from branch 1 behind it.
#pragma once

#include "sampling/sequence.h"

namespace nocturne {

/// Vertices are counted from 1; `before` is the number of sets that were used by then.
constexpr std::uint32_t set_of_direction(std::uint32_t before, std::uint32_t vertex) {
  return before + vertex - 1;
}
constexpr std::uint32_t set_of_light(std::uint32_t before, std::uint32_t vertex) {
  return PixelSequence::set_of_branch(1, before + vertex);
}

/// Where in the pixel and on the lens, in `before` sets, and which point of a light lights the
/// first vertex, or the film itself. Alike for all pixels, as those of a block have the wavelengths
/// and the time of one.
constexpr JointSets joint_sets_of_pixel(std::uint32_t before, bool lights_film) {
  const std::uint32_t light = set_of_light(before, lights_film ? 0 : 1);
  return before == 1 ? JointSets{{0, light}, 2, true} : JointSets{{0, 1, light}, 3, true};
}

/// Of the photons of a block, from their first vertices on: in which direction to the second ones,
/// and by which light these are lit or where the photons go on.
constexpr JointSets joint_sets_of_block(std::uint32_t before) {
  return {{set_of_direction(before, 1), set_of_light(before, 2), set_of_direction(before, 2)}, 3};
}

/// Where and whither photons are emitted, and then with which wavelength, when and by what.
inline constexpr JointSets kJointSetsOfEmission{{1, 2, 0}, 3};

}  // namespace nocturne
