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
#include <vector>

namespace nocturne {
namespace {

// One pixel as it lies in memory for the file.
struct Pixel {
  float x, y, z, y_stderr;
  std::uint32_t n;
};

Pixel pixel_from_sums(const double* sums, std::uint32_t samples) {
  const double n = samples;
  const double variance_of_mean =
      samples < 2 ? 0.0 : (sums[3] - sums[1] * sums[1] / n) / (n * (n - 1.0));
  return {static_cast<float>(sums[0] / n), static_cast<float>(sums[1] / n),
          static_cast<float>(sums[2] / n),
          static_cast<float>(std::sqrt(std::max(0.0, variance_of_mean))), samples};
}

}  // namespace

void write_exr(const std::filesystem::path& path, std::uint32_t width, std::uint32_t height,
               std::span<const double> sums, std::uint32_t samples,
               const ImageProvenance& provenance) {
  std::vector<Pixel> pixels(static_cast<std::size_t>(width) * height);
  for (std::size_t i = 0; i < pixels.size(); ++i) {
    pixels[i] = pixel_from_sums(&sums[4 * i], samples);
  }

  Imf::Header header(static_cast<int>(width), static_cast<int>(height));
  header.compression() = Imf::ZIP_COMPRESSION;
  // Channels X, Y, Z are CIE XYZ itself; a luminance of 1 is 1 cd/m2.
  Imf::addChromaticities(header, {{1, 0}, {0, 1}, {0, 0}, {1.0f / 3, 1.0f / 3}});
  Imf::addWhiteLuminance(header, 1.0f);
  header.insert("nocturne:scene", Imf::StringAttribute(provenance.scene_sha256));
  header.insert("nocturne:plan", Imf::StringAttribute(provenance.plan));
  header.insert("nocturne:engine", Imf::IntAttribute(static_cast<int>(provenance.engine)));

  Imf::FrameBuffer buffer;
  const auto add = [&](const char* name, Imf::PixelType type, std::size_t offset) {
    header.channels().insert(name, Imf::Channel(type));
    buffer.insert(name, Imf::Slice(type, reinterpret_cast<char*>(pixels.data()) + offset,
                                   sizeof(Pixel), sizeof(Pixel) * width));
  };
  add("X", Imf::FLOAT, offsetof(Pixel, x));
  add("Y", Imf::FLOAT, offsetof(Pixel, y));
  add("Z", Imf::FLOAT, offsetof(Pixel, z));
  add("Y.stderr", Imf::FLOAT, offsetof(Pixel, y_stderr));
  add("n", Imf::UINT, offsetof(Pixel, n));

  Imf::OutputFile file(path.c_str(), header);
  file.setFrameBuffer(buffer);
  file.writePixels(static_cast<int>(height));
}

}  // namespace nocturne
