// Parts of an image in which light may be missing without a sign: few and bright lamps, seen or
// thrown there by mirrors and glass, that a sample finds so rarely that a square of pixels may have
// met none of it and look certain.
#pragma once

#include <cstdint>
#include <vector>

#include "tracer/pilot/trials.h"

namespace nocturne {

/// A rectangle of the film, pixels.
struct UnmetPart {
  std::uint32_t x, y, width, height;
  /// The light that may be missing at most (two standard errors), in parts of the light seen there.
  double part;
};

/// `kind`: photons from the sensor as they were chosen, so that forward ones bring their part; here
/// they do not share.
/// `film` and `samples`: of the render; `budget`: samples in all that may be taken; `mean`: Y of
/// the image, cd/m2. Empty where no luminaire is so bright that finds are rare, or all is met.
std::vector<UnmetPart> find_unmet_parts(Scene& scene, Trials& trials, PhotonKind kind, Film film,
                                        std::uint32_t samples, double budget, double mean);

}  // namespace nocturne
