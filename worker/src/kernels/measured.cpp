#include "kernels/measured.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <numbers>
#include <stdexcept>
#include <string>

#include "math/functions.h"

namespace nocturne {
namespace {

constexpr std::uint32_t kVersion = 1;
// 256 MB of values: 46 planes of the size of Matusik's.
constexpr std::uint64_t kMaxValues = 64u << 20;
constexpr std::uint32_t kMaxAlong = 4096;
constexpr double kHalfPi = 0.5 * std::numbers::pi;
constexpr std::size_t kAlbedoCosines = 9;

[[noreturn]] void refuse(const std::string& what) {
  throw std::invalid_argument("measured BRDF: " + what);
}

// Little endian, as is every machine of x86-64.
class Reader {
 public:
  explicit Reader(std::span<const std::byte> bytes) : bytes_(bytes) {}

  template <class T>
  T next() {
    T value;
    copy(&value, sizeof value);
    return value;
  }
  std::vector<float> floats(std::size_t count, const char* what) {
    std::vector<float> values(count);
    copy(values.data(), count * sizeof(float));
    for (const float value : values) {
      if (!(std::isfinite(value) && value >= 0.0f)) {
        refuse(std::string("a negative or infinite ") + what);
      }
    }
    return values;
  }
  std::size_t left() const { return bytes_.size(); }

 private:
  void copy(void* to, std::size_t size) {
    if (size > bytes_.size()) refuse("too short");
    if (size == 0) return;
    std::memcpy(to, bytes_.data(), size);
    bytes_ = bytes_.subspan(size);
  }

