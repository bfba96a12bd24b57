#include "scene/load_sensor.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "math/functions.h"

namespace nocturne {
namespace {

// Partials would be too large to hand over.
constexpr int kMaxFurtherResponses = 60;
// More than responses could tell apart.
constexpr std::uint32_t kMaxLightGroups = 64;
constexpr int kMaxMeters = 1 << 20;
// Three for each of many lines.
constexpr int kMaxKnots = 100'000;

template <class PoseMessage>
Pose pose(const PoseMessage& message) {
  return {vector(message.position(), "the sensor's position"),
          vector(message.right(), "the sensor's right"), vector(message.up(), "the sensor's up"),
          vector(message.forward(), "the sensor's forward")};
}

SensorModel perspective(const v1::Sensor& s) {
  require(s.vertical_field_of_view() > 0.0 && s.vertical_field_of_view() < std::numbers::pi,
          "a field of view outside (0, pi)");
  require(s.lens_radius() >= 0.0 && (s.lens_radius() == 0.0 || s.focus_distance() > 0.0),
          "a lens without a focus distance");
  const Pinhole film(finite(math::tan(0.5 * s.vertical_field_of_view()), "the field of view"));
  if (s.lens_radius() == 0.0) return film;
  return ThinLens(film,
                  Aperture(finite(s.lens_radius(), "the lens radius"), s.aperture_blades(),
                           finite(s.aperture_angle(), "the aperture's angle")),
                  finite(s.focus_distance(), "the focus distance"));
}

MeterBody body(v1::MeterBody body) {
  switch (body) {
    case v1::METER_BODY_PLANE:
      return MeterBody::kPlane;
    case v1::METER_BODY_CYLINDER:
      return MeterBody::kCylinder;
    case v1::METER_BODY_HALF_CYLINDER:
      return MeterBody::kHalfCylinder;
    case v1::METER_BODY_HALF_SPHERE:
      return MeterBody::kHalfSphere;
    case v1::METER_BODY_SPHERE:
      return MeterBody::kSphere;
    default:
      refuse("a meter's body that this program doesn't know");
  }
}

Vec3 unit_vector(const v1::Vector& v, const char* what) {
  const Vec3 found = vector(v, what);
  require(std::fabs(length(found) - 1.0f) < 1e-3f, "a meter's direction that has not length 1");
  return normalized(found);
}

Meters meters(const v1::Sensor& s) {
  require(s.meters_size() <= kMaxMeters, "too many meters");
  std::vector<Meter> meters;
  for (const auto& m : s.meters()) {
    const float factor = m.factor() == 0.0 ? 1.0f : finite(m.factor(), "a meter's factor");
    require(factor > 0.0f, "a meter's factor that is not above 0");
    meters.push_back({vector(m.place(), "a meter's place"),
                      unit_vector(m.normal(), "a meter's normal"),
                      unit_vector(m.facing(), "what a meter faces"), body(m.body()), factor});
  }
  return Meters(std::move(meters));
}

SensorModel model(const v1::Sensor& s) {
  switch (s.model()) {
    case v1::SENSOR_MODEL_PERSPECTIVE:
      return perspective(s);
    case v1::SENSOR_MODEL_ORTHOGRAPHIC:
      return Orthographic(FilmRectangle(finite(s.height(), "the film's height")));
    case v1::SENSOR_MODEL_PANORAMA:
      return Panorama{};
    case v1::SENSOR_MODEL_PLANE:
      return Plane(FilmRectangle(finite(s.height(), "the film's height")));
    case v1::SENSOR_MODEL_RADIANCE_METER:
      return RadianceMeter(finite(s.height(), "the meter's diameter"),
                           finite(s.acceptance(), "the meter's acceptance"));
    case v1::SENSOR_MODEL_INTENSITY:
      return IntensityMeter(finite(s.lamp_radius(), "the lamp's radius"));
    case v1::SENSOR_MODEL_METERS:
      return meters(s);
    default:
      refuse("a sensor that this program doesn't know");
  }
}

std::vector<float> curve(const google::protobuf::RepeatedField<float>& values) {
  for (const float value : values) {
    require(std::isfinite(value) && value >= 0.0f, "a response that is negative or infinite");
  }
  return {values.begin(), values.end()};
}

DensityTable load_density(const v1::Sensor& s) {
  require(s.wavelength_knots_size() <= kMaxKnots, "a wavelength density of more than 100000 knots");
  DensityTable table{{}, {s.wavelength_density().begin(), s.wavelength_density().end()}};
  for (const double nm : s.wavelength_knots()) table.knots_nm.push_back(finite(nm, "a wavelength"));
  return table;
}

}  // namespace

Sensor load_sensor(const v1::Sensor& message) {
  return checked([&] {
    std::vector<Pose> poses{pose(message)};
    for (const auto& later : message.later_poses()) poses.push_back(pose(later));
    return Sensor(model(message), Motion(std::move(poses)));
  });
}

namespace {

LightPart light_part(v1::LightPart part) {
  switch (part) {
    case v1::LIGHT_PART_WHOLE:
      return LightPart::kWhole;
    case v1::LIGHT_PART_DIRECT:
      return LightPart::kDirect;
    case v1::LIGHT_PART_INDIRECT:
      return LightPart::kIndirect;
    default:
      break;
  }
  refuse("a part of the light that this program doesn't know");
}

// Values before it: X, Y, Z, further responses.
SumOfValues sum_of_values(const v1::Response& response, std::size_t before) {
  SumOfValues sum;
  for (const auto& term : response.terms()) {
    require(term.value() < before, "a response that is a sum of later ones");
    require(std::isfinite(term.factor()), "a sum of responses with an impossible factor");
    sum.terms.push_back({term.value(), term.factor()});
  }
  return sum;
}

CountedLight counted_light(const v1::Response& response) {
  if (response.terms_size() > 0) return {LightPart::kWhole, 0, true};
  if (response.stokes() != 0) {
    require(response.stokes() <= 3, "a number of the Stokes vector beyond 3");
    require(!response.has_light_group() && response.light() == v1::LIGHT_PART_WHOLE,
            "a response to polarised light of a part");
    return {LightPart::kWhole, response.stokes() - 1, true};
  }
  if (!response.has_light_group()) return {light_part(response.light())};
  require(response.light() == v1::LIGHT_PART_WHOLE,
          "a response to a part of the light of a light group");
  require(response.light_group() < kMaxLightGroups, "a light group of too large a number");
  return {LightPart::kWhole, response.light_group()};
}

}  // namespace

WavelengthSampler load_wavelengths(const v1::Sensor& s) {
  require(s.wavelength_sampling() == v1::WAVELENGTH_SAMPLING_RESPONSE ||
              s.wavelength_sampling() == v1::WAVELENGTH_SAMPLING_UNIFORM,
          "a wavelength sampling that this program doesn't know");
  require(s.further_responses_size() <= kMaxFurtherResponses, "more than 60 further responses");
  ResponseCurves curves{finite(s.response_first_nm(), "a wavelength"),
                        finite(s.response_step_nm(), "a wavelength step"),
                        curve(s.response_x()),
                        curve(s.response_y()),
                        curve(s.response_z()),
                        {}};
  for (const auto& further : s.further_responses()) {
    curves.further.push_back(curve(further.values()));
    curves.counted.push_back(counted_light(further));
    require(further.terms_size() > 0 || curves.sums.empty(), "a response after sums of others");
    if (further.terms_size() > 0) {
      curves.sums.push_back(sum_of_values(further, 2 + curves.further.size() - curves.sums.size()));
    }
  }
  const auto some = [&](const auto& f) { return std::ranges::any_of(curves.counted, f); };
  require(!some(&CountedLight::stokes) ||
              !some([](const CountedLight& light) { return !light.all() && !light.stokes; }),
          "responses to polarised light and to parts of the light");
  return checked([&] {
    if (s.wavelength_knots_size() > 0 || s.wavelength_density_size() > 0) {
      return WavelengthSampler(curves, load_density(s));
    }
    return WavelengthSampler(curves, s.wavelength_sampling() == v1::WAVELENGTH_SAMPLING_RESPONSE);
  });
}

}  // namespace nocturne
