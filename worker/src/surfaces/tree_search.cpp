// Some rays are in flight at a time, each at a node or a leaf. In a round each of them takes one
// step, and what its next step needs is asked of memory: it comes while the others take theirs.
// Steps do not branch on their results, so the processor works on several of them at once.
#include "surfaces/tree_search.h"

#include <immintrin.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstddef>

#include "math/in_place.h"
#include "surfaces/locate.h"
#include "surfaces/sphere_intersection.h"
#include "surfaces/tree_walk.h"

namespace nocturne {
namespace {

using namespace walking;

// Rays in flight: more did not pay, and all of them fit into the first cache.
constexpr std::size_t kUnderWay = 24;

template <bool kAny>
class Search {
 public:
  Search(const EmbreeScene& scene, std::span<const TimedRay> rays)
      : scene_(scene), tree_(*scene.tree), rays_(rays) {}

  // f(ray, walk) for each of them, in any order.
  template <class F>
  void run(const F& f) {
    Round now, then;
    for (Walk& walk : walks_) {
      if (next_ == rays_.size()) break;
      start_next(walk);
      now.add(static_cast<std::uint8_t>(&walk - walks_.data()), walk.at);
    }
    while (!now.empty()) {
      then.count.fill(0);
      for (const std::uint8_t i : now.at(Tree::Kind::kNode)) enter<kAny>(walks_[i], tree_);
      for (const std::uint8_t i : now.at(Tree::Kind::kTriangles)) {
        cross<kAny>(walks_[i], tree_, crossings_[i]);
      }
      for (const std::uint8_t i : now.at(Tree::Kind::kBall)) cross_ball(walks_[i]);
      for (const std::uint8_t i : now.at(Tree::Kind::kInstance)) enter_instance(walks_[i]);
      if constexpr (!kAny) {
        for (const std::uint8_t i : now.at(Tree::Kind::kTriangles)) take(walks_[i], crossings_[i]);
      }
      for (const Tree::Kind kind : kKinds) {
        for (const std::uint8_t i : now.at(kind)) go_on(i, then, f);
      }
      std::swap(now, then);
    }
  }

 private:
  // Which rays take a step, by the kind of node they are at.
  static constexpr std::array kKinds{Tree::Kind::kNode, Tree::Kind::kTriangles, Tree::Kind::kBall,
                                     Tree::Kind::kInstance};
  struct Round {
    std::array<std::array<std::uint8_t, kUnderWay>, kKinds.size()> walks;
    std::array<std::uint8_t, kKinds.size()> count{};

    void add(std::uint8_t walk, Tree::Reference at) {
      const auto kind = static_cast<std::size_t>(Tree::kind(at));
      walks[kind][count[kind]++] = walk;
    }
    std::span<const std::uint8_t> at(Tree::Kind kind) const {
      const auto k = static_cast<std::size_t>(kind);
      return std::span(walks[k]).first(count[k]);
    }
    bool empty() const { return std::bit_cast<std::uint32_t>(count) == 0; }
  };

  void start_next(Walk& walk) {
    start(walk, tree_, rays_[next_], static_cast<std::uint32_t>(next_));
    ++next_;
  }

  void cross_ball(Walk& walk) {
    const std::uint32_t surface = tree_.block(walk.at).alone.number;
    const Sphere& sphere = std::get<Sphere>(scene_.shapes[surface]);
    const Ray& ray = rays_[walk.ray].ray;
    const auto both =
        cross_sphere(centre_at_step(sphere, 0), sphere.radius, ray.origin, Double3(ray.direction));
    if (!both) return;
    for (const double t : {both->near, both->far}) {
      if (!(t > 0.0 && t <= static_cast<double>(walk.nearest.end))) continue;
      if constexpr (kAny) return end_if(walk, true);
      replace(walk, static_cast<float>(t), 0.0f, 0.0f, what(walk.at, 0), true);
      return;
    }
  }

  void enter_instance(Walk& walk) {
    const auto& one = scene_.instances_in_groups[tree_.block(walk.at).alone.number];
    const TimedRay& timed = rays_[walk.ray];
    // So that a surface at the very end is found, too.
    const float end = std::nextafter(walk.nearest.end, kInfinite);
    const RTCRay ray = embree_ray(timed.ray, timed.time, end);
    if constexpr (kAny) return end_if(walk, blocked_by(one, ray));
    const RTCRayHit found = nearest_in(one, ray);
    if (found.hit.geomID == RTC_INVALID_GEOMETRY_ID || found.ray.tfar > walk.nearest.end) return;
    if (replace(walk, found.ray.tfar, found.hit.u, found.hit.v, what(walk.at, 0), true)) {
      walk.in_group = {found.hit.geomID, found.hit.primID};
    }
  }

