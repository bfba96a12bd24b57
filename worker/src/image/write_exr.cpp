// Long: all that an image holds of its errors, in the order in which it is written.
#include "image/write_exr.h"

#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfIntAttribute.h>
#include <ImfOutputFile.h>
#include <ImfStandardAttributes.h>
#include <ImfStringAttribute.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "spectrum/srgb.h"

namespace nocturne {
namespace {

// Estimated variance of the mean of n numbers, or covariance of two means, from sums; 0 below two.
double covariance_of_means(double products, double a, double b, double n) {
  return n < 2.0 ? 0.0 : (products - a * b / n) / (n * (n - 1.0));
}

double variance_of_mean(double squares, double sum, double n) {
  return std::max(0.0, covariance_of_means(squares, sum, sum, n));
}

// Of two variances, where the second is known to be above 0.
double ratio(double variance, double independent) {
  return independent > 0.0 ? variance / independent : 1.0;
}

// Places of a pixel's sums; see TileSums.
enum Sum : std::uint8_t { kX, kY, kZ, kYY, kXX, kZZ, kXY, kXZ, kYZ };
// Those of the squares of X, Y, Z, and what the products from kXY on are of.
constexpr std::array<std::size_t, 3> kSquares{kXX, kYY, kZZ};
constexpr std::array<std::array<std::size_t, 2>, 3> kPairs{{{kX, kY}, {kX, kZ}, {kY, kZ}}};

// Of two errors with this product; 0 where there is none.
double correlation(double covariance, double errors) {
  return errors > 0.0 ? std::clamp(covariance / errors, -1.0, 1.0) : 0.0;
}

// Of each value, the place of the one that counts the same light whatever its polarisation; as
// nocturne_scene/responses.py has it.
std::vector<std::size_t> light_of(std::span<const std::string> names) {
  constexpr std::array<std::string_view, 6> kPolarised{"S1",         "S2",          "S3",
                                                       "polariser0", "polariser22", "polariser45"};
  std::vector<std::size_t> found(names.size());
  for (std::size_t i = 0; i < names.size(); ++i) {
    const std::size_t point = names[i].find('.');
    const std::string layer = names[i].substr(0, point);
    found[i] = i;
    if (point == std::string::npos || std::ranges::count(kPolarised, layer) == 0) continue;
    const std::string channel = names[i].substr(point + 1);
    for (const std::string& name : {channel, "S0." + channel}) {
      const auto at = std::ranges::find(names, name);
      if (at != names.end()) found[i] = static_cast<std::size_t>(at - names.begin());
    }
  }
  return found;
}

// The channels of floats of an image, side by side for each pixel.
class Channels {
 public:
  Channels(const TileSums& film, std::span<const std::string> further_responses,
           std::uint32_t samples)
      : film_(film), samples_(samples) {
    names_ = {"X", "Y", "Z"};
    names_.insert(names_.end(), further_responses.begin(), further_responses.end());
    light_ = light_of(names_);
    const std::size_t values = names_.size();
    for (std::size_t i = 0; i < values; ++i) names_.push_back(names_[i] + ".stderr");
    for (const char* name : {"XY.correlation", "XZ.correlation", "YZ.correlation", "X.ownRatio",
                             "Y.ownRatio", "Z.ownRatio", "X.blockRatio", "Y.blockRatio",
                             "Z.blockRatio", "X.tileRatio", "Y.tileRatio", "Z.tileRatio",
                             "XY.blockCorrelation", "XZ.blockCorrelation", "YZ.blockCorrelation"}) {
      names_.emplace_back(name);
    }
    values_.resize(names_.size() * film.width * film.height);
    for (std::uint32_t y = 0; y < film.height; y += TileSums::kBlock) {
      for (std::uint32_t x = 0; x < film.width; x += TileSums::kBlock) find_one_more(x, y);
    }
    for (std::uint32_t y = 0; y < film.height; ++y) {
      for (std::uint32_t x = 0; x < film.width; ++x) put_pixel(x, y);
    }
  }

