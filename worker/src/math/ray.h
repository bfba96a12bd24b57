#pragma once

#include "math/vec3.h"

namespace nocturne {

struct Ray {
  Vec3 origin;
  /// Unit length.
  Vec3 direction;
};

}  // namespace nocturne
