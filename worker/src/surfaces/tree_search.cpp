// Some rays are under way at a time, each at a node or a leaf. In a round each of them takes one
// step, and what its next step needs is asked of memory: it comes while the others take theirs.
// Steps do not branch on what they find, so the processor works on several of them at once.
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

namespace nocturne {
namespace {

constexpr std::size_t kWidth = Tree::kWidth;
// Rays under way: more did not pay, and all of them fit into the first cache.
constexpr std::size_t kUnderWay = 24;
// A node leaves up to eight children, and was itself taken away.
constexpr std::size_t kStack = Tree::kMaxDepth * (kWidth - 1) + kWidth;
// 16 units in the last place of how far a node's box reaches from the ray's origin: what sums and
// products with boxes and corners err by, with room.
constexpr float kPad = 0x1p-19f;
constexpr float kInfinite = std::numeric_limits<float>::infinity();
constexpr std::uint32_t kNothing = ~0u;

// GCC warns of registers as arguments of templates; the names are shorter, too.
using Floats = __m256;
using Whole = __m256i;

Floats all_lanes(const float& v) { return _mm256_broadcast_ss(&v); }
Whole bytes_as_numbers(const std::uint8_t* eight) {
  return _mm256_cvtepu8_epi32(_mm_loadl_epi64(reinterpret_cast<const __m128i*>(eight)));
}

// Numbers of planes, near ones before far ones, by the signs of a ray's direction.
constexpr auto kPlanes = [] {
  std::array<std::array<std::uint32_t, 6>, 8> planes{};
  for (std::uint32_t signs = 0; signs < 8; ++signs) {
    for (std::uint32_t axis = 0; axis < 3; ++axis) {
      const bool backwards = (signs >> axis & 1u) != 0;
      planes[signs][axis] = axis + (backwards ? 3 : 0);
      planes[signs][3 + axis] = axis + (backwards ? 0 : 3);
    }
  }
  return planes;
}();

// Axes x', y', z' of a right-handed frame of which z' is that of the largest component, by which
// of x >= y, y >= z and z >= x hold of the components' sizes.
struct Axes {
  alignas(16) std::array<std::int32_t, 4> order;
};
constexpr auto kAxes = [] {
  std::array<Axes, 8> axes{};
  for (std::uint32_t i = 0; i < 8; ++i) {
    const bool xy = (i & 1u) != 0, yz = (i & 2u) != 0, zx = (i & 4u) != 0;
    std::int32_t z = 0;
    if (yz && !xy) z = 1;
    if (zx && !yz) z = 2;
    axes[i].order = {(z + 1) % 3, (z + 2) % 3, z, 3};
  }
  return axes;
}();

// Lanes that are not missed, in front; by the mask of those that are.
constexpr auto kTogether = [] {
  std::array<std::array<std::uint8_t, kWidth>, 256> together{};
  for (std::size_t missed = 0; missed < 256; ++missed) {
    std::size_t count = 0;
    for (std::uint8_t i = 0; i < kWidth; ++i) {
      if ((missed >> i & 1u) == 0) together[missed][count++] = i;
    }
  }
  return together;
}();

// One stage of a sorting network: of a lane and its partner the larger goes to the front.
template <int kLater>
Whole exchanged(Whole v, Whole partners) {
  return _mm256_blend_epi32(_mm256_max_epi32(v, partners), _mm256_min_epi32(v, partners), kLater);
}
// Batcher's bitonic network for eight, largest first.
Whole sorted(Whole v) {
  v = exchanged<0xAA>(v, _mm256_shuffle_epi32(v, 0xB1));
  v = exchanged<0xCC>(v, _mm256_shuffle_epi32(v, 0x1B));
  v = exchanged<0xAA>(v, _mm256_shuffle_epi32(v, 0xB1));
  v = exchanged<0xF0>(v, _mm256_permutevar8x32_epi32(v, _mm256_setr_epi32(7, 6, 5, 4, 3, 2, 1, 0)));
  v = exchanged<0xCC>(v, _mm256_shuffle_epi32(v, 0x4E));
  return exchanged<0xAA>(v, _mm256_shuffle_epi32(v, 0xB1));
}

// The nearest so far.
struct alignas(16) Nearest {
  float end, u, v;
  // Block, triangle in it (three bits) and whether it is one: a ball is not.
  std::uint32_t what;
};
constexpr std::uint32_t what(Tree::Reference at, std::size_t triangle, bool is_triangle) {
  return (at >> 2) << 4 | static_cast<std::uint32_t>(triangle) << 1 | (is_triangle ? 1u : 0u);
}

// A ball is its surface's only triangle.
Tree::Triangle triangle_of(const Tree& tree, std::uint32_t what) {
  const Tree::Block& block = tree.blocks[what >> 4];
  if ((what & 1u) == 0) return {block.ball.surface, 0};
  return tree.triangles[block.triangles.first + (what >> 1 & 7u)];
}

// A ray under way.
struct alignas(64) Walk {
  // x, y, z and nothing, twice: for near planes and for far ones.
  std::array<float, 8> origin, inverse;
  // kPad, towards the origin and away from it: no box that a ray touches is missed.
  std::array<float, 8> pad;
  std::array<std::uint32_t, 6> planes;
  Nearest nearest;
  // Of the frame in which the ray is the axis z' (Woop, Benthin and Wald, "Watertight Ray/Triangle
  // Intersection", JCGT 2013): its axes, origin and shear.
  std::array<std::int32_t, 4> axes;
  std::array<float, 4> start, shear;
  Tree::Reference at;
  std::uint32_t ray;
  std::uint32_t depth;
  // Where to go on, nearest last, and where it begins. Eight are written at a time.
  std::array<Tree::Reference, kStack> waiting;
  std::array<float, kStack> begins;
};

// Of the triangles of a leaf: distances, infinite where a triangle is missed, and coordinates.
struct Crossings {
  alignas(32) std::array<float, kWidth> distance, u, v;
};

template <bool kAny>
class Search {
 public:
  Search(const Tree& tree, std::span<const Shape> shapes, std::span<const TimedRay> rays)
      : tree_(tree), shapes_(shapes), rays_(rays) {}

