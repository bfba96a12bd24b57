#include "scene/sensor_extents.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace nocturne {
namespace {

// The trajectory of a moving sensor is cut into so many pieces.
constexpr std::size_t kPieces = 32;
// A hollow sensor's box is cut into so many along each axis.
constexpr int kCells = 16;

Vec3 absolute(Vec3 v) { return {std::fabs(v.x), std::fabs(v.y), std::fabs(v.z)}; }

bool same_frame(const Pose& a, const Pose& b) {
  return a.right == b.right && a.forward == b.forward;
}

// Half sizes along the scene's axes; for a frame that turns, those of all orientations that it may
// take.
Vec3 half_size(const Sensor& sensor, const Pose& pose, Film film, bool turns) {
  const Vec3 extent = sensor.extent(pose, film);
  if (turns) return length(extent) * Vec3{1.0f, 1.0f, 1.0f};
  return extent.x * absolute(pose.right) + extent.y * absolute(pose.up) +
         extent.z * absolute(pose.forward);
}

void add_around(Box& box, Vec3 position, Vec3 half) {
  box.add(position - half);
  box.add(position + half);
}

// The part of the box that is not within the hollow.
std::vector<Box> shell(const Box& whole, Vec3 centre, float hollow) {
  std::vector<Box> cells;
  const Vec3 cell = (1.0f / kCells) * (whole.high - whole.low);
  for (int i = 0; i < kCells * kCells * kCells; ++i) {
    const auto at = [&](int add) {
      return whole.low + Vec3{static_cast<float>(i % kCells + add) * cell.x,
                              static_cast<float>(i / kCells % kCells + add) * cell.y,
                              static_cast<float>(i / (kCells * kCells) + add) * cell.z};
    };
    const Vec3 low = at(0), high = at(1);
    if (length(larger(absolute(low - centre), absolute(high - centre))) >= hollow) {
      cells.push_back({low, high});
    }
  }
  return cells;
}

}  // namespace

std::vector<Box> boxes_of_starts(const Sensor& sensor) {
  const Film film{kMaxAspect, 1};
  const Motion& motion = sensor.motion();
  Box whole;
  if (!motion.moves()) {
    add_around(whole, motion.start().position, half_size(sensor, motion.start(), film, false));
    if (sensor.hollow() > 0.0f) return shell(whole, motion.start().position, sensor.hollow());
    return {whole};
  }
  // Poses lie on whole numbers of pieces.
  const std::size_t segments = motion.steps() - 1, pieces = (kPieces / segments + 1) * segments;
  std::vector<Box> boxes;
  for (std::size_t i = 0; i < pieces; ++i) {
    const auto time = [&](std::size_t step) {
      return static_cast<float>(step) / static_cast<float>(pieces);
    };
    const Pose from = motion.at(time(i)), to = motion.at(time(i + 1));
    const bool turns = !same_frame(from, to);
    Box& box = boxes.emplace_back();
    add_around(box, from.position, half_size(sensor, from, film, turns));
    add_around(box, to.position, half_size(sensor, to, film, turns));
  }
  return boxes;
}

Geometry::Ball ball_with_film(const Geometry::Ball& geometry, const Sensor& sensor, Film film) {
  Geometry::Ball ball = geometry;
  if (!sensor.splats_segments()) return ball;
  const Motion& motion = sensor.motion();
  for (std::size_t step = 0; step < motion.steps(); ++step) {
    const Pose pose = motion.at(
        motion.moves() ? static_cast<float>(step) / static_cast<float>(motion.steps() - 1) : 0.0f);
    const float radius = 1.001f * length(sensor.extent(pose, film));
    const Vec3 away = pose.position - ball.centre;
    const float distance = length(away);
    if (distance + radius <= ball.radius) continue;
    // The smallest around both.
    if (distance + ball.radius <= radius) {
      ball = {pose.position, radius};
      continue;
    }
    const float both = 0.5005f * (distance + radius + ball.radius);
    ball.centre = ball.centre + ((both - ball.radius) / distance) * away;
    ball.radius = both;
  }
  return ball;
}

float median_view(const Sensor& sensor, const Geometry& geometry,
                  std::span<const SurfaceMaterial> materials) {
  constexpr std::uint32_t kEdge = 16;
  constexpr int kMaxPassed = 100;
  const Film film{kEdge, kEdge};
  std::vector<float> distances;
  for (std::uint32_t i = 0; i < kEdge * kEdge; ++i) {
    const float time = static_cast<float>(i) / (kEdge * kEdge);
    Ray ray = sensor
                  .sample(film, static_cast<float>(i % kEdge) + 0.5f,
                          static_cast<float>(i / kEdge) + 0.5f, 0.5f, 0.5f, time)
                  .ray;
    float distance = 0.0f;
    for (int passed = 0; passed < kMaxPassed; ++passed) {
      const auto hit = geometry.intersect(ray, time);
      if (!hit) break;
      distance += hit->distance;
      if (!materials[hit->surface].may_pass && !materials[hit->surface].index_matched_only) {
        distances.push_back(distance);
        break;
      }
      ray.origin = leave_surface(*hit, ray.direction);
    }
  }
  if (distances.empty()) return Box::kInfinite;
  const auto middle = distances.begin() + static_cast<std::ptrdiff_t>(distances.size() / 2);
  std::nth_element(distances.begin(), middle, distances.end());
  return *middle;
}

}  // namespace nocturne
