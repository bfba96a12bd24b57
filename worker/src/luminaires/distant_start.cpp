#include "luminaires/distant_start.h"

#include <algorithm>

#include "math/constants.h"
#include "math/frame.h"
#include "pdfs/directions.h"

namespace nocturne {
namespace {

/// Each is looked at for each photon.
constexpr std::size_t kMostAims = 64;

Geometry::Ball ball_around(const Box& box) {
  return {box.middle(), 0.5f * length(box.high - box.low)};
}

Box all_of(const Elements& elements) {
  Box box;
  for (std::size_t i = 0; i < elements.size(); ++i) box.add(elements.bounds(i));
  return box;
}

float area(const Geometry::Ball& ball) { return kPi * ball.radius * ball.radius; }

}  // namespace

DistantStart::DistantStart(const Elements& important, std::optional<Geometry::Ball> reached)
    : reached_(reached) {
  const std::size_t count = important.size();
  if (count == 0) return;
  if (count > kMostAims) {
    aims_.push_back({ball_around(all_of(important)), 1.0f});
    return;
  }
  const double total = important.total_weight();
  for (std::size_t i = 0; i < count; ++i) {
    const ElementBounds& element = important.bounds(i);
    Geometry::Ball ball = ball_around(element);
    if (important.is_ball_at_rest(i)) ball.radius = 0.5f * (element.high.x - element.low.x);
    aims_.push_back({ball, static_cast<float>(element.weight / total)});
  }
}

DistantStart::Start DistantStart::sample(Vec3 towards, const Geometry::Ball& lit, float aimed,
                                         const Uniform4& u) const {
  const Frame frame(towards);
  const Vec3 disc = CosineHemisphere::sample(u[0], u[1]);  // x, y uniform on the unit disc
  const Vec3 on_disc = disc.x * frame.tangent + disc.y * frame.bitangent;
  const auto from = [&](Vec3 from_middle, float pdf) {
    return Start{lit.centre + lit.radius * towards + from_middle, pdf};
  };
  const auto middle_of = [&](const Geometry::Ball& ball) {
    const Vec3 away = ball.centre - lit.centre;
    return away - dot(away, towards) * towards;
  };
  const Geometry::Ball whole = reached_ ? *reached_ : lit;
  const Vec3 middle = reached_ ? middle_of(whole) : Vec3{0.0f, 0.0f, 0.0f};
  Vec3 from_middle = middle + whole.radius * on_disc;
  if (aims_.empty() || !(aimed > 0.0f)) return from(from_middle, 1.0f / area(whole));
  std::size_t chosen = aims_.size();  // none
  if (u[2] < aimed) {
    chosen = 0;
    for (float rest = u[3]; chosen + 1 < aims_.size() && rest >= aims_[chosen].part; ++chosen) {
      rest -= aims_[chosen].part;
    }
    from_middle = middle_of(aims_[chosen].ball) + aims_[chosen].ball.radius * on_disc;
  }
  const auto within = [](Vec3 offset, float radius) {
    return dot(offset, offset) <= radius * radius;
  };
  const bool anywhere = chosen == aims_.size() || within(from_middle - middle, whole.radius);
  float pdf = anywhere ? (1.0f - aimed) / area(whole) : 0.0f;
  for (std::size_t i = 0; i < aims_.size(); ++i) {
    const Aim& aim = aims_[i];
    // A start drawn at a rim may be rounded off it.
    if (i == chosen || within(from_middle - middle_of(aim.ball), aim.ball.radius)) {
      pdf += aimed * aim.part / area(aim.ball);
    }
  }
  return from(from_middle, pdf);
}

}  // namespace nocturne
