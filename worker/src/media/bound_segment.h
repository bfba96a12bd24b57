#pragma once

namespace nocturne {

/// A density is at most `most` from where the segment before ended to `end` metres along a ray.
struct BoundSegment {
  float end, most;
};

}  // namespace nocturne