  // f(ray, nearest) for each of them, in any order.
  template <class F>
  void run(const F& f) {
    Round now, then;
    for (Walk& walk : walks_) {
      if (next_ == rays_.size()) break;
      start(walk);
      now.add(static_cast<std::uint8_t>(&walk - walks_.data()), walk.at);
    }
    while (!now.empty()) {
      then.count.fill(0);
      for (const std::uint8_t i : now.at(Tree::Kind::kNode)) enter(walks_[i]);
      for (const std::uint8_t i : now.at(Tree::Kind::kTriangles)) cross(walks_[i], crossings_[i]);
      for (const std::uint8_t i : now.at(Tree::Kind::kBall)) cross_ball(walks_[i]);
      if constexpr (!kAny) {
        for (const std::uint8_t i : now.at(Tree::Kind::kTriangles)) take(walks_[i], crossings_[i]);
      }
      for (const Tree::Kind kind : {Tree::Kind::kNode, Tree::Kind::kTriangles, Tree::Kind::kBall}) {
        for (const std::uint8_t i : now.at(kind)) go_on(i, then, f);
      }
      std::swap(now, then);
    }
  }

 private:
  // Which rays take a step, by what they are at.
  struct Round {
    std::array<std::array<std::uint8_t, kUnderWay>, 3> walks;
    std::array<std::uint8_t, 3> count{};

    void add(std::uint8_t walk, Tree::Reference at) {
      const auto kind = static_cast<std::size_t>(Tree::kind(at));
      walks[kind][count[kind]++] = walk;
    }
    std::span<const std::uint8_t> at(Tree::Kind kind) const {
      const auto k = static_cast<std::size_t>(kind);
      return std::span(walks[k]).first(count[k]);
    }
    bool empty() const { return count[0] + count[1] + count[2] == 0; }
  };

