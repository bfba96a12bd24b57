// A job that a worker has taken, as the job stream knows it.
#pragma once

#include <string>

#include "queue/keys.h"

namespace nocturne {

/// An entry of a stream of jobs, delivered to one consumer of the group.
struct HeldJob {
  std::string consumer;
  std::string entry_id;
  std::string stream = keys::kJobs;

  friend bool operator==(const HeldJob&, const HeldJob&) = default;
};

}  // namespace nocturne
