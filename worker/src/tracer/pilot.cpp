#include "tracer/pilot.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <exception>
#include <mutex>
#include <thread>

namespace nocturne {
namespace {

/// Independent images by each way, and samples of a pixel in each of them.
constexpr std::uint32_t kImages = 4, kSamples = 16;
/// Part of the render's samples that a pilot takes, their most, and the most rays.
constexpr double kPart = 0.025, kMostSamples = 1.5e6, kMostRays = 12e6;
/// Edge of the squares of the film, pixels, in which neighbours share.
constexpr std::uint32_t kSquare = 16;
/// Of an occlusion query between neighbours, and of a forward photon's ray with its connection to
/// the camera and its place on the film, in rays of adjoint photons: measured, docs/decisions/0062.
constexpr double kQueryCost = 0.7, kForwardCost = 1.5;
/// Half an edge of the neighbourhood, pixels, whose mean is taken for what its middle shows: a
/// pixel's own samples are so few that one bright one would hide how far it is off.
constexpr std::uint32_t kAround = 3;
/// A way is left for another that is so much better; sharing is judged by a few squares of the
/// film.
constexpr double kWorthIt = 1.25, kSharingWorthIt = 1.5;
/// Standard errors between two means that are told apart; of four images, so few are not enough.
constexpr double kApart = 5.0;
/// Forward photons whose mean is less certain have hardly found the sensor yet.
constexpr double kCertain = 0.2;

/// Sums of each image, square by square of the film.
using Images = std::vector<std::vector<TileSums>>;

class Pilot {
 public:
  Pilot(Scene& scene, const PilotRequest& request)
      : scene_(scene), request_(request), before_(scene.options), budget_(samples()) {}
  ~Pilot() { scene_.options = before_; }
  Pilot(const Pilot&) = delete;
  Pilot& operator=(const Pilot&) = delete;

  PilotResult run() {
    result_.choice = {Direction::kAdjoint, 1, false, 1.0, false};
    if (!request_.direction) {
      result_.choice.direction = before_.direction;
      result_.choice.aimed = before_.aimed_emission > 0.0f;
    }
    if (request_.direction && forward_can_bring()) choose_direction();
    if (request_.sharing && result_.choice.direction != Direction::kForward &&
        before_.estimator == Estimator::kTwoPhotons) {
      choose_sharing();
    }
    return result_;
  }

 private:
  /// Samples in all that the pilot may take.
  double samples() {
    const double pixels = static_cast<double>(request_.film.width) * request_.film.height;
    const double part = std::min(kPart * pixels * request_.samples, kMostSamples);
    // What a sample takes, by a few of them.
    const Film small = reduced(256.0);
    const Images probe = images(Direction::kAdjoint, 1, small, whole(small), 1);
    const double taken = pixels_of(small) * kSamples;
    return std::min(part, kMostRays / std::max(1.0, rays_of(probe) / taken));
  }

  bool forward_can_bring() const {
    return before_.direction == Direction::kForward ||
           std::ranges::find(scene_.specular_like, true) != scene_.specular_like.end();
  }

