#include "tracer/trace_group.h"

namespace nocturne {
namespace {

// Counts the light that photons from the sensor meet.
template <int N>
class LightCounter {
 public:
  static constexpr Transport kTransport = Transport::kAdjoint;

  LightCounter(const Scene& scene, const Start<N>& start)
      : scene_(scene), wavelengths_(start.wavelengths), time_(start.time) {}

  void flies(const Group<N>& group, const std::optional<Hit>& hit) {
    if (hit || !scene_.has_distant_light()) return;
    count(group, scene_.distant_radiance(group.ray.direction, wavelengths_));
  }

  void arrives(const Group<N>& group, const Hit& hit) {
    const std::uint32_t luminaire = scene_.materials[hit.surface].luminaire;
    if (luminaire == SurfaceMaterial::kNone) return;
    count(group, scene_.emitted(scene_.luminaires[luminaire], hit, -group.ray.direction, time_,
                                wavelengths_));
  }

  // No photon towards lights could have counted it.
  void glows(const Group<N>& group, const Hit& hit) {
    radiance_ += group.weight * scene_.medium(hit.surface).source(hit.position, wavelengths_);
  }

  const Spectral<N>& radiance() const { return radiance_; }

 private:
  // With the share of the way that met it (balance heuristic, Veach and Guibas, SIGGRAPH 1995).
  void count(const Group<N>& group, const Spectral<N>& light) {
    if (group.spread_first && group.gathered) return;  // photons from the luminaires bring it
    Spectral<N> found = group.weight * light;
    if (group.share.how != Shared::kNot && largest(found) > 0.0f) {
      const float towards = scene_.lights.pdf(group.share.from, group.share.direction);
      const bool by_kernel = group.share.how == Shared::kByKernel;
      // Drawn at a rim and rounded off it. The photon from the kernel has the whole weight there.
      if (!by_kernel && !(towards > 0.0f)) return;
      found *= each([&](float kernel) { return (by_kernel ? kernel : 1.0f) / (kernel + towards); },
                    group.share.kernel_pdf);
    }
    radiance_ += found;
  }

  const Scene& scene_;
  const Spectral<N> wavelengths_;
  const float time_;
  Spectral<N> radiance_ = 0.0f;
};

}  // namespace

template <int N, bool Media>
GroupResult<N> trace_group(const Scene& scene, const Start<N>& start,
                           const PhotonSequence& sequence) {
  LightCounter<N> counter(scene, start);
  Walk<N, LightCounter<N>, Media> walk(scene, start, counter);
  const std::uint32_t rays = walk.run(start, sequence);
  return {counter.radiance(), rays};
}

template GroupResult<1> trace_group<1, false>(const Scene&, const Start<1>&, const PhotonSequence&);
template GroupResult<1> trace_group<1, true>(const Scene&, const Start<1>&, const PhotonSequence&);
template GroupResult<4> trace_group<4, false>(const Scene&, const Start<4>&, const PhotonSequence&);
template GroupResult<4> trace_group<4, true>(const Scene&, const Start<4>&, const PhotonSequence&);
template GroupResult<8> trace_group<8, false>(const Scene&, const Start<8>&, const PhotonSequence&);
template GroupResult<8> trace_group<8, true>(const Scene&, const Start<8>&, const PhotonSequence&);

}  // namespace nocturne
