// The immutable scene that all threads of a worker share.
#pragma once

#include <cstdint>
#include <vector>

#include "kernels/any_kernel.h"
#include "luminaires/luminaire.h"
#include "luminaires/luminaire_directions.h"
#include "sampling/sequence.h"
#include "sensors/camera.h"
#include "sensors/wavelengths.h"
#include "surfaces/geometry.h"

namespace nocturne {

/// Weights of the mixture density; not negative, sum 1.
struct MixtureWeights {
  float kernel, luminaires, uniform;
};

struct TracingOptions {
  /// A photon survives a vertex with probability min(1, H h), times its weight inside the minimum
  /// where roulette_by_weight says so.
  float h;
  bool roulette_by_weight;
  /// Surface interactions after which it is absorbed.
  std::uint32_t maximum_depth;
  MixtureWeights mixture;
  SequenceKind sequence;
  std::uint64_t seed;
};

/// What a surface is made of: index of a kernel, and of a luminaire or kNoLuminaire.
struct SurfaceMaterial {
  static constexpr std::uint32_t kNoLuminaire = ~0u;
  std::uint32_t kernel;
  std::uint32_t luminaire;
};

struct Scene {
  Geometry geometry;
  std::vector<SurfaceMaterial> materials;  // by surface
  std::vector<AnyKernel> kernels;
  std::vector<Luminaire> luminaires;
  LuminaireDirections luminaire_directions;
  Camera camera;
  WavelengthSampler wavelengths;
  TracingOptions options;
};

}  // namespace nocturne