  void choose_direction() {
    std::vector<bool> aims{before_.aimed_emission > 0.0f};
    if (request_.aim && aims.front()) aims.push_back(false);
    const auto ways = static_cast<double>(2 + aims.size());
    const Film film = reduced(budget_ / 2 / (ways * kImages * kSamples));
    const auto square = whole(film);
    const Images all = images(Direction::kAdjoint, 1, film, square);
    Images rest, left = all;
    if (before_.direction == Direction::kBoth) {
      rest = images(Direction::kBoth, 1, film, square);
      for (std::uint32_t i = 0; i < kImages; ++i) {
        for (std::size_t s = 0; s < left[i][0].sums.size(); ++s) {
          left[i][0].sums[s] -= rest[i][0].sums[s];
        }
      }
    }
    std::vector<Images> forward;
    for (const bool aimed : aims) {
      scene_.options.aimed_emission = aimed ? before_.aimed_emission : 0.0f;
      forward.push_back(images(before_.direction, 1, film, square, kImages, true));
    }
    const Images& best = *std::ranges::min_element(
        forward, {}, [](const Images& each) { return mean_and_error(each)[1]; });
    const std::vector<double> shown = shown_by({&all}, {&rest, &best});
    const PilotFigures adjoint = figures(PilotFigures::kAdjoint, 1, all, shown);
    PilotFigures others{.photons = PilotFigures::kAdjointOfBoth};
    if (!rest.empty()) others = figures(PilotFigures::kAdjointOfBoth, 1, rest, shown);
    const PilotFigures left_to_them = figures(PilotFigures::kAdjoint, 1, left, shown);
    result_.tried = {adjoint};
    if (!rest.empty()) result_.tried.push_back(others);
    for (std::size_t i = 0; i < aims.size(); ++i) {
      PilotFigures found = figures(PilotFigures::kForward, 1, forward[i], shown);
      found.aimed = aims[i];
      found.cost *= kForwardCost;
      result_.tried.push_back(found);
      const ForwardPays pays = forward_pays(adjoint, others, left_to_them, found);
      const double gain = adjoint.relative_mse * adjoint.cost /
                          ((others.relative_mse + found.relative_mse) * (others.cost + found.cost));
      const bool better =
          result_.choice.direction == Direction::kAdjoint || gain > result_.choice.gain;
      if (pays == ForwardPays::kNot || !better) continue;
      forward_ = found;
      result_.choice = {before_.direction, 1, found.aimed, gain, pays == ForwardPays::kFindsMore};
    }
  }

  void choose_sharing() {
    const double squares = budget_ / 2 / (2 * kImages * kSamples) / (kSquare * kSquare);
    const auto film = some_squares(std::max(1.0, squares));
    const Direction direction = result_.choice.direction;
    const Images alone = images(direction, 1, request_.film, film);
    const Images shared = images(direction, 16, request_.film, film);
    const std::vector<double> shown = shown_by({&alone}, {&shared});
    const PilotFigures one = figures(PilotFigures::kSharing, 1, alone, shown);
    PilotFigures sixteen = figures(PilotFigures::kSharing, 16, shared, shown);
    sixteen.cost = one.cost + kQueryCost * (sixteen.cost - one.cost);
    result_.tried.insert(result_.tried.end(), {one, sixteen});
    const double gain = efficiency_with_forward(sixteen) / efficiency_with_forward(one);
    if (!(gain > kSharingWorthIt)) return;
    result_.choice.sharing = 16;
    result_.choice.gain *= gain;
  }

  double efficiency_with_forward(const PilotFigures& sensor) const {
    return 1.0 / ((sensor.relative_mse + forward_.relative_mse) * (sensor.cost + forward_.cost));
  }

  static double pixels_of(Film film) { return static_cast<double>(film.width) * film.height; }

  /// The same view in so many pixels, about.
  Film reduced(double pixels) const {
    const double scale =
        std::sqrt(std::min(1.0, std::max(16.0, pixels) / pixels_of(request_.film)));
    const auto edge = [&](std::uint32_t full) {
      return std::max(1u, static_cast<std::uint32_t>(std::lround(scale * full)));
    };
    return {edge(request_.film.width), edge(request_.film.height)};
  }

  static std::vector<TileRange> whole(Film film) {
    return {{0, 0, film.width, film.height, 0, kSamples}};
  }

  /// Squares of the render's film, spread over it (by the golden ratio).
  std::vector<TileRange> some_squares(double wanted) const {
    const auto [width, height] = request_.film;
    const std::uint32_t columns = (width + kSquare - 1) / kSquare;
    const std::uint32_t all = columns * ((height + kSquare - 1) / kSquare);
    const auto count = static_cast<std::uint32_t>(std::min<double>(wanted, all));
    std::vector<TileRange> squares;
    for (std::uint32_t i = 0; i < count; ++i) {
      double unused;
      const double part = std::modf((i + 0.5) * 0.6180339887498949, &unused);
      const std::uint32_t index = count == all ? i : static_cast<std::uint32_t>(part * all);
      const std::uint32_t x = index % columns * kSquare, y = index / columns * kSquare;
      squares.push_back(
          {x, y, std::min(kSquare, width - x), std::min(kSquare, height - y), 0, kSamples});
    }
    return squares;
  }

