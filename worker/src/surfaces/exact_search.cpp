#include "surfaces/exact_search.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <tuple>

namespace nocturne {
namespace {

// What a single ray's search offers its filter.
Found offered(const RTCFilterFunctionNArguments* arguments) {
  RTCHitN* hit = arguments->hit;
  return {RTCHitN_geomID(hit, 1, 0), RTCHitN_instID(hit, 1, 0, 0),
          RTCHitN_primID(hit, 1, 0), RTCHitN_u(hit, 1, 0),
          RTCHitN_v(hit, 1, 0),      RTCRayN_tfar(arguments->ray, 1, 0)};
}

// Of the surfaces that a line crosses close together.
constexpr std::size_t kMaxNear = 32;

// A line. Embree measures from `back` metres behind its origin.
struct Line {
  Double3 origin;
  Vec3 direction;
  float time;
  double back = 0.0;
  // The surface that the ray left where it starts.
  std::optional<Crossed> left = {};
  // For a ray that starts in a medium: the surface it left before.
  std::optional<Crossed> passed = {};
};

// `found` has the shape's own number.
Crossed crossed_shape(const EmbreeScene& scene, const Line& line, Found found) {
  found.distance = static_cast<float>(found.distance - line.back);
  const auto cross = [&](const Shape& shape, const Placement* placement) {
    return cross_exactly(shape, placement, line.origin, line.direction, found, line.time);
  };
  return {found.surface, found.instance, found.primitive,
          scene.with_placement(found.surface, found.instance, line.time, cross)};
}
// `found` has Embree's.
Crossed crossed(const EmbreeScene& scene, const Line& line, Found found) {
  if (found.instance != Hit::kNoInstance) {
    found.surface = (*scene.instance_surfaces[found.instance])[found.surface];
  }
  return crossed_shape(scene, line, found);
}

Line line_of(const EmbreeScene& scene, const Ray& ray, float time, const Departure& departure) {
  Line line{departure.start(ray), ray.direction, time};
  if (departure.surface == Departure::kNothing) return line;
  const Crossed before = crossed_shape(
      scene, line, {departure.surface, departure.instance, departure.primitive, 0.0f, 0.0f, 0.0f});
  if (departure.in_medium) {
    line.passed = before;
    return line;
  }
  line.left = before;
  line.left->at.distance = 0.0;
  return line;
}

// The surfaces a line crosses close together, the one it left among them.
struct Picture {
  Picture() {}  // what is not there need not be zero

  std::array<Crossed, kMaxNear + 1> crossed;
  std::array<Found, kMaxNear> found;
  std::size_t count = 0;

  void add(const Crossed& at, const Found& as_found) {
    if (count == found.size()) return;
    found[count] = as_found;
    crossed[count++] = at;
  }
  // The last is the surface that was left, now or before.
  std::span<const Crossed> with(const Line& line) {
    if (!line.left && !line.passed) return std::span(crossed).first(count);
    crossed[count] = line.left ? *line.left : *line.passed;
    return std::span(crossed).first(count + 1);
  }
};

// f(index) of those that lie before a ray along the line, and were not crossed where it starts.
template <class F>
void for_each_ahead(const EmbreeScene& scene, const Line& line, Picture& picture, const F& f) {
  const auto all = picture.with(line);
  for (std::size_t i = 0; i < picture.count; ++i) {
    const auto order = line.left ? sheet_order(all, picture.count, i, scene.close) : std::nullopt;
    if (!order.value_or(all[i].at.distance > 0.0)) continue;
    if (line.left && (same_crossing(scene.shapes[all[i].surface], *line.left, all[i]) ||
                      touch(all, picture.count, i, scene.close))) {
      continue;
    }
    // Crossed together with the surface behind, where the medium was entered.
    if (line.passed && !(line.passed->at.distance > 0.0) &&
        touch(all, picture.count, i, scene.close)) {
      continue;
    }
    f(i);
  }
}

// Near the start takes down every hit, to be looked at in double precision; beyond finds the
// nearest.
struct NearestAhead {
  ExactContext context;  // first: Embree hands back a pointer to it
  const EmbreeScene& scene;
  const Line& line;
  // From here on Embree's numbers tell.
  float certain;
  bool grazing;
  Picture picture;

  NearestAhead(const EmbreeScene& all, const Line& along, float certain_from, bool is_grazing)
      : scene(all), line(along), certain(certain_from), grazing(is_grazing) {
    rtcInitIntersectContext(&context.context);
    context.context.filter = decide;
    context.origin = along.origin - along.back * Double3(along.direction);
  }

