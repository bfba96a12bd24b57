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

// Rays of a packet have nothing to do with each other: then Embree gives each the same result as
// for it alone, bit for bit, whatever rays it is with (tests/worker/surfaces/packets_test.cpp).
template <class Packet>
void fill(Packet& packet, std::span<const TimedRay> rays, std::span<int> valid) {
  std::array<Row, kPacket> rows;
  for (std::size_t i = 0; i < kPacket; ++i) {
    rows[i].lanes = _mm256_loadu_ps(&rays[std::min(i, rays.size() - 1)].ray.origin.x);
  }
  transpose(rows);
  const __m256 positive = _mm256_castsi256_ps(_mm256_set1_epi32(0x7fffffff));
  const __m256 end = rows[kPacket - 1].lanes;
  __m256 usable = _mm256_cmp_ps(end, end, _CMP_EQ_OQ);
  for (std::size_t i = 0; i + 1 < kPacket; ++i) {
    const __m256 size = _mm256_and_ps(rows[i].lanes, positive);
    usable = _mm256_and_ps(usable, _mm256_cmp_ps(size, _mm256_set1_ps(kMostSearched), _CMP_LT_OQ));
  }
  const int usable_lanes = _mm256_movemask_ps(usable);
  for (std::size_t i = 0; i < kPacket; ++i) {
    valid[i] = i < rays.size() && (usable_lanes >> i & 1) != 0 ? -1 : 0;
  }
  std::size_t row = 0;
  for (float* column : {packet.org_x, packet.org_y, packet.org_z, packet.dir_x, packet.dir_y,
                        packet.dir_z, packet.time, packet.tfar}) {
    _mm256_store_ps(column, rows[row++].lanes);
  }
  _mm256_store_ps(packet.tnear, _mm256_set1_ps(kBeyondStart));
  const auto set = [](unsigned* column, int all) {
    _mm256_store_si256(reinterpret_cast<__m256i*>(column), _mm256_set1_epi32(all));
  };
  set(packet.mask, -1);
  set(packet.id, 0);
  set(packet.flags, 0);
}

}  // namespace

void intersect_packets(const EmbreeScene& scene, std::span<const TimedRay> rays,
                       std::span<std::optional<Hit>> hits) {
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  context.flags = RTC_INTERSECT_CONTEXT_FLAG_INCOHERENT;
  for (std::size_t first = 0; first < rays.size(); first += kPacket) {
    const auto some = rays.subspan(first, std::min(kPacket, rays.size() - first));
    alignas(32) std::array<int, kPacket> valid;
    RTCRayHit8 query;
    fill(query.ray, some, valid);
    for (std::size_t i = 0; i < kPacket; ++i) {
      query.hit.geomID[i] = RTC_INVALID_GEOMETRY_ID;
      query.hit.instID[0][i] = RTC_INVALID_GEOMETRY_ID;
    }
    rtcIntersect8(valid.data(), scene.scene, &context, &query);
    for (std::size_t i = 0; i < some.size(); ++i) {
      hits[first + i].reset();
      if (query.hit.geomID[i] == RTC_INVALID_GEOMETRY_ID) continue;
      hits[first + i].emplace(InPlace{[&] {
        return scene.located(some[i].ray.origin, some[i].ray.direction, some[i].time,
                             {query.hit.geomID[i], query.hit.instID[0][i], query.hit.primID[i],
                              query.hit.u[i], query.hit.v[i], query.ray.tfar[i]});
      }});
    }
  }
}

void occluded_packets(RTCScene in, std::span<const TimedRay> rays, std::span<std::uint8_t> blocked,
                      RayCoherence coherence) {
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  context.flags = coherence == RayCoherence::kCoherent ? RTC_INTERSECT_CONTEXT_FLAG_COHERENT
                                                       : RTC_INTERSECT_CONTEXT_FLAG_INCOHERENT;
  for (std::size_t first = 0; first < rays.size(); first += kPacket) {
    const auto some = rays.subspan(first, std::min(kPacket, rays.size() - first));
    alignas(32) std::array<int, kPacket> valid;
    RTCRay8 query;
    fill(query, some, valid);
    rtcOccluded8(valid.data(), in, &context, &query);
    for (std::size_t i = 0; i < some.size(); ++i) {
      if (query.tfar[i] < 0.0f) blocked[first + i] = 1;
    }
  }
}

}  // namespace nocturne
