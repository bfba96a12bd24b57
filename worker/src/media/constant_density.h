// A density that is the same everywhere: free flights have a closed form.
#pragma once

namespace nocturne {

struct ConstantDensity {
  float value;
};

}  // namespace nocturne
