// A job that a worker has taken, as the job stream knows it.
#pragma once

#include <string>

namespace nocturne {

/// An entry of the job stream, delivered to one consumer of the group.
struct HeldJob {
  std::string consumer;
  std::string entry_id;

  friend bool operator==(const HeldJob&, const HeldJob&) = default;
};

}  // namespace nocturne
