#include "surfaces/shading_normal.h"

namespace nocturne {
namespace {

// A perturbed normal that would be behind the surface is lifted until its cosine with the geometric
// normal is this.
constexpr float kMinCosine = 1e-3f;

Vec3 in_front(Vec3 normal, const SurfaceDetail& detail) {
  const float square = dot(normal, normal);
  if (!(square > 0.0f) || !std::isfinite(square)) return detail.shading_normal;
  const Vec3 n = (1.0f / std::sqrt(square)) * normal;
  const float cosine = dot(n, detail.geometric_normal);
  if (cosine >= kMinCosine) return n;
  const Vec3 level = n - cosine * detail.geometric_normal;
  const float sine = length(level);
  // Straight behind: no direction to lift it towards.
  if (!(sine > kMinCosine)) return detail.shading_normal;
  return normalized((1.0f / sine) * level + kMinCosine * detail.geometric_normal);
}

}  // namespace

Frame frame_along(Vec3 normal, Vec3 along) {
  Frame frame(normal);
  const Vec3 tangent = along - dot(along, normal) * normal;
  const float size = length(tangent);
  if (!(size > 1e-6f * length(along))) return frame;
  frame.tangent = (1.0f / size) * tangent;
  frame.bitangent = cross(normal, frame.tangent);
  return frame;
}

Vec3 mapped_normal(const SurfaceDetail& detail, Vec3 tangent_space) {
  const Frame frame = frame_along(detail.shading_normal, detail.dp_du);
  // Texture coordinates may run the other way round.
  const float turn = dot(frame.bitangent, detail.dp_dv) < 0.0f ? -1.0f : 1.0f;
  return in_front(frame.to_world({tangent_space.x, turn * tangent_space.y, tangent_space.z}),
                  detail);
}

Vec3 bumped_normal(const SurfaceDetail& detail, float dh_du, float dh_dv) {
  const Vec3 n = detail.shading_normal;
  const float area = dot(n, cross(detail.dp_du, detail.dp_dv));
  if (area == 0.0f) return n;
  const Vec3 gradient =
      (1.0f / area) * (dh_du * cross(detail.dp_dv, n) + dh_dv * cross(n, detail.dp_du));
  return in_front(n - gradient, detail);
}

}  // namespace nocturne
