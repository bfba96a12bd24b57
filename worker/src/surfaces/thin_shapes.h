// Shapes whose own parts lie close together: panes, films, sheets that are folded.
#pragma once

#include "surfaces/shapes.h"

namespace nocturne {

/// Whether two parts of a shape that face away from each other and are no neighbours may come within
/// `reach` metres of each other. May say yes where they do not; never no where they do. What moves
/// is not looked at: yes.
bool may_be_thin(const Shape& shape, double reach);

}  // namespace nocturne
