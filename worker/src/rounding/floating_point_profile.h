// A name for how this process computes: processes of one class give equal bits for the same job.
//
// The C library chooses its functions by the processor, and its versions round differently; so do
// versions of Embree. The engine number can't know either, and images must not be mixed of both
// (docs/decisions/0034).
#pragma once

#include <string>

namespace nocturne {

/// 16 hexadecimal digits: a digest of what a fixed probe answers here. Takes some milliseconds;
/// throws std::runtime_error where Embree can't start.
std::string floating_point_profile();

}  // namespace nocturne