  const std::vector<std::string>& names() const { return names_; }
  std::vector<float>& values() { return values_; }

  void put_ratios(std::uint32_t tile_size) {
    std::size_t index = 0;
    for (std::uint32_t y = 0; y < film_.height; y += tile_size) {
      for (std::uint32_t x = 0; x < film_.width; x += tile_size) {
        put_ratios_of_tile(&film_.tile_products[film_.products_of_tile() * index++], x, y,
                           std::min(tile_size, film_.width - x),
                           std::min(tile_size, film_.height - y));
      }
    }
  }

 private:
  const double* sums(std::uint32_t x, std::uint32_t y) const {
    return &film_.sums[film_.channels * (std::size_t{y} * film_.width + x)];
  }
  float* channels(std::uint32_t x, std::uint32_t y) {
    return &values_[names_.size() * (std::size_t{y} * film_.width + x)];
  }
  std::size_t quantities() const { return 3 + film_.further; }
  // Of X, Y, Z, then further responses.
  std::size_t sum_of(std::size_t i) const { return i < 3 ? i : TileSums::kXyzSums + i - 3; }
  std::size_t squares_of(std::size_t i) const {
    return i < 3 ? kSquares[i] : TileSums::kXyzSums + film_.further + i - 3;
  }
  double variance(const double* pixel, std::size_t i) const {
    return variance_of_mean(pixel[squares_of(i)], pixel[sum_of(i)], samples_);
  }
  // As nocturne_scene/pixel_errors.py has it, with the reason, and in the same order.
  double finds(double found, double variance, double squares) const {
    const double n = std::max(2.0, samples_), second = (n - 1.0) * variance + squares;
    return second > 0.0 ? std::max(1.0, n * (found * found) / second) : 1.0;
  }
  double one_more(std::uint32_t x, std::uint32_t y, std::size_t i) const {
    const std::size_t block =
        std::size_t{y / TileSums::kBlock} * film_.block_columns() + x / TileSums::kBlock;
    const std::size_t lit = light_[i];
    const double mean = sums(x, y)[sum_of(lit)] / samples_;
    return one_more_[quantities() * block + i] /
           finds(mean, variance(sums(x, y), lit), mean * mean);
  }

  void find_one_more(std::uint32_t left, std::uint32_t top) {
    const std::uint32_t right = std::min(left + TileSums::kBlock, film_.width);
    const std::uint32_t bottom = std::min(top + TileSums::kBlock, film_.height);
    std::vector<double> of_blocks, finds_of_block;
    for (std::size_t i = 0; i < quantities(); ++i) {
      double of_block = 0.0, found = 0.0, squares = 0.0;
      for_each_pixel(left, top, right, bottom, [&](std::uint32_t x, std::uint32_t y) {
        const double mean = sums(x, y)[sum_of(i)] / samples_;
        of_block += variance(sums(x, y), i);
        found += std::fabs(mean);
        squares += mean * mean;
      });
      of_blocks.push_back(of_block);
      finds_of_block.push_back(finds(found, of_block, squares));
    }
    for (std::size_t i = 0; i < quantities(); ++i) {
      one_more_.push_back(of_blocks[i] / finds_of_block[light_[i]]);
    }
  }

  void put_pixel(std::uint32_t x, std::uint32_t y) {
    const double* const of_pixel = sums(x, y);
    float* to = channels(x, y);
    const auto put = [&to](double value) { *to++ = static_cast<float>(value); };
    for (std::size_t i = 0; i < quantities(); ++i) put(of_pixel[sum_of(i)] / samples_);
    std::array<double, 3> errors{}, own_ratios{};
    for (std::size_t i = 0; i < quantities(); ++i) {
      const double own = variance(of_pixel, i), told = own + one_more(x, y, i);
      put(std::sqrt(told));
      if (i < 3) {
        errors[i] = std::sqrt(own);
        own_ratios[i] = ratio(own, told);
      }
    }
    for (std::size_t i = 0; i < 3; ++i) {
      const auto [a, b] = kPairs[i];
      const double found =
          covariance_of_means(of_pixel[kXY + i], of_pixel[a], of_pixel[b], samples_);
      put(correlation(found, errors[a] * errors[b]));
    }
    for (const double own_ratio : own_ratios) put(own_ratio);
  }

