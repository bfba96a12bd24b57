#include "tracer/trace_forward.h"

namespace nocturne {
namespace {

// Counts the photons that meet the sensor.
template <int N>
class SensorEstimator {
 public:
  static constexpr Transport kTransport = Transport::kForward;

  SensorEstimator(const Scene& scene, Film film, float time, const Spectral<N>& wavelengths,
                  const Spectral<N>& flux, std::vector<Splat<N>>& splats)
      : scene_(scene),
        film_(film),
        time_(time),
        wavelengths_(wavelengths),
        flux_(flux),
        splats_(splats) {}

  void flies(const Group<N>& group, const std::optional<Hit>& hit) {
    const float distance = hit ? hit->distance : std::numeric_limits<float>::infinity();
    if (scene_.sensor.splats_segments()) {
      put(group, scene_.sensor.splat_segment(film_, group.ray.origin, group.ray.direction, distance,
                                             time_));
    } else if (!hit) {
      put(group, scene_.sensor.splat_escape(film_, group.ray.direction, time_));
    }
  }

  void arrives(const Group<N>&, const Hit&) {}
  void glows(const Group<N>&, const Hit&) {}

 private:
  void put(const Group<N>& group, const std::optional<SplatWeight>& splat) {
    if (!splat) return;
    const Spectral<N> left =
        group.inside.empty() || std::isinf(splat->distance)
            ? Spectral<N>(1.0f)
            : scene_.transmittance(group.inside, splat->distance, wavelengths_);
    splats_.push_back({splat->pixel, splat->weight * (flux_ * group.weight * left)});
  }

  const Scene& scene_;
  const Film film_;
  const float time_;
  const Spectral<N> wavelengths_, flux_;
  std::vector<Splat<N>>& splats_;
};

// Counts the photons that are sent to the camera.
template <int N>
class CameraEstimator {
 public:
  static constexpr Transport kTransport = Transport::kForward;

  CameraEstimator(const Scene& scene, Film film, float time, const Spectral<N>&,
                  const Spectral<N>& flux, std::vector<Splat<N>>& splats)
      : scene_(scene), film_(film), time_(time), flux_(flux), splats_(splats) {}

  std::optional<CameraConnection> connect(Vec3 place, float u, float v) const {
    return scene_.sensor.connect(film_, place, u, v, time_);
  }
  void reaches(const Group<N>& group, const CameraConnection& way) {
    splats_.push_back({way.pixel, way.weight * (flux_ * group.weight)});
  }

  void flies(const Group<N>&, const std::optional<Hit>&) {}
  void arrives(const Group<N>&, const Hit&) {}
  void glows(const Group<N>&, const Hit&) {}

 private:
  const Scene& scene_;
  const Film film_;
  const float time_;
  const Spectral<N> flux_;
  std::vector<Splat<N>>& splats_;
};

template <int N, class PathEstimator>
std::uint32_t emit_and_follow(const Scene& scene, Film film, float time,
                              const Spectral<N>& wavelengths_nm, const PhotonSequence& sequence,
                              std::vector<Splat<N>>& splats) {
  PhotonSequence numbers = sequence;
  const Uniform4 first = numbers.next(), second = numbers.next();
  const auto emitted =
      scene.emitter.emit(scene.luminaires, scene.lights, scene.options.aimed_emission, time,
                         wavelengths_nm, first, second);
  if (!emitted) return 0;
  Start<N> start{.ray = emitted->ray, .wavelengths = wavelengths_nm, .inside = {}, .time = time};
  if (emitted->luminaire != Emitted<N>::kDistant) {
    start.inside = scene.luminaires_inside[emitted->luminaire];
  }
  PathEstimator estimator(scene, film, time, wavelengths_nm, emitted->flux, splats);
  return scene.media.empty()
             ? Walk<N, PathEstimator, false>(scene, start, estimator).run(start, numbers)
             : Walk<N, PathEstimator, true>(scene, start, estimator).run(start, numbers);
}

}  // namespace

template <int N>
std::uint32_t trace_forward(const Scene& scene, Film film, float time,
                            const Spectral<N>& wavelengths_nm, const PhotonSequence& sequence,
                            std::vector<Splat<N>>& splats) {
  const auto follow = scene.options.direction == Direction::kBoth
                          ? emit_and_follow<N, CameraEstimator<N>>
                          : emit_and_follow<N, SensorEstimator<N>>;
  return follow(scene, film, time, wavelengths_nm, sequence, splats);
}

template std::uint32_t trace_forward(const Scene&, Film, float, const Spectral<1>&,
                                     const PhotonSequence&, std::vector<Splat<1>>&);
template std::uint32_t trace_forward(const Scene&, Film, float, const Spectral<4>&,
                                     const PhotonSequence&, std::vector<Splat<4>>&);
template std::uint32_t trace_forward(const Scene&, Film, float, const Spectral<8>&,
                                     const PhotonSequence&, std::vector<Splat<8>>&);

}  // namespace nocturne
