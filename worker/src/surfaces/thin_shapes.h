// Shapes whose parts lie close together: panes, films, folded sheets, objects on a
// table.
#pragma once

#include "surfaces/shapes.h"

namespace nocturne {

/// Whether two parts of a shape that face away from each other and are no neighbours may come
/// within `reach` metres of each other. May say yes where they do not; never no where they do. What
/// moves is not looked at: yes.
bool may_be_thin(const Shape& shape, double reach);

/// The same of parts of two shapes that lie along each other: at less than 30 degrees. Of spheres
/// and of what moves only their boxes are known to whoever asks: yes.
bool may_be_close(const Shape& a, const Shape& b, double reach);

}  // namespace nocturne