  /// Independent images of some squares of a film.
  Images images(Direction direction, std::uint32_t sharing, Film film,
                const std::vector<TileRange>& squares, std::uint32_t count = kImages,
                bool from_luminaires = false) {
    scene_.options.direction = direction;
    scene_.options.sharing = sharing;
    Images made;
    for (std::uint32_t image = 0; image < count; ++image) {
      scene_.options.seed = before_.seed + image;
      made.push_back(squares_of(film, squares, from_luminaires));
      for (const TileSums& sums : made.back()) {
        result_.photons += sums.photons;
        result_.rays += sums.rays;
      }
    }
    return made;
  }

  std::vector<TileSums> squares_of(Film film, const std::vector<TileRange>& squares,
                                   bool from_luminaires) const {
    std::vector<TileSums> made(squares.size(), TileSums(0, 0, 0));
    std::atomic<std::size_t> next = 0;
    std::exception_ptr failure;
    std::mutex mutex;
    const auto work = [&] {
      try {
        for (std::size_t i = next++; i < squares.size(); i = next++) {
          made[i] = from_luminaires ? trace_from_luminaires(scene_, film, squares[i])
                                    : trace_from_sensor(scene_, film, squares[i]);
        }
      } catch (...) {
        next = squares.size();
        const std::lock_guard lock(mutex);
        if (!failure) failure = std::current_exception();
      }
    };
    {
      std::vector<std::jthread> pool;
      const auto most = static_cast<unsigned>(squares.size());
      for (unsigned i = 1; i < std::min(request_.threads, most); ++i) pool.emplace_back(work);
      work();
    }
    if (failure) std::rethrow_exception(failure);
    return made;
  }

  static double rays_of(const Images& images) {
    double rays = 0.0;
    for (const auto& image : images) {
      for (const TileSums& sums : image) rays += static_cast<double>(sums.rays);
    }
    return rays;
  }

  /// f(place among all pixels, Y) for an image.
  template <class F>
  static void for_each_pixel(const std::vector<TileSums>& image, const F& f) {
    std::size_t place = 0;
    for (const TileSums& sums : image) {
      for (std::size_t at = 1; at < sums.sums.size(); at += sums.channels) {
        f(place++, sums.sums[at] / kSamples);
      }
    }
  }

  /// Y around each pixel: of two ways, each of which is a sum of images, by what is certain of
  /// their means.
  static std::vector<double> shown_by(const std::vector<const Images*>& one,
                                      const std::vector<const Images*>& other) {
    const double certain = 1.0 / square_of_error(one), other_certain = 1.0 / square_of_error(other);
    const bool both = std::isfinite(certain) && std::isfinite(other_certain);
    const double weight = both ? certain / (certain + other_certain) : 0.5;
    std::vector<TileSums> mean = weighted(one, weight);
    const std::vector<TileSums> rest = weighted(other, 1.0 - weight);
    std::vector<double> around;
    for (std::size_t i = 0; i < mean.size(); ++i) {
      mean[i] += rest[i];
      for (std::uint32_t y = 0; y < mean[i].height; ++y) {
        for (std::uint32_t x = 0; x < mean[i].width; ++x)
          around.push_back(mean_around(mean[i], x, y));
      }
    }
    return around;
  }

  static double square_of_error(const std::vector<const Images*>& way) {
    double square = 0.0;
    for (const Images* images : way) square += std::pow(mean_and_error(*images)[1], 2);
    return square;
  }

  /// Mean of the images of each part, all parts added up, times `weight`.
  static std::vector<TileSums> weighted(const std::vector<const Images*>& way, double weight) {
    std::vector<TileSums> sum;
    for (const Images* images : way) {
      for (const auto& image : *images) {
        std::vector<TileSums> part = image;
        for (TileSums& square : part) {
          for (double& value : square.sums) value *= weight / static_cast<double>(images->size());
        }
        if (sum.empty()) {
          sum = std::move(part);
        } else {
          for (std::size_t i = 0; i < sum.size(); ++i) sum[i] += part[i];
        }
      }
    }
    return sum;
  }

