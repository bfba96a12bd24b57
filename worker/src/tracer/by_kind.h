// The tracer is compiled for photons alone and in fours, and for scenes with media and without.
#pragma once

#include "scene/scene.h"

namespace nocturne {

/// f.operator()<N, Media>(): how many photons travel together, and whether the scene has media.
template <class F>
auto by_kind_of(const Scene& scene, const F& f) {
  const auto by_media = [&]<int N>() {
    return scene.media.empty() ? f.template operator()<N, false>()
                               : f.template operator()<N, true>();
  };
  return scene.options.group == 4 ? by_media.template operator()<4>()
                                  : by_media.template operator()<1>();
}

}  // namespace nocturne
