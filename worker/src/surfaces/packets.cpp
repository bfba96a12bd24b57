#include "surfaces/packets.h"

#include <immintrin.h>

#include <algorithm>
#include <array>

#include "math/in_place.h"

namespace nocturne {
namespace {

// GCC warns of the register itself as an argument of a template.
struct Row {
  __m256 lanes;
};

// Eight rows of eight floats: their columns.
void transpose(std::array<Row, 8>& rows) {
  std::array<Row, 8> pairs, fours;
  for (std::size_t i = 0; i < 8; i += 2) {
    pairs[i].lanes = _mm256_unpacklo_ps(rows[i].lanes, rows[i + 1].lanes);
    pairs[i + 1].lanes = _mm256_unpackhi_ps(rows[i].lanes, rows[i + 1].lanes);
  }
  for (std::size_t i = 0; i < 8; i += 4) {
    for (std::size_t k = 0; k < 2; ++k) {
      fours[i + 2 * k].lanes = _mm256_shuffle_ps(pairs[i + k].lanes, pairs[i + 2 + k].lanes, 0x44);
      fours[i + 2 * k + 1].lanes =
          _mm256_shuffle_ps(pairs[i + k].lanes, pairs[i + 2 + k].lanes, 0xEE);
    }
  }
  for (std::size_t i = 0; i < 4; ++i) {
    rows[i].lanes = _mm256_permute2f128_ps(fours[i].lanes, fours[i + 4].lanes, 0x20);
    rows[i + 4].lanes = _mm256_permute2f128_ps(fours[i].lanes, fours[i + 4].lanes, 0x31);
  }
}

// A TimedRay begins with eight floats. Turned in registers: Embree reads lanes together what single
// stores would have left in pieces.
static_assert(sizeof(Ray) == 6 * sizeof(float) && offsetof(TimedRay, ray) == 0 &&
              offsetof(TimedRay, time) == 6 * sizeof(float) &&
              offsetof(TimedRay, end) == 7 * sizeof(float));

// Rays of a packet have nothing to do with each other: then Embree finds for each what it finds for
// it alone, bit for bit, whatever rays it is with (tests/worker/surfaces/packets_test.cpp).
template <class Packet>
void fill(Packet& packet, std::span<const TimedRay> rays, std::span<int> valid) {
  std::array<Row, kPacket> rows;
  for (std::size_t i = 0; i < kPacket; ++i) {
    valid[i] = i < rays.size() ? -1 : 0;
    rows[i].lanes = _mm256_loadu_ps(&rays[std::min(i, rays.size() - 1)].ray.origin.x);
  }
  transpose(rows);
  std::size_t row = 0;
  for (float* column : {packet.org_x, packet.org_y, packet.org_z, packet.dir_x, packet.dir_y,
                        packet.dir_z, packet.time, packet.tfar}) {
    _mm256_store_ps(column, rows[row++].lanes);
  }
  _mm256_store_ps(packet.tnear, _mm256_setzero_ps());
  const auto set = [](unsigned* column, int all) {
    _mm256_store_si256(reinterpret_cast<__m256i*>(column), _mm256_set1_epi32(all));
  };
  set(packet.mask, -1);
  set(packet.id, 0);
  set(packet.flags, 0);
}

// The triangles of a packet's hits outside instances: f(mesh, number).
template <class F>
void for_each_triangle(const EmbreeScene& scene, const RTCHit8& hit, const F& f) {
  for (std::size_t i = 0; i < kPacket; ++i) {
    if (hit.geomID[i] == RTC_INVALID_GEOMETRY_ID) continue;
    if (hit.instID[0][i] != RTC_INVALID_GEOMETRY_ID) continue;
    if (const auto* mesh = std::get_if<TriangleMesh>(&scene.shapes[hit.geomID[i]])) {
      f(*mesh, hit.primID[i]);
    }
  }
}
void prefetch_triangles(const EmbreeScene& scene, const RTCHit8& hit) {
  for_each_triangle(scene, hit, [](const TriangleMesh& mesh, std::uint32_t triangle) {
    __builtin_prefetch(&mesh.triangles[triangle]);
  });
}
void prefetch_corners(const EmbreeScene& scene, const RTCHit8& hit) {
  for_each_triangle(scene, hit, [](const TriangleMesh& mesh, std::uint32_t triangle) {
    for (const std::uint32_t corner : mesh.triangles[triangle]) {
      __builtin_prefetch(&mesh.vertices[corner]);
    }
  });
}

}  // namespace

void intersect_packets(const EmbreeScene& scene, std::span<const TimedRay> rays,
                       std::span<std::optional<Hit>> hits) {
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  context.flags = RTC_INTERSECT_CONTEXT_FLAG_INCOHERENT;
  // Large meshes lie in slow memory, which Embree does not touch for its own: corners are asked for
  // a packet before they are needed, and who they are two packets before.
  std::array<RTCRayHit8, 3> searched;
  const std::size_t behind = scene.is_large ? 2 : 0;
  const std::size_t packets = (rays.size() + kPacket - 1) / kPacket;
  for (std::size_t step = 0; step < packets + behind; ++step) {
    if (step < packets) {
      const std::size_t first = step * kPacket;
      const auto some = rays.subspan(first, std::min(kPacket, rays.size() - first));
      alignas(32) std::array<int, kPacket> valid;
      RTCRayHit8& query = searched[step % 3];
      fill(query.ray, some, valid);
      for (std::size_t i = 0; i < kPacket; ++i) {
        query.hit.geomID[i] = RTC_INVALID_GEOMETRY_ID;
        query.hit.instID[0][i] = RTC_INVALID_GEOMETRY_ID;
      }
      rtcIntersect8(valid.data(), scene.scene, &context, &query);
      if (scene.is_large) prefetch_triangles(scene, query.hit);
    }
    if (scene.is_large && step >= 1 && step <= packets) {
      prefetch_corners(scene, searched[(step - 1) % 3].hit);
    }
    if (step < behind) continue;
    const std::size_t first = (step - behind) * kPacket;
    const RTCRayHit8& query = searched[(step - behind) % 3];
    for (std::size_t i = first; i < std::min(first + kPacket, rays.size()); ++i) {
      const std::size_t lane = i - first;
      if (query.hit.geomID[lane] == RTC_INVALID_GEOMETRY_ID) {
        hits[i].reset();
        continue;
      }
      hits[i].emplace(InPlace{[&] {
        return scene.located(
            rays[i].ray.origin, rays[i].ray.direction, rays[i].time,
            {query.hit.geomID[lane], query.hit.instID[0][lane], query.hit.primID[lane],
             query.hit.u[lane], query.hit.v[lane], query.ray.tfar[lane]});
      }});
    }
  }
}

void occluded_packets(const EmbreeScene& scene, std::span<const TimedRay> rays,
                      std::span<std::uint8_t> blocked, Ways ways) {
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  context.flags = ways == Ways::kTogether ? RTC_INTERSECT_CONTEXT_FLAG_COHERENT
                                          : RTC_INTERSECT_CONTEXT_FLAG_INCOHERENT;
  for (std::size_t first = 0; first < rays.size(); first += kPacket) {
    const auto some = rays.subspan(first, std::min(kPacket, rays.size() - first));
    alignas(32) std::array<int, kPacket> valid;
    RTCRay8 query;
    fill(query, some, valid);
    rtcOccluded8(valid.data(), scene.scene, &context, &query);
    for (std::size_t i = 0; i < some.size(); ++i) blocked[first + i] = query.tfar[i] < 0.0f ? 1 : 0;
  }
}

}  // namespace nocturne
