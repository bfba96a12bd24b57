// The path from a sensor to the place it shows: the surfaces that are seen on it, one after the
// other. No light is counted, and media are not looked at.
#pragma once

#include "tracer/vertex/travel.h"
#include "tracer/vertex/vertex.h"

namespace nocturne {

template <int N>
class LineOfSight {
 public:
  LineOfSight(const Scene& scene, const Start<N>& start, const PhotonSequence& numbers)
      : scene_(scene), start_(start), group_(start, numbers) {}

  /// The next surface that is seen; it stands until the next call. Null where there is none, or
  /// where the line has met so many that it is caught between mirrors or among holes.
  const Vertex<N>* next() {
    constexpr int kMaxSurfaces = 64;
    while (surfaces_++ < kMaxSurfaces) {
      hit_ = scene_.geometry.intersect(group_.ray, start_.time, group_.departure);
      if (!hit_) return nullptr;
      distance_ += way_to(group_, *hit_);
      group_.width = start_.width + start_.spread * distance_;
      const Contacts contacts =
          contacts_of(scene_, group_.ray, start_.time, group_.departure, *hit_);
      vertex_.emplace(vertex_at(scene_, *hit_, group_, start_.wavelengths, Transport::kAdjoint));
      if (!sees_past(group_, scene_.hidden_from(hit_->surface)) &&
          complete(scene_, contacts, group_, start_.time, *vertex_)) {
        return &*vertex_;
      }
      pass_index_matched(scene_, group_, *hit_, contacts, start_.time);
    }
    return nullptr;
  }

  /// From the surface that is seen, in the frame's direction `wi`.
  void continue_along(Vec3 wi) {
    ++group_.depth;
    if (wi == -vertex_->wo) ++group_.passes;
    const Vec3 direction = vertex_->to_world(wi);
    if (dot(vertex_->normal, direction) < 0.0f) group_.inside = vertex_->beyond;
    start_off(scene_, group_, *hit_, direction, start_.time);
  }

  Vec3 direction() const { return group_.ray.direction; }
  /// From the sensor along the line, m.
  float distance() const { return distance_; }

 private:
  const Scene& scene_;
  const Start<N>& start_;
  Group<N> group_;
  std::optional<Hit> hit_;
  std::optional<Vertex<N>> vertex_;
  float distance_ = 0.0f;
  int surfaces_ = 0;
};

}  // namespace nocturne
