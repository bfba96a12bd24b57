#pragma once

#include "surfaces/shapes.h"

namespace nocturne {

/// Whether a shape, at its first time, has an inside that its normals point away from: every edge
/// of a mesh is between triangles that run along it in opposite directions, as many in one as in
/// the other. Turned inside out it has all that is around it for an inside, which never ends.
/// Corners are the same where their coordinates are, so that a mesh may have a corner several
/// times. One pass, no memory.
bool is_closed(const Shape& shape);

}  // namespace nocturne