  void start(Walk& walk) {
    const TimedRay& ray = rays_[next_];
    // The direction follows the origin; what else is loaded is not used.
    const __m128 o = _mm_loadu_ps(&ray.ray.origin.x), d = _mm_loadu_ps(&ray.ray.direction.x);
    const __m128 sign = _mm_set1_ps(-0.0f);
    const __m128 size = _mm_andnot_ps(sign, d), d_sign = _mm_and_ps(sign, d);
    const __m128 inverse =
        _mm_div_ps(_mm_set1_ps(1.0f), _mm_or_ps(d_sign, _mm_max_ps(size, _mm_set1_ps(1e-18f))));
    const __m128 away = _mm_or_ps(d_sign, _mm_set1_ps(kPad)), back = _mm_xor_ps(sign, away);
    _mm256_store_ps(walk.origin.data(), _mm256_set_m128(o, o));
    _mm256_store_ps(walk.pad.data(), _mm256_set_m128(away, back));
    _mm256_store_ps(walk.inverse.data(), _mm256_set_m128(inverse, inverse));
    walk.planes = kPlanes[static_cast<unsigned>(_mm_movemask_ps(d)) & 7u];
    const __m128 turned = _mm_permute_ps(size, 0xC9);  // y, z, x
    const Axes& axes =
        kAxes[static_cast<unsigned>(_mm_movemask_ps(_mm_cmp_ps(size, turned, _CMP_GE_OQ))) & 7u];
    walk.axes = axes.order;
    const __m128i order = _mm_load_si128(reinterpret_cast<const __m128i*>(axes.order.data()));
    const __m128 inverse_z = _mm_permute_ps(_mm_permutevar_ps(inverse, order), 0xAA);
    _mm_storeu_ps(walk.start.data(), _mm_permutevar_ps(o, order));
    _mm_storeu_ps(walk.shear.data(),
                  _mm_blend_ps(_mm_mul_ps(_mm_permutevar_ps(d, order), inverse_z), inverse_z, 4));
    walk.nearest.end = ray.end;
    walk.nearest.what = kNothing;
    walk.ray = static_cast<std::uint32_t>(next_++);
    walk.depth = 0;
    walk.at = tree_.root;
  }

  // The boxes of a node's children that the ray meets before its end.
  [[gnu::always_inline]] void enter(Walk& walk) {
    const Tree::Node& node = tree_.block(walk.at).node;
    const Floats inverse = _mm256_load_ps(walk.inverse.data());
    const Floats scale = _mm256_broadcast_ps(reinterpret_cast<const __m128*>(node.scale));
    const Floats corner =
        _mm256_sub_ps(_mm256_broadcast_ps(reinterpret_cast<const __m128*>(node.base)),
                      _mm256_load_ps(walk.origin.data()));
    // How far the box reaches, at most, along any axis: the fourth number is nothing.
    Floats reach = _mm256_fmadd_ps(scale, _mm256_set1_ps(255.0f),
                                   _mm256_andnot_ps(_mm256_set1_ps(-0.0f), corner));
    reach = _mm256_max_ps(_mm256_max_ps(reach, _mm256_permute_ps(reach, 0xC9)),
                          _mm256_permute_ps(reach, 0xD2));
    // Distances of the node's corner, to near planes and to far ones, and of a byte's unit.
    const Floats base =
        _mm256_mul_ps(_mm256_fmadd_ps(reach, _mm256_load_ps(walk.pad.data()), corner), inverse);
    const Floats unit = _mm256_mul_ps(scale, inverse);
    const auto to_plane = [&](std::size_t number, int axis, int from) {
      const Floats units = _mm256_cvtepi32_ps(bytes_as_numbers(node.plane[walk.planes[number]]));
      return _mm256_fmadd_ps(units, _mm256_permutevar8x32_ps(unit, _mm256_set1_epi32(axis)),
                             _mm256_permutevar8x32_ps(base, _mm256_set1_epi32(from)));
    };
    const Floats begin = _mm256_max_ps(_mm256_max_ps(to_plane(0, 0, 0), to_plane(1, 1, 1)),
                                       _mm256_max_ps(to_plane(2, 2, 2), _mm256_setzero_ps()));
    const Floats end = _mm256_min_ps(_mm256_min_ps(to_plane(3, 0, 4), to_plane(4, 1, 5)),
                                     _mm256_min_ps(to_plane(5, 2, 6), all_lanes(walk.nearest.end)));
    const Floats missed = _mm256_cmp_ps(begin, end, _CMP_NLE_UQ);
    const auto mask = static_cast<unsigned>(_mm256_movemask_ps(missed));
    // The last three bits of where a child begins give its number: less than the pad.
    Whole keys =
        _mm256_or_si256(_mm256_andnot_si256(_mm256_set1_epi32(7), _mm256_castps_si256(begin)),
                        _mm256_setr_epi32(0, 1, 2, 3, 4, 5, 6, 7));
    if constexpr (kAny) {
      keys = _mm256_permutevar8x32_epi32(keys, bytes_as_numbers(kTogether[mask].data()));
    } else {
      keys = sorted(_mm256_or_si256(keys, _mm256_castps_si256(missed)));  // missed: -1
    }
    const Whole children = _mm256_loadu_si256(reinterpret_cast<const Whole*>(node.child));
    _mm256_storeu_si256(reinterpret_cast<Whole*>(walk.waiting.data() + walk.depth),
                        _mm256_permutevar8x32_epi32(children, keys));
    _mm256_storeu_si256(reinterpret_cast<Whole*>(walk.begins.data() + walk.depth), keys);
    walk.depth +=
        static_cast<std::uint32_t>(kWidth) - static_cast<std::uint32_t>(std::popcount(mask));
  }

