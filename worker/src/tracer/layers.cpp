#include "tracer/layers.h"

#include <algorithm>
#include <optional>

#include "spectrum/srgb.h"
#include "tracer/by_threads.h"
#include "tracer/pixel_sample.h"
#include "tracer/stages/travel.h"
#include "tracer/vertex.h"

namespace nocturne {
namespace {

/// Wavelengths of a sample, which is enough for colours of surfaces.
constexpr int kWavelengths = 8;
/// A ray that passes more holes than this is lost among them.
constexpr int kMaxPasses = 64;

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

/// One sample of a pixel on its way.
class Look {
 public:
  Look(const Scene& scene, const Start<kWavelengths>& start, const PhotonSequence& sequence)
      : scene_(scene), start_(start), group_(sequence) {
    group_.ray = start.ray;
    group_.departure = start.departure;
    group_.inside = start.inside;
    group_.width = start.width;
  }

  /// `numbers` gives those that choose what a surface does.
  template <class Numbers>
  std::optional<Seen> find(const Numbers& numbers) {
    float distance = 0.0f;
    for (int i = 0; i < kMaxPasses; ++i) {
      const auto hit = scene_.geometry.intersect(group_.ray, start_.time, group_.departure);
      if (!hit) return std::nullopt;
      distance += way_to(group_, *hit);
      group_.width = start_.width + start_.spread * distance;
      if (auto seen = look_at(*hit, numbers(group_.sequence))) {
        seen->distance = distance;
        return seen;
      }
      pass_index_matched(scene_, group_, *hit, Contacts(), start_.time);
    }
    return std::nullopt;
  }

  /// Whether `find` met light of a luminaire.
  bool met_light() const { return met_light_; }

 private:
  std::optional<Seen> look_at(const Hit& hit, const KernelNumbers& numbers) {
    if (sees_past(group_, scene_.hidden_from(hit.surface))) return std::nullopt;
    const auto vertex = make_vertex(scene_, hit, Contacts(), group_, start_.wavelengths,
                                    start_.time, Transport::kAdjoint);
    if (!vertex) return std::nullopt;
    const std::uint32_t luminaire = scene_.materials[hit.surface].luminaire;
    if (luminaire != SurfaceMaterial::kNone &&
        scene_.emits(scene_.luminaires[luminaire], hit, -group_.ray.direction, start_.time)) {
      met_light_ = true;
    }
    return visit_bound(
        scene_.kernels, vertex->kernel, vertex->shading,
        [&](const auto& kernel) -> std::optional<Seen> {
          const auto draw = kernel.sample(vertex->wo, numbers, 0);
          if (draw && draw->delta && draw->wi == -vertex->wo) return std::nullopt;
          return Seen{hit, vertex->kernel, vertex->frame.normal, 0.0f, kernel.albedo(vertex->wo)};
        });
  }

  const Scene& scene_;
  const Start<kWavelengths>& start_;
  Group<kWavelengths> group_;
  bool met_light_ = false;
};

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
    const auto seen =
        Look(scene_, sample.start, PhotonSequence(numbers, 0)).find([](PhotonSequence&) {
          return KernelNumbers{0.5f, 0.5f, 0.5f};
        });
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
    Look look(scene_, sample.start, sequence);
    const auto seen = look.find([](PhotonSequence& next) {
      const Uniform4 u = next.next();
      return KernelNumbers{u[3], u[0], u[1]};
    });
    const float part = 1.0f / static_cast<float>(samples_);
    if (look.met_light()) layers.emission += part;
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