  // Joint X, Y, Z of some pixels: sums, their products, and variances of pixels alone.
  struct Together {
    std::array<double, 3> sums{}, variances{};
  };

  void add(const double* pixel, Together& to) const {
    for (std::size_t i = 0; i < 3; ++i) {
      to.sums[i] += pixel[i];
      to.variances[i] += variance(pixel, i);
    }
  }

  /// Of the means of X, Y, Z from sums and TileSums::kProducts.
  std::array<double, 3> variances(const Together& of, const double* products) const {
    std::array<double, 3> found{};
    for (std::size_t i = 0; i < 3; ++i) {
      found[i] = variance_of_mean(products[kSquares[i] - kYY], of.sums[i], samples_);
    }
    return found;
  }

  void put_ratios_of_tile(const double* tile_products, std::uint32_t left, std::uint32_t top,
                          std::uint32_t width, std::uint32_t height) {
    constexpr std::uint32_t kBlock = TileSums::kBlock;
    const std::size_t first = names_.size() - 9;
    Together blocks;
    for (std::uint32_t y = top; y < top + height; y += kBlock) {
      for (std::uint32_t x = left; x < left + width; x += kBlock) {
        const std::uint32_t right = std::min(x + kBlock, left + width);
        const std::uint32_t bottom = std::min(y + kBlock, top + height);
        Together pixels;
        for_each_pixel(x, y, right, bottom,
                       [&](std::uint32_t px, std::uint32_t py) { add(sums(px, py), pixels); });
        const double* const products =
            &film_.block_products[TileSums::kProducts *
                                  (std::size_t{y / kBlock} * film_.block_columns() + x / kBlock)];
        const auto of_block = variances(pixels, products);
        std::array<float, 3> ratios{}, correlations{};
        for (std::size_t i = 0; i < 3; ++i) {
          blocks.sums[i] += pixels.sums[i];
          blocks.variances[i] += of_block[i];
          ratios[i] = static_cast<float>(ratio(of_block[i], pixels.variances[i]));
          const auto [a, b] = kPairs[i];
          const double found = covariance_of_means(products[kXY - kYY + i], pixels.sums[a],
                                                   pixels.sums[b], samples_);
          correlations[i] = static_cast<float>(
              correlation(found, std::sqrt(of_block[a]) * std::sqrt(of_block[b])));
        }
        for_each_pixel(x, y, right, bottom, [&](std::uint32_t px, std::uint32_t py) {
          std::ranges::copy(ratios, channels(px, py) + first);
          std::ranges::copy(correlations, channels(px, py) + first + 6);
        });
      }
    }
    const auto of_tile = variances(blocks, tile_products);
    std::array<float, 3> ratios{};
    for (std::size_t i = 0; i < 3; ++i) {
      ratios[i] = static_cast<float>(ratio(of_tile[i], blocks.variances[i]));
    }
    for_each_pixel(left, top, left + width, top + height, [&](std::uint32_t x, std::uint32_t y) {
      std::ranges::copy(ratios, channels(x, y) + first + 3);
    });
  }

  template <class Visit>
  static void for_each_pixel(std::uint32_t left, std::uint32_t top, std::uint32_t right,
                             std::uint32_t bottom, const Visit& visit) {
    for (std::uint32_t y = top; y < bottom; ++y) {
      for (std::uint32_t x = left; x < right; ++x) visit(x, y);
    }
  }

