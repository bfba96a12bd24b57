#pragma once

#include "nocturne/v1/scene.pb.h"
#include "scene/scene_error.h"
#include "surfaces/shapes.h"

namespace nocturne {

/// Reads and checks a packed mesh: file length before memory is taken, finite numbers, unit
/// normals, indices in range. Throws SceneError.
TriangleMesh load_mesh(const v1::Mesh& message, const FindBlob& find_blob);

}  // namespace nocturne
