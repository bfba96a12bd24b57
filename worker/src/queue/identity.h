// Who a worker is to the coordinator.
#pragma once

#include <string>

namespace nocturne {

/// The machine that it enrolled as, and the key that it signs results with; empty without
/// enrolment.
struct Identity {
  std::string machine;
  std::string key;
};

}  // namespace nocturne