  static void decide(const RTCFilterFunctionNArguments* arguments) {
    auto& self = *reinterpret_cast<NearestAhead*>(arguments->context);
    const Found found = offered(arguments);
    if (found.distance > self.certain) {
      if (self.grazing && self.leaves_here(found)) arguments->valid[0] = 0;
      return;
    }
    self.picture.add(crossed(self.scene, self.line, found), found);
    arguments->valid[0] = 0;
  }
  // A neighbour of the surface that was left, all but parallel to the ray.
  bool leaves_here(const Found& found) const {
    const Crossed again = crossed(scene, line, found);
    return line.left && same_crossing(scene.shapes[again.surface], *line.left, again);
  }
};

}  // namespace

std::optional<Hit> nearest_ahead(const EmbreeScene& scene, const Ray& ray, float time,
                                 const Departure& departure) {
  // Closer to the tangent a hit may be wrong by more along the ray than the search looks back.
  constexpr double kMinCosine = 1e-3, kGrazing = 1e-2;
  Line line = line_of(scene, ray, time, departure);
  // From within a medium a surface may be met at any angle.
  const double cosine = line.left ? std::fabs(line.left->at.facing) : kMinCosine;
  const double reach = line.left ? scene.close[line.left->surface].reach : scene.largest_reach;
  line.back = 2.0 * reach / std::max(kMinCosine, cosine);
  const Double3 from = line.origin - line.back * Double3(ray.direction);
  NearestAhead search(scene, line, static_cast<float>(3.0 * line.back), cosine < kGrazing);
  RTCRayHit query = embree_query({from.rounded(), ray.direction}, time);
  if (can_be_searched(query.ray)) rtcIntersect1(scene.scene, &search.context.context, &query);
  std::size_t first = kMaxNear;
  for_each_ahead(scene, line, search.picture, [&](std::size_t i) {
    const auto distance = [&](std::size_t j) { return search.picture.crossed[j].at.distance; };
    if (first == kMaxNear || distance(i) < distance(first)) first = i;
  });
  if (first != kMaxNear) {
    Hit hit = scene.located(from, ray.direction, time, search.picture.found[first]);
    hit.distance = std::max(0.0f, static_cast<float>(search.picture.crossed[first].at.distance));
    return hit;
  }
  if (query.hit.geomID == RTC_INVALID_GEOMETRY_ID) return std::nullopt;
  const Found found = found_by(query);
  Hit hit = scene.located(from, ray.direction, time, found);
  // A medium scatters up to the surface exactly.
  hit.distance = static_cast<float>(crossed(scene, line, found).at.distance);
  return hit;
}

std::size_t crossings_near(const EmbreeScene& scene, const Ray& ray, float time,
                           const Departure& departure, const Hit& hit, float reach,
                           std::span<NearCrossing> found) {
  Line line = line_of(scene, ray, time, departure);
  line.back = reach - static_cast<double>(hit.distance);
  // From close by, where Embree's numbers are small.
  const Double3 from = line.origin - line.back * Double3(ray.direction);
  NearestAhead search(scene, line, std::numeric_limits<float>::infinity(), false);
  RTCRayHit query = embree_query({from.rounded(), ray.direction}, time);
  query.ray.tfar = 2.0f * reach;
  if (can_be_searched(query.ray)) rtcIntersect1(scene.scene, &search.context.context, &query);
  Picture& picture = search.picture;
  std::array<std::size_t, kMaxNear> ahead;
  std::size_t count = 0;
  for_each_ahead(scene, line, picture, [&](std::size_t i) { ahead[count++] = i; });
  const auto order = [&](std::size_t i) {
    const Crossed& c = picture.crossed[i];
    return std::tuple(c.at.distance, c.surface, c.instance, c.primitive);
  };
  std::sort(ahead.begin(), ahead.begin() + static_cast<std::ptrdiff_t>(count),
            [&](std::size_t a, std::size_t b) { return order(a) < order(b); });
  const auto all = picture.with(line);
  for (std::size_t i = count; i-- > 1;) {
    if (sheet_order(all, ahead[i], ahead[i - 1], scene.close).value_or(false)) {
      std::swap(ahead[i], ahead[i - 1]);
    }
  }
  if (count > 0 && departure.exact && !line.left) {
    // In a medium, between surfaces that touch: the surface behind was not crossed either.
    for (std::size_t i = 0; i < picture.count; ++i) {
      if (!(all[i].at.distance > 0.0) && touch(all, ahead[0], i, scene.close)) {
        ahead[count++] = i;
      }
    }
  }
  count = std::min(count, found.size());
  for (std::size_t i = 0; i < count; ++i) {
    found[i] = {scene.located(from, ray.direction, time, picture.found[ahead[i]]), all[ahead[i]].at,
                i == 0 || touch(all, ahead[0], ahead[i], scene.close)};
    found[i].hit.distance = std::max(0.0f, static_cast<float>(found[i].at.distance));
  }
  return count;
}

}  // namespace nocturne