  const TileSums& film_;
  const double samples_;
  std::vector<std::string> names_;
  std::vector<float> values_;
  // By block and quantity.
  std::vector<double> one_more_;
  std::vector<std::size_t> light_;
};

// As nocturne_scene/response_correlations.py has it: of each tile the correlations of the errors of
// the means of X, Y, Z and further responses over its pixels, the second with the first, the third
// with both, and so on, as float32, little endian.
constexpr std::size_t kMostCorrelations = std::size_t{1} << 22;

std::vector<double> values_of_tiles(const TileSums& film, std::uint32_t tile_size) {
  const std::uint32_t columns = (film.width + tile_size - 1) / tile_size;
  const std::size_t values = film.values();
  std::vector<double> tiles(film.tile_products.size() / film.products_of_tile() * values);
  for (std::uint32_t y = 0; y < film.height; ++y) {
    for (std::uint32_t x = 0; x < film.width; ++x) {
      const double* const pixel = &film.sums[film.channels * (std::size_t{y} * film.width + x)];
      double* const tile = &tiles[values * (y / tile_size * columns + x / tile_size)];
      for (std::size_t i = 0; i < values; ++i) {
        tile[i] += pixel[i < 3 ? i : TileSums::kXyzSums + i - 3];
      }
    }
  }
  return tiles;
}

// Where in a tile's products that of two values is, the second not behind the first.
std::size_t place_of_product(std::size_t a, std::size_t b) {
  if (a < 3) {
    return a == b ? kSquares[a] - kYY : kXY - kYY + a + b - 1;
  }
  return TileSums::kProducts + (a * (a + 1) - 12) / 2 + b;
}

std::string correlations_of_tiles(const TileSums& film, std::uint32_t tile_size, double samples) {
  const std::vector<double> sums = values_of_tiles(film, tile_size);
  const std::size_t values = film.values(), tiles = sums.size() / values;
  if (film.further == 0 || tiles * values * (values - 1) / 2 > kMostCorrelations) return {};
  std::string bytes;
  for (std::size_t tile = 0; tile < tiles; ++tile) {
    const double* const of = &sums[tile * values];
    const double* const products = &film.tile_products[tile * film.products_of_tile()];
    const auto found = [&](std::size_t a, std::size_t b) {
      return covariance_of_means(products[place_of_product(a, b)], of[a], of[b], samples);
    };
    std::vector<double> errors;
    for (std::size_t a = 0; a < values; ++a)
      errors.push_back(std::sqrt(std::max(0.0, found(a, a))));
    for (std::size_t a = 1; a < values; ++a) {
      for (std::size_t b = 0; b < a; ++b) {
        const auto value = static_cast<float>(correlation(found(a, b), errors[a] * errors[b]));
        const auto bits = std::bit_cast<std::uint32_t>(value);
        for (unsigned byte = 0; byte < 4; ++byte) {
          bytes.push_back(static_cast<char>(bits >> (8u * byte)));
        }
      }
    }
  }
  return bytes;
}

// RFC 4648.
std::string base64(const std::string& bytes) {
  static constexpr char kDigits[] =
      "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    std::uint32_t three = 0;
    for (std::size_t k = 0; k < 3; ++k) {
      three = three << 8 | (i + k < bytes.size() ? static_cast<unsigned char>(bytes[i + k]) : 0u);
    }
    for (std::size_t k = 0; k < 4; ++k) {
      text.push_back(i + k > bytes.size() ? '=' : kDigits[three >> (18 - 6 * k) & 63u]);
    }
  }
  return text;
}

// The primaries and the white of sRGB, IEC 61966-2-1.
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

// As nocturne_scene/bands.py has it: Fichet, Pacanowski, Wilkie, "An OpenEXR Layout for Spectral
// Images" (JCGT 10(3), 2021).
void tell_bands(std::span<const std::string> names, std::string unit, Imf::Header& header) {
  if (std::ranges::none_of(names, [](const auto& name) { return name.starts_with("S0."); })) return;
  for (std::size_t i = 0; i < unit.size(); ++i) {
    if (unit[i] == ' ') unit[i] = '.';
    if (unit[i] == '-') unit.insert(i++, 1, '^');
  }
  header.insert("spectralLayoutVersion", Imf::StringAttribute("1.0"));
  header.insert("emissiveUnits", Imf::StringAttribute(unit));
}

}  // namespace

