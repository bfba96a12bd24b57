// Whether pixels that share pay, by what a pilot measured in parts of the film
// (docs/decisions/0062-ways-are-chosen-by-a-pilot.md).
#pragma once

#include <optional>
#include <span>
#include <vector>

namespace nocturne {

/// How many times less time sharing takes to the same error; nothing where it does not pay.
///
/// `gains`: the same of each part, above 0. A single bright sample may decide about the whole, so
/// parts vote: most of them must gain more than `worth_it`. Nor may sharing lose by all of them
/// together, each with as much noise as the others: where it gains a little in most and spreads
/// rare bright samples in one, it loses.
std::optional<double> sharing_pays(std::vector<double> gains, double worth_it);

/// By how much the mean of all squares differs, `shared` over `alone` less 1, where that is beyond
/// what these squares spread; else 0. Both show the same light.
double means_differ(std::span<const double> alone, std::span<const double> shared);

/// Whether one part more or less would change nothing.
bool votes_are_plain(std::span<const double> gains, double worth_it);

}  // namespace nocturne
