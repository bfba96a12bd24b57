#include "scene/load_kernels.h"

#include <algorithm>
#include <memory>
#include <unordered_map>

#include "scene/blob_file.h"
#include "scene/load_special_kernels.h"
#include "scene/load_textures.h"

namespace nocturne {
namespace {

// 64 M numbers, and room for the header before them.
constexpr std::uintmax_t kMaxTableBytes = (256u << 20) + (1u << 20);

class KernelLoader {
 public:
  explicit KernelLoader(const LoadContext& context) : context_(context) {}

  AnyKernel load(const v1::Kernel& message) {
    switch (message.model_case()) {
      case v1::Kernel::kLambertian:
        return Lambertian{colour(message.lambertian().reflectance())};
      case v1::Kernel::kDiffuseTransmitter:
        return DiffuseTransmitter(colour(message.diffuse_transmitter().reflectance()),
                                  colour(message.diffuse_transmitter().transmittance()));
      case v1::Kernel::kConductor:
        return conductor(message.conductor());
      case v1::Kernel::kCoatedConductor: {
        Conductor coated = conductor(message.coated_conductor().conductor());
        coated.film = film(message.coated_conductor().layers());
        return coated;
      }
      case v1::Kernel::kDielectric:
        return Dielectric{roughness(message.dielectric().roughness())};
      case v1::Kernel::kCoatedDielectric:
        return Dielectric{roughness(message.coated_dielectric().dielectric().roughness()),
                          film(message.coated_dielectric().layers())};
      case v1::Kernel::kGlazing:
        return glazing(message.glazing());
      case v1::Kernel::kThinPane:
        return ThinPane(context_.spectrum(message.thin_pane().index()),
                        context_.spectrum(message.thin_pane().transmittance()));
      case v1::Kernel::kCoatedDiffuse:
        return CoatedDiffuse(context_.spectrum(message.coated_diffuse().index()),
                             roughness(message.coated_diffuse().roughness()),
                             colour(message.coated_diffuse().reflectance()));
      case v1::Kernel::kMeasured:
        return Measured{table(message.measured().blob())};
      case v1::Kernel::kPhong: {
        const double exponent = message.phong().exponent();
        require(exponent >= 0.0 && exponent <= 1e6, "a Phong exponent outside [0, 1e6]");
        return Phong{colour(message.phong().reflectance()), static_cast<float>(exponent)};
      }
      case v1::Kernel::kPrincipled:
        return principled(message.principled());
      case v1::Kernel::kNullKernel:
        return NullKernel{};
      case v1::Kernel::kFluorescent:
        return load_fluorescent(context_, message.fluorescent());
      case v1::Kernel::kPolarisingFilter:
        return load_filter(context_, message.polarising_filter());
      case v1::Kernel::kBlend:
        return blend(message.blend());
      case v1::Kernel::MODEL_NOT_SET:
        break;
    }
    refuse("a kernel that this program doesn't know");
  }

 private:
  Colour colour(const v1::Colour& message) const { return load_colour(context_, message, 1.0f); }

  Roughness roughness(const v1::Roughness& message) const {
    return {load_scalar(context_, message.alpha_u(), 0.0, 1.0),
            load_scalar(context_, message.alpha_v(), 0.0, 1.0),
            message.beckmann() ? FacetDistribution::kBeckmann : FacetDistribution::kGgx};
  }

  Conductor conductor(const v1::Conductor& message) const {
    return {context_.spectrum(message.n()), context_.spectrum(message.k()),
            roughness(message.roughness())};
  }

  template <class Layers>
  ThinFilm film(const Layers& layers) const {
    // The phase of a wave in a layer stays where sines are known.
    constexpr double kMaxThickness = 1e5;
    constexpr float kMaxIndex = 100.0f;
    std::vector<ThinFilm::Layer> loaded;
    for (const v1::FilmLayer& layer : layers) {
      const double thickness = layer.thickness_nm();
      require(thickness > 0.0 && thickness <= kMaxThickness, "a film's thickness outside (0, 1e5]");
      const Spectrum &n = context_.spectrum(layer.n()), &k = context_.spectrum(layer.k());
      require(n.most() <= kMaxIndex && k.most() <= kMaxIndex, "a film's index above 100");
      require(n.least() > 0.0f || k.least() > 0.0f, "a film whose index is 0");
      loaded.push_back({n, k, thickness});
    }
    return ThinFilm(std::move(loaded));
  }

  Glazing glazing(const v1::Glazing& message) const {
    constexpr int kMaxPanes = 8;
    require(message.panes_size() >= 1 && message.panes_size() <= kMaxPanes,
            "a glazing of no pane, or of more than 8");
    std::vector<Pane> panes;
    for (const auto& each : message.panes()) panes.push_back(pane(each, message.from_back()));
    if (message.from_back()) std::ranges::reverse(panes);
    return Glazing(std::move(panes));
  }

