#pragma once

#include <vector>

#include "kernels/any_kernel.h"
#include "scene/load_context.h"

namespace nocturne {

std::vector<AnyKernel> load_kernels(const LoadContext& context);

/// Whether it has a delta lobe: photons may pass it or be mirrored.
bool has_delta_lobe(const std::vector<AnyKernel>& kernels, std::uint32_t index);
/// Photons may go through.
bool may_pass(const std::vector<AnyKernel>& kernels, std::uint32_t index);

/// For all kernels, of which the message's are the first: whether light that it sends on stays
/// within a narrow cone, so that the surfaces it falls on are better found from the luminaires:
/// glass, mirrors and the like, of a roughness that is 0.3 or less anywhere.
std::vector<bool> load_specular_like(const v1::CompiledScene& message,
                                     const std::vector<AnyKernel>& kernels);
/// Whether a photon may be turned into a single direction, by a mirror, glass or the coat of paint.
bool may_turn_sharply(const std::vector<AnyKernel>& kernels, std::uint32_t index);

/// Whether it varies over the surface or tells directions around the normal apart.
bool needs_detail(const v1::CompiledScene& message, std::uint32_t index);

}  // namespace nocturne