  // Of edges that two triangles share both compute the same, so no ray passes between them.
  [[gnu::always_inline]] void cross(Walk& walk, Crossings& found) {
    const Tree::Triangles& leaf = tree_.block(walk.at).triangles;
    const auto from_start = [&](std::size_t i) {
      return _mm256_sub_ps(_mm256_load_ps(leaf.coordinates[walk.axes[i]]),
                           all_lanes(walk.start[i]));
    };
    const Floats along = from_start(2);
    const Floats x = _mm256_fnmadd_ps(all_lanes(walk.shear[0]), along, from_start(0));
    const Floats y = _mm256_fnmadd_ps(all_lanes(walk.shear[1]), along, from_start(1));
    const Floats z = _mm256_mul_ps(all_lanes(walk.shear[2]), along);
    const Whole a = bytes_as_numbers(leaf.corner[0]), b = bytes_as_numbers(leaf.corner[1]),
                c = bytes_as_numbers(leaf.corner[2]);
    const auto of = [](Floats corners, Whole which) {
      return _mm256_permutevar8x32_ps(corners, which);
    };
    const Floats ax = of(x, a), ay = of(y, a), bx = of(x, b), by = of(y, b), cx = of(x, c),
                 cy = of(y, c);
    // Not fused: of p and q it is exactly minus that of q and p, and never of the wrong sign.
    const auto area = [](Floats px, Floats py, Floats qx, Floats qy) {
      return _mm256_sub_ps(_mm256_mul_ps(px, qy), _mm256_mul_ps(py, qx));
    };
    const Floats by_a = area(cx, cy, bx, by), by_b = area(ax, ay, cx, cy),
                 by_c = area(bx, by, ax, ay);
    const Floats zero = _mm256_setzero_ps(), sum = _mm256_add_ps(_mm256_add_ps(by_a, by_b), by_c);
    const Floats inside = _mm256_or_ps(
        _mm256_cmp_ps(_mm256_min_ps(_mm256_min_ps(by_a, by_b), by_c), zero, _CMP_GE_OQ),
        _mm256_cmp_ps(_mm256_max_ps(_mm256_max_ps(by_a, by_b), by_c), zero, _CMP_LE_OQ));
    const Floats whole = _mm256_div_ps(_mm256_set1_ps(1.0f), sum);
    const Floats distance = _mm256_mul_ps(
        whole, _mm256_fmadd_ps(by_a, of(z, a),
                               _mm256_fmadd_ps(by_b, of(z, b), _mm256_mul_ps(by_c, of(z, c)))));
    Floats hit = _mm256_and_ps(inside, _mm256_cmp_ps(sum, zero, _CMP_NEQ_OQ));
    hit = _mm256_and_ps(hit, _mm256_cmp_ps(distance, zero, _CMP_GT_OQ));
    hit = _mm256_and_ps(hit, _mm256_cmp_ps(distance, all_lanes(walk.nearest.end), _CMP_LE_OQ));
    if constexpr (kAny) {
      end_if(walk, _mm256_movemask_ps(hit) != 0);
    } else {
      _mm256_store_ps(found.distance.data(),
                      _mm256_blendv_ps(_mm256_set1_ps(kInfinite), distance, hit));
      _mm256_store_ps(found.u.data(), _mm256_mul_ps(by_b, whole));
      _mm256_store_ps(found.v.data(), _mm256_mul_ps(by_c, whole));
    }
  }

