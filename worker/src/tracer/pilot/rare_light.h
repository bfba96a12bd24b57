// Light of few and bright luminaires that mirrors and glass gather: photons from the sensor meet it
// by finds so rare that an image which misses it looks certain.
#pragma once

#include <vector>

#include "tracer/pilot/trials.h"

namespace nocturne {

/// Part of the mean that counts where it is missing: a tenth of the error that most renders are
/// asked for.
constexpr double kCounts = 1e-3;
/// A mean of rare light that is so many standard errors is certain.
constexpr double kSure = 5.0;
/// Standard errors by which two means differ so far that it is reported; and those above the met
/// light up to which there may be more.
constexpr double kStandardErrors = 2.0;

/// The rare light that photons from both ends met. That of the luminaires is the light they would
/// bring; that of the sensor is the same light, where these have to bring it.
struct RareLight {
  MeanLight by_forward, by_adjoint;
};

/// Whether forward photons bring so much of it that others did not meet, or met in much rarer
/// finds: a part of the image's mean that counts. Where the others met nothing at all any find is
/// enough: both directions are right in any case, and their errors say how rare it is.
bool must_be_brought(const RareLight& light, double mean);

/// How much of it may be missing at most (two standard errors) where photons from the sensor bring
/// it, in parts of the image's mean; 0 where both are as certain that they agree.
double may_be_missing(const RareLight& light, double mean);

/// Y of a radiance of 1 at all wavelengths: 683 lm/W, and the integral of the CIE 1931 observer's
/// y, CIE 018:2019.
constexpr double kLuminanceOfOne = 683.0 * 106.857;

/// Radiance from which light is rare in an image of so many samples in all whose mean is Y (cd/m2),
/// W m-2 sr-1 nm-1: one sample that finds it is 1e-4 of the mean, so that a hundredth of the light
/// rests on a hundred finds.
float rare_radiance(double mean, double samples);

struct RareLightTrial {
  /// How much more light photons from luminaires may bring than those from the sensor met, at most
  /// (two standard errors), in parts of the image's mean. Zero where it must be brought.
  double unmet = 0.0;
  /// The methods that bring it, if it must be brought.
  std::vector<PilotMethod> bring_it;
};

/// Rare light hides in the noise of other light: it is looked for alone, by those photons from
/// luminaires in `methods` that are most certain, and by `sensor`, which meet all light by
/// themselves. `images`: of all light on `film`, so many samples of each pixel. `rare`: the
/// radiance from which light is rare; `mean`: Y of the image, cd/m2.
RareLightTrial try_rare_light(Scene& scene, Trials& trials, const std::vector<PilotMethod>& methods,
                              const PhotonKind& sensor, const ImagesOfKind& images, Film film,
                              std::uint32_t samples, float rare, double mean);

}  // namespace nocturne
