// What absorbs at some wavelengths and emits at others, read from the compiled scene.
#pragma once

#include "kernels/fluorescent.h"
#include "scene/load_context.h"

namespace nocturne {

/// Excited by wavelengths of the scene.
Fluorophore load_fluorophore(const LoadContext& context,
                             const v1::Fluorescent::Fluorophore& message);

}  // namespace nocturne