  static double mean_around(const TileSums& image, std::uint32_t x, std::uint32_t y) {
    const auto from = [](std::uint32_t at) { return at < kAround ? 0 : at - kAround; };
    const std::uint32_t end_x = std::min(image.width, x + kAround + 1);
    const std::uint32_t end_y = std::min(image.height, y + kAround + 1);
    double sum = 0.0, pixels = 0.0;
    for (std::uint32_t row = from(y); row < end_y; ++row) {
      for (std::uint32_t column = from(x); column < end_x; ++column) {
        sum += image.sums[(std::size_t{row} * image.width + column) * image.channels + 1];
        ++pixels;
      }
    }
    return sum / pixels / kSamples;
  }

  /// Of Y over all pixels, and its standard error by how the images differ.
  static std::array<double, 2> mean_and_error(const Images& images) {
    std::vector<double> means;
    for (const auto& image : images) {
      double total = 0.0;
      std::size_t pixels = 0;
      for_each_pixel(image, [&](std::size_t, double y) {
        total += y;
        ++pixels;
      });
      means.push_back(total / static_cast<double>(pixels));
    }
    const auto count = static_cast<double>(means.size());
    double mean = 0.0, squares = 0.0;
    for (const double each : means) mean += each / count;
    for (const double each : means) squares += (each - mean) * (each - mean);
    return {mean, std::sqrt(squares / (count - 1.0) / count)};
  }

  static PilotFigures figures(PilotFigures::Photons photons, std::uint32_t sharing,
                              const Images& images, const std::vector<double>& shown) {
    const auto pixels = static_cast<double>(shown.size());
    const auto count = static_cast<double>(images.size());
    std::vector<double> sums(shown.size()), squares(shown.size());
    for (const auto& image : images) {
      for_each_pixel(image, [&](std::size_t pixel, double y) {
        sums[pixel] += y;
        squares[pixel] += y * y;
      });
    }
    double all = 0.0;
    for (const double y : shown) all += y / pixels;
    const auto [mean, error] = mean_and_error(images);
    PilotFigures found{.photons = photons, .sharing = sharing, .mean = mean, .mean_error = error};
    for (std::size_t pixel = 0; pixel < shown.size(); ++pixel) {
      const double variance =
          std::max(0.0, squares[pixel] - sums[pixel] * sums[pixel] / count) / (count - 1.0);
      const double scale = shown[pixel] * shown[pixel] + 0.01 * all * all;
      if (scale > 0.0) found.relative_mse += kSamples * variance / scale / pixels;
    }
    found.cost = rays_of(images) / (pixels * count * kSamples);
    return found;
  }

  Scene& scene_;
  const PilotRequest request_;
  const TracingOptions before_;
  PilotResult result_{};
  /// Of forward photons, where they take part.
  PilotFigures forward_{.photons = PilotFigures::kForward};
  const double budget_;
};

}  // namespace

ForwardPays forward_pays(const PilotFigures& adjoint, const PilotFigures& rest,
                         const PilotFigures& left, const PilotFigures& forward) {
  if (!(forward.mean > 0.0) || forward.mean_error > kCertain * forward.mean) {
    return ForwardPays::kNot;
  }
  // What one of the two has not found at all makes no noise: a way that is too dark only looks
  // good.
  const double apart = kApart * std::hypot(left.mean_error, forward.mean_error);
  if (left.mean - forward.mean > apart) return ForwardPays::kNot;
  if (forward.mean - left.mean > apart) return ForwardPays::kFindsMore;
  return adjoint.relative_mse * adjoint.cost >
                 kWorthIt * (rest.relative_mse + forward.relative_mse) * (rest.cost + forward.cost)
             ? ForwardPays::kLessError
             : ForwardPays::kNot;
}

PilotResult run_pilot(Scene& scene, const PilotRequest& request) {
  return Pilot(scene, request).run();
}

}  // namespace nocturne
