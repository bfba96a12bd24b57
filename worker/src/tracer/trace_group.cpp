#include "tracer/trace_group.h"

namespace nocturne {
namespace {

// Counts the light that photons from the sensor meet.
template <int N>
class RadianceEstimator {
 public:
  static constexpr Transport kTransport = Transport::kAdjoint;

  RadianceEstimator(const Scene& scene, const Start<N>& start)
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
    if (group.diffuse_like_first && group.specular_like)
      return;  // photons from the luminaires bring it
    Spectral<N> found = group.weight * light;
    if (group.mis.technique != MisTechnique::kNone && largest(found) > 0.0f) {
      const float towards = scene_.lights.pdf(group.mis.context, group.mis.direction);
      const bool by_kernel = group.mis.technique == MisTechnique::kKernel;
      // Drawn at a rim and rounded off it. The photon from the kernel has the whole weight there.
      if (!by_kernel && !(towards > 0.0f)) return;
      found *= each([&](float kernel) { return (by_kernel ? kernel : 1.0f) / (kernel + towards); },
                    group.mis.kernel_pdf);
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
  RadianceEstimator<N> estimator(scene, start);
  Walk<N, RadianceEstimator<N>, Media> walk(scene, start, estimator);
  const std::uint32_t rays = walk.run(start, sequence);
  return {estimator.radiance(), rays};
}

template GroupResult<1> trace_group<1, false>(const Scene&, const Start<1>&, const PhotonSequence&);
template GroupResult<1> trace_group<1, true>(const Scene&, const Start<1>&, const PhotonSequence&);
template GroupResult<4> trace_group<4, false>(const Scene&, const Start<4>&, const PhotonSequence&);
template GroupResult<4> trace_group<4, true>(const Scene&, const Start<4>&, const PhotonSequence&);
template GroupResult<8> trace_group<8, false>(const Scene&, const Start<8>&, const PhotonSequence&);
template GroupResult<8> trace_group<8, true>(const Scene&, const Start<8>&, const PhotonSequence&);

}  // namespace nocturne