  Pane pane(const v1::Glazing::Pane& message, bool from_back) const {
    switch (message.kind_case()) {
      case v1::Glazing::Pane::kSheet: {
        const auto& sheet = message.sheet();
        ThinFilm front = film(sheet.front()), back = film(sheet.back());
        if (from_back) std::swap(front, back);
        return SheetPane{context_.spectrum(sheet.index()), context_.spectrum(sheet.transmittance()),
                         std::move(front), std::move(back)};
      }
      case v1::Glazing::Pane::kFilm: {
        const ThinFilm layers = film(message.film().layers());
        return FilmPane{from_back ? layers.reversed() : layers};
      }
      case v1::Glazing::Pane::kMeasured: {
        const auto& measured = message.measured();
        const Spectrum &front = context_.spectrum(measured.front()),
                       &back = context_.spectrum(measured.back());
        return MeasuredPane{from_back ? back : front, from_back ? front : back,
                            context_.spectrum(measured.transmittance())};
      }
      case v1::Glazing::Pane::KIND_NOT_SET:
        break;
    }
    refuse("a pane that this program doesn't know");
  }

  Principled principled(const v1::Principled& message) const {
    const double coat_index = message.coat_index();
    require(coat_index >= 1.0 && coat_index <= 4.0, "a coat's index outside [1, 4]");
    const auto scalar = [&](const v1::Scalar& each) {
      return load_scalar(context_, each, 0.0, 1.0);
    };
    Principled::Extras extras;
    if (message.has_reflectance()) {
      extras.reflectance.emplace(scalar(message.reflectance().amount()), std::nullopt);
      if (message.reflectance().has_normal())
        extras.reflectance->normal = colour(message.reflectance().normal());
    }
    if (message.has_brush())
      extras.brush.emplace(scalar(message.brush().roughness()), scalar(message.brush().rotation()));
    if (message.has_sheen())
      extras.sheen.emplace(colour(message.sheen().colour()), scalar(message.sheen().roughness()));
    return Principled(
        colour(message.base()), scalar(message.metallic()), scalar(message.roughness()),
        context_.spectrum(message.index()),
        {scalar(message.coat()), scalar(message.coat_roughness()), static_cast<float>(coat_index)},
        std::move(extras));
  }

  Blend blend(const v1::Blend& message) const {
    Blend blend;
    for (const auto& part : message.parts()) {
      Blend::Part loaded{part.kernel(), {}};
      for (const auto& factor : part.factors()) {
        loaded.factors.push_back(
            {load_scalar(context_, factor.weight(), 0.0, 1.0), factor.complement()});
      }
      blend.parts.push_back(std::move(loaded));
    }
    return blend;
  }

  std::shared_ptr<const MeasuredTable> table(const std::string& sha256) {
    auto& table = tables_[sha256];
    if (table) return table;
    BlobFile file(context_.find_blob, sha256, "a measured table");
    require(file.size() <= kMaxTableBytes, "a measured table that is too large");
    table = std::make_shared<const MeasuredTable>(file.read<std::byte>(file.size()));
    return table;
  }

  const LoadContext& context_;
  std::unordered_map<std::string, std::shared_ptr<const MeasuredTable>> tables_;
};

bool varies(const v1::Colour& colour) { return colour.has_texture(); }
bool varies(const v1::Scalar& scalar) { return scalar.has_texture(); }
bool anisotropic(const v1::Roughness& roughness) {
  return varies(roughness.alpha_u()) || varies(roughness.alpha_v()) ||
         roughness.alpha_u().constant() != roughness.alpha_v().constant();
}

// Of which kernels light that they send on stays together. As a whole: both ends of a path must say
// the same of a point, whatever part of a texture they look up there.
class SpecularLike {
 public:
  SpecularLike(const v1::CompiledScene& message, const std::vector<AnyKernel>& kernels)
      : message_(message), kernels_(kernels) {}

  bool operator()(std::size_t index) const {
    const v1::Kernel& kernel = message_.kernels(static_cast<int>(index));
    switch (kernel.model_case()) {
      case v1::Kernel::kConductor:
        return narrow(kernel.conductor().roughness());
      case v1::Kernel::kCoatedConductor:
        return narrow(kernel.coated_conductor().conductor().roughness());
      case v1::Kernel::kCoatedDielectric:
        return narrow(kernel.coated_dielectric().dielectric().roughness());
      case v1::Kernel::kDielectric:
        return narrow(kernel.dielectric().roughness());
      case v1::Kernel::kMeasured:
        return std::get<Measured>(kernels_[index]).table->share_within(kMaxAlpha) >= 0.5;
      case v1::Kernel::kPhong:
        return kernel.phong().exponent() >= kMinExponent;
      case v1::Kernel::kPrincipled:
        return narrow(kernel.principled());
      case v1::Kernel::kBlend:
        return std::ranges::all_of(kernel.blend().parts(), [&](const v1::Blend::Part& part) {
          return (*this)(part.kernel());
        });
      default:
        return false;
    }
  }

 private:
  // Half of what a microfacet's lobe mirrors along its normal is turned by facets whose slope is
  // its alpha at most.
  static constexpr double kMaxAlpha = 0.3;
  // As narrow as a microfacet's lobe at the same limit: n = 2 / alpha^2 - 2.
  static constexpr double kMinExponent = 20.0;

