#pragma once

#include "surfaces/shapes.h"

namespace nocturne {

/// Whether a shape, at its first time, has an inside: every edge of a mesh is between triangles
/// that run along it in opposite directions, as many in one as in the other. Corners are the same
/// where their coordinates are, so that a mesh may have a corner several times. One pass, no
/// memory.
bool is_closed(const Shape& shape);

}  // namespace nocturne
