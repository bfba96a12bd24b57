// Which daylight coefficients of a compiled scene are counted.
#pragma once

#include <optional>

#include "nocturne/v1/scene.pb.h"
#include "scene/daylight_coefficients.h"
#include "scene/scene.h"

namespace nocturne {

/// None of most scenes. Else the loaded scene is changed so that photons tell what they meet.
/// Throws SceneError.
std::optional<DaylightCoefficients> load_daylight(const v1::CompiledScene& message, Scene& scene);

}  // namespace nocturne
