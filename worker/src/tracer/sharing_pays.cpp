#include "tracer/sharing_pays.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "tracer/forward_pays.h"

namespace nocturne {
namespace {

/// Votes are plain where all parts but one gain so many times more than they have to, or so many
/// times less: somebody waits for the pilot, and one part of five does not move the median.
constexpr double kPlain = 1.25;

/// Squares of which the error of a mean must be made, and part of the mean that counts.
constexpr double kDiffers = 0.01;
constexpr std::size_t kFewest = 6;

double square(double x) { return x * x; }

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

double means_differ(std::span<const double> alone, std::span<const double> shared) {
  const std::size_t squares = std::min(alone.size(), shared.size());
  if (squares < kFewest) return 0.0;
  const auto count = static_cast<double>(squares);
  double mean = 0.0, more = 0.0, spread = 0.0;
  for (std::size_t i = 0; i < squares; ++i) {
    mean += alone[i] / count;
    more += (shared[i] - alone[i]) / count;
  }
  for (std::size_t i = 0; i < squares; ++i) spread += square(shared[i] - alone[i] - more);
  const double error = std::sqrt(spread / (count - 1.0) / count);
  const bool differ = std::fabs(more) > std::max(kApart * error, kDiffers * mean);
  return differ && mean > 0.0 ? more / mean : 0.0;
}

bool votes_are_plain(std::span<const double> gains, double worth_it) {
  const auto but_one = static_cast<std::ptrdiff_t>(gains.size()) - 1;
  const auto pays = [=](double gain) { return gain > kPlain * worth_it; };
  const auto loses = [=](double gain) { return gain < worth_it / kPlain; };
  return (std::ranges::count_if(gains, pays) >= but_one && !lose_together(gains)) ||
         std::ranges::count_if(gains, loses) >= but_one;
}

}  // namespace nocturne