  void cross_ball(Walk& walk) {
    const std::uint32_t surface = tree_.block(walk.at).ball.surface;
    const Sphere& sphere = std::get<Sphere>(shapes_[surface]);
    const Ray& ray = rays_[walk.ray].ray;
    const auto both =
        cross_sphere(centre_at_step(sphere, 0), sphere.radius, ray.origin, Double3(ray.direction));
    if (!both) return;
    for (const double t : {both->near, both->far}) {
      if (!(t > 0.0 && t <= static_cast<double>(walk.nearest.end))) continue;
      if constexpr (kAny) return end_if(walk, true);
      return replace(walk, static_cast<float>(t), 0.0f, 0.0f, what(walk.at, 0, false), true);
    }
  }

  static void end_if(Walk& walk, bool blocked) {
    walk.nearest.what = blocked ? 0 : walk.nearest.what;
    walk.depth = blocked ? 0 : walk.depth;
  }

  [[gnu::always_inline]] void take(Walk& walk, const Crossings& found) {
    const Floats distances = _mm256_load_ps(found.distance.data());
    Floats least = _mm256_min_ps(distances, _mm256_permute_ps(distances, 0xB1));
    least = _mm256_min_ps(least, _mm256_permute_ps(least, 0x4E));
    least = _mm256_min_ps(least, _mm256_permute2f128_ps(least, least, 1));
    const auto i = static_cast<std::size_t>(std::countr_zero(
        static_cast<unsigned>(_mm256_movemask_ps(_mm256_cmp_ps(distances, least, _CMP_EQ_OQ)))));
    const float distance = _mm256_cvtss_f32(least);
    replace(walk, distance, found.u[i], found.v[i], what(walk.at, i, true), distance < kInfinite);
  }

  [[gnu::always_inline]] void replace(Walk& walk, float distance, float u, float v,
                                      std::uint32_t by, bool hit) const {
    Nearest& nearest = walk.nearest;
    // Two at once: the first in the scene, wherever in the tree they are.
    const bool again = std::bit_cast<int>(distance) == std::bit_cast<int>(nearest.end);
    if (static_cast<int>(hit) & static_cast<int>(again) &
        static_cast<int>(nearest.what != kNothing)) [[unlikely]] {
      hit = triangle_of(tree_, by) < triangle_of(tree_, nearest.what);
    }
    nearest.end = hit ? distance : nearest.end;
    nearest.u = hit ? u : nearest.u;
    nearest.v = hit ? v : nearest.v;
    nearest.what = hit ? by : nearest.what;
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
      f(walk.ray, walk.nearest);
      if (next_ == rays_.size()) return;
      start(walk);
    }
    const auto* block = reinterpret_cast<const std::byte*>(&tree_.block(walk.at));
    __builtin_prefetch(block);
    __builtin_prefetch(block + 64);
    then.add(i, walk.at);
  }

  const Tree& tree_;
  std::span<const Shape> shapes_;
  std::span<const TimedRay> rays_;
  std::size_t next_ = 0;
  std::array<Walk, kUnderWay> walks_;
  std::array<Crossings, kUnderWay> crossings_;
};

}  // namespace

void intersect_tree(const Tree& tree, std::span<const Shape> shapes, std::span<const TimedRay> rays,
                    std::span<std::optional<Hit>> hits) {
  Search<false>(tree, shapes, rays).run([&](std::size_t i, const Nearest& nearest) {
    if (nearest.what == kNothing) return;
    const auto [surface, number] = triangle_of(tree, nearest.what);
    const Found found{surface, Hit::kNoInstance, number, nearest.u, nearest.v, nearest.end};
    const Tree::Block& block = tree.blocks[nearest.what >> 4];
    hits[i].emplace(InPlace{[&] {
      if ((nearest.what & 1u) != 0) {
        return locate(tree.corners(block.triangles, nearest.what >> 1 & 7u), found);
      }
      return locate(std::get<Sphere>(shapes[surface]), rays[i].ray.origin,
                    Double3(rays[i].ray.direction), found, rays[i].time);
    }});
  });
}

void occluded_tree(const Tree& tree, std::span<const Shape> shapes, std::span<const TimedRay> rays,
                   std::span<std::uint8_t> blocked) {
  Search<true>(tree, shapes, rays).run([&](std::size_t i, const Nearest& nearest) {
    if (nearest.what != kNothing) blocked[i] = 1;
  });
}

}  // namespace nocturne
