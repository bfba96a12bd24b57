#include "tracer/sharing_pays.h"

#include <algorithm>
#include <cstddef>

namespace nocturne {
namespace {

/// Votes are plain where all parts but one gain so many times more than they have to, or so many
/// times less: somebody waits for the pilot, and one part of five does not move the median.
constexpr double kPlain = 1.25;

bool lose_together(std::span<const double> gains) {
  double inverses = 0.0;
  for (const double gain : gains) inverses += 1.0 / gain;
  return inverses >= static_cast<double>(gains.size());
}

}  // namespace

std::optional<double> sharing_pays(std::vector<double> gains, double worth_it) {
  if (gains.empty() || lose_together(gains)) return std::nullopt;
  // Of an even number the lower middle.
  const auto middle = gains.begin() + static_cast<std::ptrdiff_t>((gains.size() - 1) / 2);
  std::ranges::nth_element(gains, middle);
  return *middle > worth_it ? std::optional(*middle) : std::nullopt;
}

bool votes_are_plain(std::span<const double> gains, double worth_it) {
  const auto but_one = static_cast<std::ptrdiff_t>(gains.size()) - 1;
  const auto pays = [=](double gain) { return gain > kPlain * worth_it; };
  const auto loses = [=](double gain) { return gain < worth_it / kPlain; };
  return (std::ranges::count_if(gains, pays) >= but_one && !lose_together(gains)) ||
         std::ranges::count_if(gains, loses) >= but_one;
}

}  // namespace nocturne
