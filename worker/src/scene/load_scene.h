// From the compiled scene message to the scene that is traced: the one place that reads it.
#pragma once

#include <memory>
#include <stop_token>

#include "nocturne/v1/scene.pb.h"
#include "scene/scene.h"
#include "scene/scene_error.h"

namespace nocturne {

/// Every index, count and number is checked before memory is taken. Throws SceneError, also soon
/// after a stop is requested.
std::shared_ptr<Scene> load_scene(const v1::CompiledScene& message, const FindBlob& find_blob,
                                  std::stop_token stop = {});

}  // namespace nocturne
