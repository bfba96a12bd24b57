// Kernels that change wavelengths or polarisation, read from the compiled scene; and what scenes
// with them can't have.
#pragma once

#include "kernels/any_kernel.h"
#include "scene/load_context.h"
#include "scene/tracing_options.h"

namespace nocturne {

/// Excited by wavelengths of the scene.
Fluorophores load_fluorophores(
    const LoadContext& context,
    const google::protobuf::RepeatedPtrField<v1::Fluorescent::Fluorophore>& messages);
Fluorescent load_fluorescent(const LoadContext& context, const v1::Fluorescent& message);
PolarisingFilter load_filter(const LoadContext& context, const v1::PolarisingFilter& message);

/// Whether photons are to know how light is polarised.
bool is_polarised(const v1::Sensor& sensor, const std::vector<AnyKernel>& kernels);

/// Photons from luminaires keep their wavelengths and know no polarisation; neighbours share
/// wavelengths, and what they found as if it were unpolarised. Throws SceneError.
void check_special_kernels(const std::vector<AnyKernel>& kernels, bool polarised,
                           const TracingOptions& options);

}  // namespace nocturne