  [[gnu::always_inline]] void take(Walk& walk, const Crossings& found) {
    const Floats distances = _mm256_load_ps(found.distance.data());
    Floats least = _mm256_min_ps(distances, _mm256_permute_ps(distances, 0xB1));
    least = _mm256_min_ps(least, _mm256_permute_ps(least, 0x4E));
    least = _mm256_min_ps(least, _mm256_permute2f128_ps(least, least, 1));
    const auto i = static_cast<std::size_t>(std::countr_zero(
        static_cast<unsigned>(_mm256_movemask_ps(_mm256_cmp_ps(distances, least, _CMP_EQ_OQ)))));
    const float distance = _mm256_cvtss_f32(least);
    // Who it is will be asked.
    __builtin_prefetch(&tree_.triangles[tree_.block(walk.at).triangles.first + i]);
    replace(walk, distance, found.u[i], found.v[i], what(walk.at, i), distance < kInfinite);
  }

  // Whether it did.
  [[gnu::always_inline]] bool replace(Walk& walk, float distance, float u, float v,
                                      std::uint32_t by, bool hit) const {
    Nearest& nearest = walk.nearest;
    // Two at once: the first in the scene, wherever in the tree they are.
    const bool again = std::bit_cast<int>(distance) == std::bit_cast<int>(nearest.end);
    if (static_cast<int>(hit) & static_cast<int>(again) &
        static_cast<int>(nearest.what != kNothing)) [[unlikely]] {
      hit = place_of(tree_, by) < place_of(tree_, nearest.what);
    }
    nearest.end = hit ? distance : nearest.end;
    nearest.u = hit ? u : nearest.u;
    nearest.v = hit ? v : nearest.v;
    nearest.what = hit ? by : nearest.what;
    return hit;
  }

  template <class F>
  [[gnu::always_inline]] void go_on(std::uint8_t i, Round& then, const F& f) {
    Walk& walk = walks_[i];
    bool more = false;
    while (!more && walk.depth > 0) {
      --walk.depth;
      more = walk.begins[walk.depth] <= walk.nearest.end;
    }
    if (more) {
      walk.at = walk.waiting[walk.depth];
    } else {
      f(walk.ray, walk);
      if (next_ == rays_.size()) return;
      start_next(walk);
    }
    const auto* block = reinterpret_cast<const std::byte*>(&tree_.block(walk.at));
    __builtin_prefetch(block);
    __builtin_prefetch(block + 64);
    then.add(i, walk.at);
  }

  const EmbreeScene& scene_;
  const Tree& tree_;
  std::span<const TimedRay> rays_;
  std::size_t next_ = 0;
  std::array<Walk, kUnderWay> walks_;
  std::array<Crossings, kUnderWay> crossings_;
};

}  // namespace

void intersect_tree(const EmbreeScene& scene, std::span<const TimedRay> rays,
                    std::span<std::optional<Hit>> hits) {
  const Tree& tree = *scene.tree;
  Search<false>(scene, rays).run([&](std::size_t i, const Walk& walk) {
    const auto [distance, u, v, what] = walk.nearest;
    if (what == kNothing) return;
    const Tree::Block& block = tree.blocks[block_of(what)];
    const auto& [ray, time, end, departure] = rays[i];
    hits[i].emplace(InPlace{[&] {
      const auto [surface, number] = place_of(tree, what);
      Found found{surface, Hit::kNoInstance, number, u, v, distance};
      switch (Tree::kind(what)) {
        case Tree::Kind::kTriangles:
          return locate(Tree::corners(block.triangles, triangle_of(what)), ray.origin,
                        ray.direction, found);
        case Tree::Kind::kInstance:
          found.instance = block.alone.number;
          found.surface = walk.in_group.surface;
          found.primitive = walk.in_group.number;
          break;
        default:
          break;
      }
      return scene.located(ray.origin, ray.direction, time, found);
    }});
  });
}

void occluded_tree(const EmbreeScene& scene, std::span<const TimedRay> rays,
                   std::span<std::uint8_t> blocked) {
  Search<true>(scene, rays).run([&](std::size_t i, const Walk& walk) {
    if (walk.nearest.what != kNothing) blocked[i] = 1;
  });
}

}  // namespace nocturne
