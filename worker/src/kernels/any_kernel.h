// The closed set of kernels that a scene may hold: one alternative per model, resolved by one jump
// at a vertex.
#pragma once

#include <variant>

#include "kernels/lambertian.h"

namespace nocturne {

using AnyKernel = std::variant<Lambertian>;

}  // namespace nocturne