void write_exr(const std::filesystem::path& path, const TileSums& film, std::uint32_t tile_size,
               std::span<const std::string> further_responses, std::uint32_t samples,
               const ImageProvenance& provenance) {
  if (further_responses.size() != film.further) {
    throw std::invalid_argument("an image's sums don't fit its channels");
  }
  const std::uint32_t width = film.width, height = film.height;
  Channels image(film, further_responses, samples);
  image.put_ratios(tile_size);
  const std::size_t channels = image.names().size();
  std::vector<std::uint32_t> counts(std::size_t{width} * height, samples);

  Imf::Header header(static_cast<int>(width), static_cast<int>(height));
  header.compression() = Imf::ZIP_COMPRESSION;
  // Of R, G, B; X, Y, Z are CIE XYZ itself.
  Imf::addChromaticities(header, kSrgb);
  // OpenEXR's own: a luminance of 1 is 1 cd/m2.
  if (provenance.quantity == "luminance") Imf::addWhiteLuminance(header, 1.0f);
  header.insert("nocturne:quantity", Imf::StringAttribute(provenance.quantity));
  header.insert("nocturne:unit", Imf::StringAttribute(provenance.unit));
  header.insert("nocturne:responseUnit", Imf::StringAttribute(provenance.response_unit));
  header.insert("nocturne:wavelengths", Imf::StringAttribute(provenance.wavelengths));
  header.insert("nocturne:scene", Imf::StringAttribute(provenance.scene_sha256));
  header.insert("nocturne:schedule", Imf::StringAttribute(provenance.plan));
  header.insert("nocturne:engine", Imf::IntAttribute(static_cast<int>(provenance.engine)));
  header.insert("nocturne:floatingPointProfile",
                Imf::StringAttribute(provenance.floating_point_profile));
  if (!provenance.way.empty()) {
    header.insert("nocturne:way", Imf::StringAttribute(provenance.way));
  }
  if (!provenance.warnings.empty()) {
    header.insert("nocturne:warnings", Imf::StringAttribute(provenance.warnings));
  }
  if (!provenance.unmet_parts.empty()) {
    header.insert("nocturne:unmetParts", Imf::StringAttribute(provenance.unmet_parts));
  }
  if (!provenance.instruments.empty()) {
    header.insert("nocturne:instruments", Imf::StringAttribute(provenance.instruments));
  }
  if (const std::string bytes = correlations_of_tiles(film, tile_size, samples); !bytes.empty()) {
    header.insert("nocturne:correlations", Imf::StringAttribute(base64(bytes)));
  }
  if (provenance.truncated_paths > 0) {
    header.insert("nocturne:truncatedPaths",
                  Imf::StringAttribute(std::to_string(provenance.truncated_paths)));
  }

  tell_bands(further_responses, provenance.response_unit, header);
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
    add(image.names()[i], Imf::FLOAT, &image.values()[i], channels * sizeof(float));
  }
  add("n", Imf::UINT, counts.data(), sizeof(std::uint32_t));
  // A sensor may have responses with these names: they say more than what only viewers need.
  std::vector<float> rgb;
  if (std::ranges::find_first_of(further_responses, kRgb) == further_responses.end()) {
    rgb = rgb_of(image.values(), channels);
    for (std::size_t i = 0; i < 3; ++i) add(kRgb[i], Imf::FLOAT, &rgb[i], 3 * sizeof(float));
  }

  Imf::OutputFile file(path.c_str(), header);
  file.setFrameBuffer(buffer);
  file.writePixels(static_cast<int>(height));
}

}  // namespace nocturne
