// A name for how this process computes: processes of one class give equal bits for the same job.
//
// Versions of Embree and standard libraries may find other hits or put equal elements in another
// order, and a library that was built with fast mathematics may change how the whole process
// rounds. The engine number can't know, and images must not be mixed of both (docs/decisions/0034,
// 0071).
#pragma once

#include <string>

namespace nocturne {

/// 16 hexadecimal digits: a digest of what a fixed probe answers here. Takes some milliseconds;
/// throws std::runtime_error where Embree can't start.
std::string floating_point_profile();

}  // namespace nocturne
