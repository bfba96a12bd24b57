// A ray in flight through a tree, and its steps: into a node, across the triangles of a leaf. They
// do not branch on their results. Only tree_search.cpp uses this.
#pragma once

#include <immintrin.h>

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <limits>

#include "surfaces/geometry.h"
#include "surfaces/tree.h"

namespace nocturne::walking {

// A node leaves up to eight children, and was itself taken away.
inline constexpr std::size_t kStack = Tree::kMaxDepth * (Tree::kWidth - 1) + Tree::kWidth;
// Eight rounding errors of how far a node's box reaches from the ray's origin: what sums and
// products with boxes and corners err by, with room. Less than a hit's clearance, so that a ray
// which leaves a plane is not within the flat boxes of its triangles.
inline constexpr float kPad = 0x1p-21f;
inline constexpr float kInfinite = std::numeric_limits<float>::infinity();
inline constexpr std::uint32_t kNothing = ~0u;

// GCC warns of registers as arguments of templates; the names are shorter, too.
using Floats = __m256;
using Whole = __m256i;

inline Floats all_lanes(const float& v) { return _mm256_broadcast_ss(&v); }
inline Whole bytes_as_numbers(const std::uint8_t* eight) {
  return _mm256_cvtepu8_epi32(_mm_loadl_epi64(reinterpret_cast<const __m128i*>(eight)));
}

// Numbers of planes, near ones before far ones, by the signs of a ray's direction.
inline constexpr auto kPlanes = [] {
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
inline constexpr auto kAxes = [] {
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
inline constexpr auto kTogether = [] {
  std::array<std::array<std::uint8_t, Tree::kWidth>, 256> together{};
  for (std::size_t missed = 0; missed < 256; ++missed) {
    std::size_t count = 0;
    for (std::uint8_t i = 0; i < Tree::kWidth; ++i) {
      if ((missed >> i & 1u) == 0) together[missed][count++] = i;
    }
  }
  return together;
}();

// One stage of a sorting network: of a lane and its partner the larger goes to the front.
template <int kLater>
inline Whole exchanged(Whole v, Whole partners) {
  return _mm256_blend_epi32(_mm256_max_epi32(v, partners), _mm256_min_epi32(v, partners), kLater);
}
// Batcher's bitonic network for eight, largest first.
inline Whole sorted(Whole v) {
  v = exchanged<0xAA>(v, _mm256_shuffle_epi32(v, 0xB1));
  v = exchanged<0xCC>(v, _mm256_shuffle_epi32(v, 0x1B));
  v = exchanged<0xAA>(v, _mm256_shuffle_epi32(v, 0xB1));
  v = exchanged<0xF0>(v, _mm256_permutevar8x32_epi32(v, _mm256_setr_epi32(7, 6, 5, 4, 3, 2, 1, 0)));
  v = exchanged<0xCC>(v, _mm256_shuffle_epi32(v, 0x4E));
  return exchanged<0xAA>(v, _mm256_shuffle_epi32(v, 0xB1));
}

// The nearest so far: block, triangle in it (three bits) and kind of block (two).
struct alignas(16) Nearest {
  float end, u, v;
  std::uint32_t what;
};
constexpr std::uint32_t what(Tree::Reference at, std::size_t triangle) {
  return (at >> 2) << 5 | static_cast<std::uint32_t>(triangle) << 2 | (at & 3u);
}
constexpr std::size_t block_of(std::uint32_t what) { return what >> 5; }
constexpr std::size_t triangle_of(std::uint32_t what) { return what >> 2 & 7u; }
static_assert(Tree::kMaxBlocks <= std::size_t{1} << 27);

// Surface and triangle. A ball is its surface's only triangle, instances follow all surfaces.
inline Tree::Triangle place_of(const Tree& tree, std::uint32_t what) {
  constexpr std::uint32_t kInstances = 1u << 31;
  const Tree::Block& block = tree.blocks[block_of(what)];
  switch (Tree::kind(what)) {
    case Tree::Kind::kTriangles:
      return tree.triangles[block.triangles.first + triangle_of(what)];
    case Tree::Kind::kInstance:
      return {kInstances | block.alone.number, 0};
    default:
      return {block.alone.number, 0};
  }
}

// A ray in flight.
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
  // Of a nearest hit in an instance, by the group's numbers.
  Tree::Triangle in_group;
  Tree::Reference at;
  std::uint32_t ray;
  std::uint32_t depth;
  // Where to go on, nearest last, and where it begins. Eight are written at a time.
  std::array<Tree::Reference, kStack> waiting;
  std::array<float, kStack> begins;
};

// Of the triangles of a leaf: distances, infinite where a triangle is missed, and coordinates.
struct Crossings {
  alignas(32) std::array<float, Tree::kWidth> distance, u, v;
};

inline void start(Walk& walk, const Tree& tree, const TimedRay& ray, std::uint32_t number) {
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
  walk.ray = number;
  walk.depth = 0;
  walk.at = tree.root;
}

inline void end_if(Walk& walk, bool blocked) {
  walk.nearest.what = blocked ? 0 : walk.nearest.what;
  walk.depth = blocked ? 0 : walk.depth;
}

// The boxes of a node's children that the ray meets before its end.
template <bool kAny>
[[gnu::always_inline]] inline void enter(Walk& walk, const Tree& tree) {
  const Tree::Node& node = tree.block(walk.at).node;
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
  // The last three bits of where a child begins are replaced by its number.
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
  _mm256_storeu_si256(reinterpret_cast<Whole*>(walk.begins.data() + walk.depth),
                      _mm256_andnot_si256(_mm256_set1_epi32(7), keys));
  walk.depth +=
      static_cast<std::uint32_t>(Tree::kWidth) - static_cast<std::uint32_t>(std::popcount(mask));
}

// Of edges that two triangles share both compute the same, so no ray passes between them.
template <bool kAny>
[[gnu::always_inline]] inline void cross(Walk& walk, const Tree& tree, Crossings& found) {
  const Tree::Triangles& leaf = tree.block(walk.at).triangles;
  const Whole corners[3] = {bytes_as_numbers(leaf.corner[0]), bytes_as_numbers(leaf.corner[1]),
                            bytes_as_numbers(leaf.corner[2])};
  // By corner and axis of the ray's frame: as they are, and from the ray's origin.
  Floats at[3][3], from[3][3];
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const Floats all = _mm256_load_ps(leaf.coordinates[walk.axes[axis]]);
    const Floats origin = all_lanes(walk.start[axis]);
    for (std::size_t k = 0; k < 3; ++k) {
      at[k][axis] = _mm256_permutevar8x32_ps(all, corners[k]);
      from[k][axis] = _mm256_sub_ps(at[k][axis], origin);
    }
  }
  const auto sheared = [&](std::size_t k, std::size_t axis) {
    return _mm256_fnmadd_ps(all_lanes(walk.shear[axis]), from[k][2], from[k][axis]);
  };
  const Floats ax = sheared(0, 0), ay = sheared(0, 1), bx = sheared(1, 0), by = sheared(1, 1),
               cx = sheared(2, 0), cy = sheared(2, 1);
  // Not fused: of p and q it is exactly minus that of q and p, and never of the wrong sign.
  const auto area = [](Floats px, Floats py, Floats qx, Floats qy) {
    return _mm256_sub_ps(_mm256_mul_ps(px, qy), _mm256_mul_ps(py, qx));
  };
  const Floats by_a = area(cx, cy, bx, by), by_b = area(ax, ay, cx, cy),
               by_c = area(bx, by, ax, ay);
  const Floats zero = _mm256_setzero_ps(), sum = _mm256_add_ps(_mm256_add_ps(by_a, by_b), by_c);
  const Floats inside =
      _mm256_or_ps(_mm256_cmp_ps(_mm256_min_ps(_mm256_min_ps(by_a, by_b), by_c), zero, _CMP_GE_OQ),
                   _mm256_cmp_ps(_mm256_max_ps(_mm256_max_ps(by_a, by_b), by_c), zero, _CMP_LE_OQ));
  const Floats whole = _mm256_div_ps(_mm256_set1_ps(1.0f), sum);
  // To the plane, by its normal from the corners as they are: interpolated between corners, what is
  // long and thin would be met far off its plane. One of the two edges is the shortest, whose
  // rounding is small compared with the triangle's width, and the products are subtracted without
  // loss (Kahan; Jeannerod, Louvet and Muller, Math. Comp. 82, 2013): by two long edges a needle's
  // plane is turned so far that rays meet the needle that they leave, from behind.
  Floats first[3], second[3];
  Floats to_third = zero, from_second = zero;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    first[axis] = _mm256_sub_ps(at[1][axis], at[0][axis]);
    const Floats third = _mm256_sub_ps(at[2][axis], at[0][axis]),
                 other = _mm256_sub_ps(at[2][axis], at[1][axis]);
    to_third = _mm256_fmadd_ps(third, third, to_third);
    from_second = _mm256_fmadd_ps(other, other, from_second);
  }
  const Floats other_is_shorter = _mm256_cmp_ps(from_second, to_third, _CMP_LT_OQ);
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const Floats base = _mm256_blendv_ps(at[0][axis], at[1][axis], other_is_shorter);
    second[axis] = _mm256_sub_ps(at[2][axis], base);
  }
  const auto without_loss = [](Floats px, Floats py, Floats qx, Floats qy) {
    const Floats product = _mm256_mul_ps(py, qx);
    const Floats rounding = _mm256_fnmadd_ps(py, qx, product);
    return _mm256_add_ps(_mm256_fmsub_ps(px, qy, product), rounding);
  };
  const Floats nx = without_loss(first[1], first[2], second[1], second[2]),
               ny = without_loss(first[2], first[0], second[2], second[0]),
               nz = without_loss(first[0], first[1], second[0], second[1]);
  const Floats facing = _mm256_fmadd_ps(nx, all_lanes(walk.shear[0]),
                                        _mm256_fmadd_ps(ny, all_lanes(walk.shear[1]), nz));
  const Floats height = _mm256_fmadd_ps(
      nx, from[0][0], _mm256_fmadd_ps(ny, from[0][1], _mm256_mul_ps(nz, from[0][2])));
  const Floats distance = _mm256_mul_ps(_mm256_div_ps(height, facing), all_lanes(walk.shear[2]));
  Floats hit = _mm256_and_ps(inside, _mm256_cmp_ps(sum, zero, _CMP_NEQ_OQ));
  hit = _mm256_and_ps(hit, _mm256_cmp_ps(distance, zero, _CMP_GT_OQ));
  const Floats end =
      _mm256_min_ps(all_lanes(walk.nearest.end), _mm256_set1_ps(std::numeric_limits<float>::max()));
  hit = _mm256_and_ps(hit, _mm256_cmp_ps(distance, end, _CMP_LE_OQ));
  if constexpr (kAny) {
    end_if(walk, _mm256_movemask_ps(hit) != 0);
  } else {
    _mm256_store_ps(found.distance.data(),
                    _mm256_blendv_ps(_mm256_set1_ps(kInfinite), distance, hit));
    _mm256_store_ps(found.u.data(), _mm256_mul_ps(by_b, whole));
    _mm256_store_ps(found.v.data(), _mm256_mul_ps(by_c, whole));
  }
}

}  // namespace nocturne::walking