  bool narrow(const v1::Roughness& roughness) const {
    return std::max(least(roughness.alpha_u()), least(roughness.alpha_v())) <= kMaxAlpha;
  }
  // Metal alone, without fuzz: a dielectric has its diffuse base.
  bool narrow(const v1::Principled& kernel) const {
    constexpr double kMaxRoughness = 0.5;  // alpha 0.25
    return !varies(kernel.metallic()) && kernel.metallic().constant() >= 1.0 &&
           least(kernel.roughness()) <= kMaxRoughness &&
           least(kernel.brush().roughness()) <= kMaxRoughness && !kernel.has_sheen();
  }
  // Of a number that varies the smallest that it may be.
  double least(const v1::Scalar& scalar) const {
    if (!varies(scalar)) return scalar.constant();
    const v1::TextureUse& use = scalar.texture();
    const v1::Texture& texture = message_.textures(static_cast<int>(use.texture()));
    if (texture.least() == 0.0 && texture.most() == 0.0) return 0.0;
    return use.bias() + std::min(use.gain() * texture.least(), use.gain() * texture.most());
  }

  const v1::CompiledScene& message_;
  const std::vector<AnyKernel>& kernels_;
};

bool needs_detail(const v1::Principled& kernel) {
  return varies(kernel.base()) || varies(kernel.metallic()) || varies(kernel.roughness()) ||
         varies(kernel.coat()) || varies(kernel.coat_roughness()) || kernel.has_brush() ||
         varies(kernel.reflectance().amount()) || varies(kernel.reflectance().normal()) ||
         varies(kernel.sheen().colour()) || varies(kernel.sheen().roughness());
}

}  // namespace

std::vector<AnyKernel> load_kernels(const LoadContext& context) {
  KernelLoader loader(context);
  std::vector<AnyKernel> kernels;
  for (const auto& kernel : context.message.kernels()) {
    kernels.push_back(checked([&] { return loader.load(kernel); }));
  }
  checked([&] {
    check_blends(kernels);
    return 0;
  });
  return kernels;
}

bool has_delta_lobe(const std::vector<AnyKernel>& kernels, std::uint32_t index) {
  return any_part(kernels, index, [](const auto& kernel) { return kernel.has_delta_lobe(); });
}

bool may_pass(const std::vector<AnyKernel>& kernels, std::uint32_t index) {
  return any_part(kernels, index, [](const auto& kernel) { return kernel.may_transmit(); });
}

bool may_turn_sharply(const std::vector<AnyKernel>& kernels, std::uint32_t index) {
  return any_part(kernels, index, []<class Kernel>(const Kernel& kernel) {
    return !std::is_same_v<Kernel, NullKernel> && kernel.has_delta_lobe();
  });
}

std::vector<bool> load_specular_like(const v1::CompiledScene& message,
                                     const std::vector<AnyKernel>& kernels) {
  std::vector<bool> by_kernel(kernels.size(), false);
  const SpecularLike specular_like(message, kernels);
  for (std::size_t i = 0; i < static_cast<std::size_t>(message.kernels_size()); ++i) {
    by_kernel[i] = specular_like(i);
  }
  return by_kernel;
}

bool needs_detail(const v1::CompiledScene& message, std::uint32_t index) {
  const v1::Kernel& kernel = message.kernels(static_cast<int>(index));
  switch (kernel.model_case()) {
    case v1::Kernel::kLambertian:
      return varies(kernel.lambertian().reflectance());
    case v1::Kernel::kDiffuseTransmitter:
      return varies(kernel.diffuse_transmitter().reflectance()) ||
             varies(kernel.diffuse_transmitter().transmittance());
    case v1::Kernel::kConductor:
      return anisotropic(kernel.conductor().roughness());
    case v1::Kernel::kCoatedConductor:
      return anisotropic(kernel.coated_conductor().conductor().roughness());
    case v1::Kernel::kCoatedDielectric:
      return anisotropic(kernel.coated_dielectric().dielectric().roughness());
    case v1::Kernel::kDielectric:
      return anisotropic(kernel.dielectric().roughness());
    case v1::Kernel::kCoatedDiffuse:
      return anisotropic(kernel.coated_diffuse().roughness()) ||
             varies(kernel.coated_diffuse().reflectance());
    case v1::Kernel::kPhong:
      return varies(kernel.phong().reflectance());
    case v1::Kernel::kPrincipled:
      return needs_detail(kernel.principled());
    case v1::Kernel::kFluorescent:
      return varies(kernel.fluorescent().reflectance());
    case v1::Kernel::kBlend:
      return std::ranges::any_of(kernel.blend().parts(), [&](const v1::Blend::Part& part) {
        return needs_detail(message, part.kernel()) ||
               std::ranges::any_of(part.factors(), [](const v1::Blend::Factor& factor) {
                 return varies(factor.weight());
               });
      });
    default:
      return false;
  }
}

}  // namespace nocturne