  std::span<const std::byte> bytes_;
};

double theta_h(std::uint32_t node, std::uint32_t nodes) {
  const double x = static_cast<double>(node) / static_cast<double>(nodes);
  return kHalfPi * x * x;
}

struct Cell {
  std::uint32_t low, high;
  float t;
};

// Node i stands at i; beyond the last one its value holds.
Cell held(float position, std::uint32_t nodes) {
  const float clamped = std::clamp(position, 0.0f, static_cast<float>(nodes - 1));
  const auto low = static_cast<std::uint32_t>(clamped);
  return {low, std::min(low + 1, nodes - 1), clamped - static_cast<float>(low)};
}

Cell around(float position, std::uint32_t nodes) {
  const float clamped = std::max(0.0f, position);
  const auto low = static_cast<std::uint32_t>(clamped);
  return {low % nodes, (low + 1) % nodes, clamped - static_cast<float>(low)};
}

}  // namespace

MeasuredTable::MeasuredTable(std::span<const std::byte> blob) {
  constexpr char kMagic[] = "NOCTBRDF";
  Reader reader(blob);
  const auto magic = reader.next<std::array<char, 8>>();
  if (std::memcmp(magic.data(), kMagic, magic.size()) != 0) refuse("not such a file");
  const auto version = reader.next<std::uint32_t>();
  if (version != kVersion) refuse("version " + std::to_string(version) + " is not known");
  n_theta_h_ = reader.next<std::uint32_t>();
  n_theta_d_ = reader.next<std::uint32_t>();
  n_phi_d_ = reader.next<std::uint32_t>();
  n_planes_ = reader.next<std::uint32_t>();
  const auto n_basis = reader.next<std::uint32_t>();
  first_nm_ = reader.next<float>();
  const auto step_nm = reader.next<float>();
  for (const std::uint32_t n : {n_theta_h_, n_theta_d_, n_phi_d_, n_planes_}) {
    if (n == 0 || n > kMaxAlong) refuse("a size of 0 or above " + std::to_string(kMaxAlong));
  }
  if (!std::isfinite(first_nm_) || !std::isfinite(step_nm) || !(step_nm > 0.0f)) {
    refuse("a wavelength grid without a positive step");
  }
  if (n_basis != 0 && (n_planes_ != 3 || n_basis < 2 || n_basis > kMaxAlong)) {
    refuse("basis spectra that are not three, or too short or long");
  }
  // Each factor is at most 2^12, so the product of three fits, and then the fourth.
  const std::uint64_t plane = std::uint64_t{n_theta_h_} * n_theta_d_ * n_phi_d_;
  if (plane > kMaxValues || plane * n_planes_ > kMaxValues) refuse("too many values");
  if (reader.left() != (plane * n_planes_ + std::uint64_t{n_basis} * 3) * sizeof(float)) {
    refuse("not as long as its sizes say");
  }
  inverse_step_ = 1.0f / step_nm;
  plane_size_ = static_cast<std::size_t>(plane);
  basis_ = reader.floats(std::size_t{n_basis} * 3, "basis weight");
  for (std::size_t i = 0; i < n_basis; ++i) {
    const float total = basis_[3 * i] + basis_[3 * i + 1] + basis_[3 * i + 2];
    if (!(std::fabs(total - 1.0f) < 1e-4f)) refuse("basis weights that don't add up to 1");
  }
  values_ = reader.floats(plane_size_ * n_planes_, "value");
  read_marginal();
  read_albedo();
}

MeasuredTable::Planes MeasuredTable::planes(float wavelength_nm) const {
  const float position = (wavelength_nm - first_nm_) * inverse_step_;
  if (basis_.empty()) {
    const Cell c = held(position, n_planes_);
    return {{c.low, c.high, c.high}, {1.0f - c.t, c.t, 0.0f}};
  }
  const Cell c = held(position, static_cast<std::uint32_t>(basis_.size() / 3));
  Planes r{{0, 1, 2}, {}};
  for (std::size_t p = 0; p < 3; ++p) {
    r.weight[p] = (1.0f - c.t) * basis_[3 * std::size_t{c.low} + p] +
                  c.t * basis_[3 * std::size_t{c.high} + p];
  }
  return r;
}

MeasuredTable::Nodes MeasuredTable::nodes(Vec3 wo, Vec3 wi) const {
  const Vec3 h = half_vector(wo, wi);
  const float across = std::sqrt(h.x * h.x + h.y * h.y);
  const float cos_phi = across > 0.0f ? h.x / across : 1.0f;
  const float sin_phi = across > 0.0f ? h.y / across : 0.0f;
  // wi in the frame of h.
  const float x = (wi.x * cos_phi + wi.y * sin_phi) * h.z - wi.z * across;
  const float y = wi.y * cos_phi - wi.x * sin_phi;
  const float z = dot(wi, h);
  constexpr auto kHalf = static_cast<float>(kHalfPi);
  float phi_d = math::atan2(y, x);
  if (phi_d < 0.0f) phi_d += kPi;  // the other half by reciprocity
  const float position_h =
      std::sqrt(math::atan2(across, h.z) / kHalf) * static_cast<float>(n_theta_h_);
  const float position_d =
      math::atan2(std::sqrt(x * x + y * y), z) / kHalf * static_cast<float>(n_theta_d_);
  const Cell a = held(position_h, n_theta_h_), b = held(position_d, n_theta_d_);
  const Cell c = around(phi_d / kPi * static_cast<float>(n_phi_d_), n_phi_d_);
  Nodes r;
  for (std::uint32_t corner = 0; corner < 8; ++corner) {
    const bool high_a = (corner & 1u) != 0, high_b = (corner & 2u) != 0,
               high_c = (corner & 4u) != 0;
    r.index[corner] =
        ((high_a ? a.high : a.low) * n_theta_d_ + (high_b ? b.high : b.low)) * n_phi_d_ +
        (high_c ? c.high : c.low);
    r.weight[corner] =
        (high_a ? a.t : 1.0f - a.t) * (high_b ? b.t : 1.0f - b.t) * (high_c ? c.t : 1.0f - c.t);
  }
  return r;
}

float MeasuredTable::brdf(const Nodes& nodes, const Planes& planes) const {
  float sum = 0.0f;
  for (std::size_t p = 0; p < 3; ++p) {
    if (planes.weight[p] == 0.0f) continue;
    const float* plane = &values_[planes.plane[p] * plane_size_];
    float value = 0.0f;
    for (std::size_t i = 0; i < 8; ++i) value += nodes.weight[i] * plane[nodes.index[i]];
    sum += planes.weight[p] * value;
  }
  return sum;
}

double MeasuredTable::share_within(double slope) const {
  // Light along the normal is turned by twice the half vector's angle, so that all of them is met
  // below 45 degrees: the mean over planes, with an even step in the angle.
  constexpr int kSteps = 512;
  double within = 0.0, all = 0.0;
  for (int i = 0; i < kSteps; ++i) {
    const double theta_h = 0.5 * kHalfPi * (i + 0.5) / kSteps, theta_i = 2.0 * theta_h;
    const auto sine = static_cast<float>(math::sin(theta_i));
    const auto cosine = static_cast<float>(math::cos(theta_i));
    const Nodes at = nodes({0.0f, 0.0f, 1.0f}, {sine, 0.0f, cosine});
    double value = 0.0;
    for (std::uint32_t plane = 0; plane < n_planes_; ++plane) {
      value += static_cast<double>(brdf(at, {{plane, plane, plane}, {1.0f, 0.0f, 0.0f}}));
    }
    value *= static_cast<double>(sine) * static_cast<double>(cosine);
    all += value;
    if (math::sin(theta_h) <= slope * math::cos(theta_h)) within += value;
  }
  return all > 0.0 ? within / all : 0.0;
}

void MeasuredTable::read_marginal() {
  // Mean over planes and difference angles at every node of theta_h, weighted as those angles are
  // met under even light.
  std::vector<double> mean(n_theta_h_, 0.0);
  for (std::size_t p = 0; p < n_planes_; ++p) {
    for (std::size_t i = 0; i < n_theta_h_; ++i) {
      for (std::size_t j = 0; j < n_theta_d_; ++j) {
        const double theta_d = kHalfPi * (static_cast<double>(j) + 0.5) / n_theta_d_;
        const float* row = &values_[p * plane_size_ + (i * n_theta_d_ + j) * n_phi_d_];
        double sum = 0.0;
        for (std::size_t k = 0; k < n_phi_d_; ++k) sum += static_cast<double>(row[k]);
        mean[i] += sum * math::sin(theta_d) * math::cos(theta_d);
      }
    }
  }
  double total = 0.0;
  std::vector<double> mass(n_theta_h_), cosine_drop(n_theta_h_);
  edge_.push_back(0.0f);
  for (std::uint32_t i = 0; i < n_theta_h_; ++i) {
    const double low = theta_h(i, n_theta_h_), high = theta_h(i + 1, n_theta_h_);
    // cos low - cos high, without cancellation
    cosine_drop[i] = 2.0 * math::sin(0.5 * (high - low)) * math::sin(0.5 * (high + low));
    const double projected = 0.5 * math::sin(high - low) * math::sin(high + low);
    const double value = 0.5 * (mean[i] + mean[std::min(i + 1, n_theta_h_ - 1)]);
    mass[i] = value * projected;
    total += mass[i];
    edge_.push_back(static_cast<float>(2.0 * math::sin(0.5 * high) * math::sin(0.5 * high)));
  }
  double sum = 0.0;
  for (std::uint32_t i = 0; i < n_theta_h_; ++i) {
    // A black table is drawn evenly.
    const double share = total > 0.0 ? mass[i] / total : cosine_drop[i];
    sum += share;
    cumulative_.push_back(static_cast<float>(sum));
    density_.push_back(static_cast<float>(share / (2.0 * std::numbers::pi * cosine_drop[i])));
  }
  cumulative_.back() = 1.0f;
}

Vec3 MeasuredTable::sample_half(float u, float v) const {
  const auto found = std::upper_bound(cumulative_.begin(), cumulative_.end() - 1, u);
  const auto i = static_cast<std::size_t>(found - cumulative_.begin());
  const float low = i > 0 ? cumulative_[i - 1] : 0.0f, width = cumulative_[i] - low;
  const float t = width > 0.0f ? std::clamp((u - low) / width, 0.0f, 1.0f) : 0.5f;
  const float less = edge_[i] + t * (edge_[i + 1] - edge_[i]);  // 1 - cos
  const float r = std::sqrt(std::max(0.0f, less * (2.0f - less)));
  return {r * math::cos(kTwoPi * v), r * math::sin(kTwoPi * v), 1.0f - less};
}

float MeasuredTable::half_pdf(Vec3 h) const {
  const float theta = math::atan2(std::sqrt(h.x * h.x + h.y * h.y), h.z);
  const float position =
      std::sqrt(theta / static_cast<float>(kHalfPi)) * static_cast<float>(n_theta_h_);
  return density_[std::min(static_cast<std::uint32_t>(position), n_theta_h_ - 1)];
}

void MeasuredTable::read_albedo() {
  // By the same mixture that sample draws from, 2 x 16 x 16 points for each cosine.
  constexpr int kPoints = 16;
  albedo_.assign(std::size_t{n_planes_} * kAlbedoCosines, 0.0f);
  for (std::size_t c = 0; c < kAlbedoCosines; ++c) {
    const float cosine =
        std::max(0.02f, static_cast<float>(c) / static_cast<float>(kAlbedoCosines - 1));
    const Vec3 wo{std::sqrt(1.0f - cosine * cosine), 0.0f, cosine};
    for (int point = 0; point < 2 * kPoints * kPoints; ++point) {
      const int cell = point / 2;
      const float u = (static_cast<float>(cell % kPoints) + 0.5f) / kPoints;
      const float v = (static_cast<float>(cell / kPoints) + 0.5f) / kPoints;
      const Vec3 wi = point % 2 == 0 ? CosineHemisphere::sample(u, v)
                                     : normalized(reflected(wo, sample_half(u, v)));
      const Vec3 h = half_vector(wo, wi);
      const float facing = dot(wo, h);
      if (wi.z <= 0.0f || facing <= 0.0f) continue;
      const float pdf = 0.5f * (half_pdf(h) / (4.0f * facing) + CosineHemisphere::pdf(wi));
      const Nodes around_it = nodes(wo, wi);
      const float weight = wi.z / pdf / (2.0f * kPoints * kPoints);
      for (std::uint32_t p = 0; p < n_planes_; ++p) {
        albedo_[p * kAlbedoCosines + c] +=
            weight * brdf(around_it, {{p, p, p}, {1.0f, 0.0f, 0.0f}});
      }
    }
  }
  // The quadrature may miss narrow peaks.
  constexpr float kMin = 1e-3f;
  for (std::size_t p = 0; p < n_planes_; ++p) {
    const auto plane = values_.begin() + static_cast<std::ptrdiff_t>(p * plane_size_);
    const bool black = std::all_of(plane, plane + static_cast<std::ptrdiff_t>(plane_size_),
                                   [](float value) { return value == 0.0f; });
    for (std::size_t c = 0; c < kAlbedoCosines; ++c) {
      float& a = albedo_[p * kAlbedoCosines + c];
      a = black ? 0.0f : std::max(kMin, a);
    }
  }
}

float MeasuredTable::albedo(float cosine, const Planes& planes) const {
  const Cell c = held(cosine * static_cast<float>(kAlbedoCosines - 1), kAlbedoCosines);
  float sum = 0.0f;
  for (std::size_t p = 0; p < 3; ++p) {
    const float* row = &albedo_[planes.plane[p] * kAlbedoCosines];
    sum += planes.weight[p] * ((1.0f - c.t) * row[c.low] + c.t * row[c.high]);
  }
  return std::min(1.0f, sum);
}

}  // namespace nocturne
