#include "tracer/layers.h"

#include <algorithm>
#include <optional>

#include "spectrum/srgb.h"
#include "tracer/by_threads.h"
#include "tracer/line_of_sight.h"
#include "tracer/pixel_sample.h"

namespace nocturne {
namespace {

/// Wavelengths of a sample, which is enough for colours of surfaces.
constexpr int kWavelengths = 8;

using Wavelengths = WavelengthSamples<kWavelengths>;
using Weights = std::array<Spectral<kWavelengths>, 3>;

Weights rgb_weights(const Wavelengths& wavelengths) {
  Weights weights;
  for (std::size_t i = 0; i < 3; ++i) {
    weights[i] = kRgbOfXyz[i][0] * wavelengths.weight[0] + kRgbOfXyz[i][1] * wavelengths.weight[1] +
                 kRgbOfXyz[i][2] * wavelengths.weight[2];
  }
  return weights;
}

/// The first surface on a ray that does not let it straight through.
struct Seen {
  Hit hit;
  std::uint32_t kernel;
  Vec3 normal;
  /// From the sensor, metres.
  float distance;
  Spectral<kWavelengths> albedo;
};

/// `next(sequence)` gives the numbers that choose what a surface does. Notes if a luminaire's light
/// is met.
template <class Next>
std::optional<Seen> first_seen(const Scene& scene, const Start<kWavelengths>& start,
                               PhotonSequence sequence, const Next& next, bool& met_light) {
  LineOfSight line(scene, start, sequence);
  while (const auto* vertex = line.next()) {
    const std::uint32_t luminaire = scene.materials[vertex->hit.surface].luminaire;
    met_light = met_light || (luminaire != SurfaceMaterial::kNone &&
                              scene.emits(scene.luminaires[luminaire], vertex->hit,
                                          -line.direction(), start.time));
    const Uniform4 u = next(sequence);
    std::optional<Seen> seen;
    visit_bound(scene.kernels, vertex->kernel, vertex->shading, [&](const auto& kernel) {
      const auto draw = kernel.sample(vertex->wo, {u[3], u[0], u[1]}, 0);
      if (draw && draw->delta && draw->wi == -vertex->wo) return;
      seen = Seen{vertex->hit, vertex->kernel, vertex->frame.normal, line.distance(),
                  kernel.albedo(vertex->wo)};
    });
    if (seen) return seen;
    line.continue_along(-vertex->wo);
  }
  return std::nullopt;
}

/// Layers of single pixels.
class LayerTracer {
 public:
  LayerTracer(const Scene& scene, Film film, std::uint32_t samples)
      : scene_(scene), film_(film), samples_(samples) {
    for (std::uint32_t i = 0; i < samples; ++i) {
      const Weights weights = rgb_weights(wavelengths_of(i));
      for (std::size_t c = 0; c < 3; ++c) white_[c] += sum(weights[c]);
    }
  }

  PixelLayers trace(std::uint32_t x, std::uint32_t y) const {
    PixelLayers layers;
    PixelSequence numbers(scene_.options.sequence, scene_.options.seed, y * film_.width + x);
    look_at_middle(x, y, numbers, layers);
    for (std::uint32_t i = 0; i < samples_; ++i) {
      PhotonSequence sequence(numbers, i);
      PixelNumbers from = next_pixel_numbers(scene_, sequence);
      from.wavelengths = place_of(i);
      add_sample(sample_pixel<kWavelengths>(scene_, film_, x, y, from), sequence, layers);
    }
    return layers;
  }

 private:
  /// Of a sample's wavelengths: all samples of a pixel together take evenly spread ones.
  float place_of(std::uint32_t sample) const {
    return (static_cast<float>(sample) + 0.5f) / static_cast<float>(samples_ * kWavelengths);
  }
  Wavelengths wavelengths_of(std::uint32_t sample) const {
    return scene_.wavelengths.sample<kWavelengths>(place_of(sample));
  }

  void look_at_middle(std::uint32_t x, std::uint32_t y, PixelSequence& numbers,
                      PixelLayers& layers) const {
    const auto sample =
        sample_pixel<kWavelengths>(scene_, film_, x, y, {0.5f, 0.5f, 0.0f, 0.5f, 0.5f, 0.5f});
    bool met_light = false;
    const auto middle = [](PhotonSequence&) { return Uniform4{0.5f, 0.5f, 0.5f, 0.5f}; };
    const auto seen =
        first_seen(scene_, sample.start, PhotonSequence(numbers, 0), middle, met_light);
    if (!seen) return;
    const Hit& hit = seen->hit;
    layers.depth = seen->distance;
    layers.position = {hit.position.x, hit.position.y, hit.position.z};
    const auto surfaces = scene_.surface_of(0);
    layers.object = static_cast<float>(
        1 + (hit.instance == Hit::kNoInstance ? hit.surface : surfaces + hit.instance));
    layers.material = static_cast<float>(1 + seen->kernel);
  }

  void add_sample(const PixelSample<kWavelengths>& sample, const PhotonSequence& sequence,
                  PixelLayers& layers) const {
    bool met_light = false;
    const auto next = [](PhotonSequence& its) { return its.next(); };
    const auto seen = first_seen(scene_, sample.start, sequence, next, met_light);
    const float part = 1.0f / static_cast<float>(samples_);
    if (met_light) layers.emission += part;
    if (!seen) return;
    const Weights weights = rgb_weights(sample.wavelengths);
    const std::array<float, 3> normal{seen->normal.x, seen->normal.y, seen->normal.z};
    for (std::size_t c = 0; c < 3; ++c) {
      if (white_[c] > 0.0f) layers.albedo[c] += sum(weights[c] * seen->albedo) / white_[c];
      layers.normal[c] += part * normal[c];
    }
  }

  const Scene& scene_;
  Film film_;
  std::uint32_t samples_;
  /// What a surface that reflects everything gives, over all samples.
  std::array<float, 3> white_{};
};

}  // namespace

std::vector<PixelLayers> trace_layers(const Scene& scene, Film film, std::uint32_t samples,
                                      unsigned threads) {
  const LayerTracer tracer(scene, film, std::max(1u, samples));
  std::vector<PixelLayers> layers(std::size_t{film.width} * film.height);
  by_threads(film.height, threads, [&](std::size_t row) {
    const auto y = static_cast<std::uint32_t>(row);
    for (std::uint32_t x = 0; x < film.width; ++x) {
      layers[row * film.width + x] = tracer.trace(x, y);
    }
  });
  return layers;
}

}  // namespace nocturne
