#pragma once

#include <vector>

#include "kernels/any_kernel.h"
#include "scene/load_context.h"
#include "scene/scene.h"

namespace nocturne {

/// Each medium's phase function is added to the kernels, and what a hit on it is made of to the
/// materials.
std::vector<Medium> load_media(const LoadContext& context, std::vector<AnyKernel>& kernels,
                               std::vector<SurfaceMaterial>& materials);

}  // namespace nocturne
