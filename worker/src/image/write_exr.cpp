#include "image/write_exr.h"

#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfIntAttribute.h>
#include <ImfOutputFile.h>
#include <ImfStandardAttributes.h>
#include <ImfStringAttribute.h>

#include <algorithm>
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
  // Channels X, Y, Z are CIE XYZ itself.
  Imf::addChromaticities(header, {{1, 0}, {0, 1}, {0, 0}, {1.0f / 3, 1.0f / 3}});
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

  Imf::OutputFile file(path.c_str(), header);
  file.setFrameBuffer(buffer);
  file.writePixels(static_cast<int>(height));
}

}  // namespace nocturne
