#include "image/write_exr.h"

#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfIntAttribute.h>
#include <ImfOutputFile.h>
#include <ImfStandardAttributes.h>
#include <ImfStringAttribute.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <stdexcept>
#include <vector>

namespace nocturne {
namespace {

// As many floats for a pixel as it has sums: X, Y, Z, Y.stderr, further responses.
void put_pixel(std::span<const double> sums, std::uint32_t samples, float* pixel) {
  const double n = samples;
  for (std::size_t i = 0; i < sums.size(); ++i) pixel[i] = static_cast<float>(sums[i] / n);
  const double variance_of_mean =
      samples < 2 ? 0.0 : (sums[3] - sums[1] * sums[1] / n) / (n * (n - 1.0));
  pixel[3] = static_cast<float>(std::sqrt(std::max(0.0, variance_of_mean)));
}

// IEC 61966-2-1: XYZ of white D65 to linear sRGB, and the primaries and the white of that.
constexpr float kRgbOfXyz[3][3] = {
    {3.2406f, -1.5372f, -0.4986f}, {-0.9689f, 1.8758f, 0.0415f}, {0.0557f, -0.2040f, 1.0570f}};
const Imf::Chromaticities kSrgb{{0.64f, 0.33f}, {0.30f, 0.60f}, {0.15f, 0.06f}, {0.3127f, 0.3290f}};
constexpr std::array<const char*, 3> kRgb{"R", "G", "B"};

// R, G and B of each pixel, from values that begin with X, Y and Z.
std::vector<float> rgb_of(std::span<const float> values, std::size_t channels) {
  std::vector<float> rgb;
  rgb.reserve(3 * values.size() / channels);
  for (std::size_t i = 0; i < values.size(); i += channels) {
    for (const auto& row : kRgbOfXyz) {
      rgb.push_back(row[0] * values[i] + row[1] * values[i + 1] + row[2] * values[i + 2]);
    }
  }
  return rgb;
}

}  // namespace

void write_exr(const std::filesystem::path& path, std::uint32_t width, std::uint32_t height,
               std::span<const double> sums, std::span<const std::string> further_responses,
               std::uint32_t samples, const ImageProvenance& provenance) {
  std::vector<std::string> names{"X", "Y", "Z", "Y.stderr"};
  names.insert(names.end(), further_responses.begin(), further_responses.end());
  const std::size_t channels = names.size();
  const std::size_t pixels = static_cast<std::size_t>(width) * height;
  if (sums.size() != channels * pixels) {
    throw std::invalid_argument("an image's sums don't fit its channels");
  }
  std::vector<float> values(sums.size());
  for (std::size_t i = 0; i < pixels; ++i) {
    put_pixel(sums.subspan(channels * i, channels), samples, &values[channels * i]);
  }
  std::vector<std::uint32_t> counts(pixels, samples);

  Imf::Header header(static_cast<int>(width), static_cast<int>(height));
  header.compression() = Imf::ZIP_COMPRESSION;
  // Of R, G, B; X, Y, Z are CIE XYZ itself.
  Imf::addChromaticities(header, kSrgb);
  // OpenEXR's own: a luminance of 1 is 1 cd/m2.
  if (provenance.quantity == "luminance") Imf::addWhiteLuminance(header, 1.0f);
  header.insert("nocturne:quantity", Imf::StringAttribute(provenance.quantity));
  header.insert("nocturne:unit", Imf::StringAttribute(provenance.unit));
  header.insert("nocturne:responseUnit", Imf::StringAttribute(provenance.response_unit));
  header.insert("nocturne:scene", Imf::StringAttribute(provenance.scene_sha256));
  header.insert("nocturne:schedule", Imf::StringAttribute(provenance.plan));
  header.insert("nocturne:engine", Imf::IntAttribute(static_cast<int>(provenance.engine)));
  header.insert("nocturne:floatingPointProfile",
                Imf::StringAttribute(provenance.floating_point_profile));
  if (provenance.truncated_paths > 0) {
    header.insert("nocturne:truncatedPaths",
                  Imf::StringAttribute(std::to_string(provenance.truncated_paths)));
  }

  Imf::FrameBuffer buffer;
  const auto add = [&](const std::string& name, Imf::PixelType type, void* first,
                       std::size_t stride) {
    if (header.channels().findChannel(name) != nullptr) {
      throw std::invalid_argument("two channels of an image are named " + name);
    }
    header.channels().insert(name, Imf::Channel(type));
    buffer.insert(name, Imf::Slice(type, static_cast<char*>(first), stride, stride * width));
  };
  for (std::size_t i = 0; i < channels; ++i) {
    add(names[i], Imf::FLOAT, &values[i], channels * sizeof(float));
  }
  add("n", Imf::UINT, counts.data(), sizeof(std::uint32_t));
  // A sensor may have responses with these names: they say more than what only viewers need.
  std::vector<float> rgb;
  if (std::ranges::find_first_of(further_responses, kRgb) == further_responses.end()) {
    rgb = rgb_of(values, channels);
    for (std::size_t i = 0; i < 3; ++i) add(kRgb[i], Imf::FLOAT, &rgb[i], 3 * sizeof(float));
  }

  Imf::OutputFile file(path.c_str(), header);
  file.setFrameBuffer(buffer);
  file.writePixels(static_cast<int>(height));
}

}  // namespace nocturne
