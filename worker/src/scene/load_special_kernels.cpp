#include "scene/load_special_kernels.h"

#include <algorithm>
#include <vector>

#include "scene/load_textures.h"

namespace nocturne {
namespace {

const v1::Spectrum& without_lines(const LoadContext& context, std::uint32_t index) {
  context.spectrum(index);  // is there
  const v1::Spectrum& spectrum = context.message.spectra(static_cast<int>(index));
  require(spectrum.lines().empty(), "a fluorophore's spectrum with lines");
  return spectrum;
}

// Where a table bends within the scene's wavelengths, and their ends unless it is zero there.
std::vector<float> knots_of(const v1::Spectrum& table, const v1::Sensor& sensor) {
  double first = sensor.response_first_nm();
  double last = first + sensor.response_step_nm() * (sensor.response_y_size() - 1);
  const int count = table.values_size();
  if (count > 1 && table.zero_outside()) {
    first = std::max(first, table.first_nm());
    last = std::min(last, table.first_nm() + table.step_nm() * (count - 1));
  }
  require(first < last, "a fluorophore that no wavelength of the scene excites");
  std::vector<float> knots{static_cast<float>(first)};
  for (int i = 0; count > 1 && i < count; ++i) {
    const auto nm = static_cast<float>(table.first_nm() + table.step_nm() * i);
    if (nm > knots.back() && nm < static_cast<float>(last)) knots.push_back(nm);
  }
  knots.push_back(static_cast<float>(last));
  return knots;
}

Fluorophore load_fluorophore(const LoadContext& context,
                             const v1::Fluorescent::Fluorophore& message) {
  const v1::Spectrum& table = without_lines(context, message.absorption());
  without_lines(context, message.emission());
  const Spectrum& absorption = context.spectrum(message.absorption());
  const std::vector<float> knots = knots_of(table, context.message.sensor());
  std::vector<float> density;
  for (const float nm : knots) density.push_back(nm * absorption(nm));
  double excitation = 0.0;
  for (std::size_t i = 1; i < knots.size(); ++i) {
    // Of a parabola between knots: Simpson's rule is exact.
    const float middle = 0.5f * (knots[i - 1] + knots[i]);
    excitation += (knots[i] - knots[i - 1]) / 6.0 *
                  (density[i - 1] + 4.0 * (middle * absorption(middle)) + density[i]);
  }
  return {absorption, context.spectrum(message.emission()), WavelengthDensity(knots, density),
          finite(excitation, "a fluorophore's absorption")};
}

template <class Kernel>
bool has(const std::vector<AnyKernel>& kernels) {
  return std::ranges::any_of(
      kernels, [](const AnyKernel& kernel) { return std::holds_alternative<Kernel>(kernel); });
}

}  // namespace

Fluorophores load_fluorophores(
    const LoadContext& context,
    const google::protobuf::RepeatedPtrField<v1::Fluorescent::Fluorophore>& messages) {
  constexpr int kMaxFluorophores = 1000;
  require(messages.size() >= 1 && messages.size() <= kMaxFluorophores,
          "fluorescence of no fluorophore, or of more than 1000");
  Fluorophores loaded;
  for (const auto& each : messages) loaded.all.push_back(load_fluorophore(context, each));
  return loaded;
}

Fluorescent load_fluorescent(const LoadContext& context, const v1::Fluorescent& message) {
  return {load_colour(context, message.reflectance(), 1.0f),
          load_fluorophores(context, message.fluorophores())};
}

PolarisingFilter load_filter(const LoadContext& context, const v1::PolarisingFilter& message) {
  const Spectrum &along = context.spectrum(message.along()),
                 &across = context.spectrum(message.across());
  require(along.most() <= 1.0f && across.most() <= 1.0f, "a filter that transmits more than all");
  const Vec3 axis = vector(message.axis(), "a filter's axis");
  require(std::fabs(length(axis) - 1.0f) < 1e-3f, "a filter's axis that has not length 1");
  return {along, across, context.spectrum(message.retardance()), normalized(axis)};
}

bool is_polarised(const v1::Sensor& sensor, const std::vector<AnyKernel>& kernels) {
  return has<PolarisingFilter>(kernels) ||
         std::ranges::any_of(sensor.further_responses(),
                             [](const v1::Response& response) { return response.stokes() != 0; });
}

void check_special_kernels(const std::vector<AnyKernel>& kernels, bool polarised,
                           const TracingOptions& options) {
  const bool alone = options.direction == Direction::kAdjoint && options.sharing == 1;
  require(alone || !(has<Fluorescent>(kernels) || has<FluorescentPhase>(kernels)),
          "fluorescence where photons start from luminaires or share");
  require(alone || !polarised, "polarised light where photons start from luminaires or share");
}

}  // namespace nocturne
