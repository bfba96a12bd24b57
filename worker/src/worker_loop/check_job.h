// Whether a job is one that may be traced; asked before anything is allocated for it.
#pragma once

#include <stdexcept>

#include "nocturne/v1/job.pb.h"

namespace nocturne {

class JobError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Throws JobError that names the field and its bounds.
void check_job(const v1::Job& job);

}  // namespace nocturne
