// Where a line crosses what a search found, in double precision: the order of surfaces that lie
// closer together than single precision tells apart (docs/decisions/0053).
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#include "surfaces/departure.h"
#include "surfaces/hit.h"
#include "surfaces/instance.h"
#include "surfaces/locate.h"
#include "surfaces/shapes.h"

namespace nocturne {

/// The surfaces close to a surface, as the owner of the materials reports them.
struct CloseSurface {
  /// How far from the surface something may be that a ray which starts off it would step over, m;
  /// 0: nothing is.
  float reach = 0.0f;
  /// Bounds a body.
  bool body = false;
  /// Emits: what bounds a body touches it only where the numbers leave no room between.
  bool luminaire = false;
  /// Lets light straight through, as a mask or the boundary of fog: it hides nothing that it lies
  /// on, and lies next to it, on the outside of a body.
  bool straight = false;
};

struct ExactCrossing {
  /// From where the line starts, m.
  double distance;
  /// Unit, as a hit's.
  Double3 normal;
  /// Cosine of the normal to the line's direction: negative where it comes from the outside.
  double facing;
  /// Sum over axes of the normal's component times the largest coordinate there, m: one rounding of
  /// the vertices to floats moves the surface by at most 2^-24 of it.
  double coordinate;
  /// What double precision may be off by along the normal, m.
  double noise;

  bool entering() const { return facing < 0.0; }
};

/// `placement` is null for shapes in the scene itself.
ExactCrossing cross_exactly(const Shape& shape, const Placement* placement, Double3 origin,
                            Double3 direction, const Found& found, float time);

/// The point of a hit, in the scene: of a triangle the one with its barycentric coordinates.
Double3 exact_point(const Shape& shape, const Placement* placement, const Hit& hit, float time);

/// Whether two triangles share a corner: neighbours, or neighbours' neighbours.
bool share_corner(const TriangleMesh& mesh, std::uint32_t a, std::uint32_t b);

/// One that stands for a crossing that was made: which surface, and how.
struct Crossed {
  std::uint32_t surface, instance, primitive;
  ExactCrossing at;
};

/// Whether two of the surfaces that a line crosses close together lie in one place: they are
/// parallel, and at no distance at all; or one of them bounds a body, and they are no further apart
/// than the numbers show that they are made of. Of all faces of one surface only the nearest
/// touches another, and that one's nearest only: so the faces of a thin body stay apart. Of one
/// surface only a part that is left and then entered again touches, as two boxes of one mesh may.
/// `close` is by surface.
bool touch(std::span<const Crossed> crossed, std::size_t a, std::size_t b,
           std::span<const CloseSurface> close);

/// Of a sheet that lets light straight through and the one body on whose boundary it lies exactly:
/// whether the line crosses `a` before `b`, since the sheet is outside of the body. No value: they
/// are no such two.
std::optional<bool> sheet_order(std::span<const Crossed> crossed, std::size_t a, std::size_t b,
                                std::span<const CloseSurface> close);

/// Whether they are one crossing, which a ray next to an edge finds twice.
bool same_crossing(const Shape& shape, const Crossed& left, const Crossed& again);

}  // namespace nocturne
