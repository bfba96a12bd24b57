// Normals that a texture perturbs.
#pragma once

#include "math/frame.h"
#include "surfaces/surface_detail.h"

namespace nocturne {

/// A right-handed frame around a unit normal whose tangent is the part of `along` that is
/// perpendicular to it; any frame where there is none. For kernels that tell directions apart
/// (brushed metal), with `along` = SurfaceDetail::dp_du.
Frame frame_along(Vec3 normal, Vec3 along);

/// `tangent_space`: of any length; x along dp_du, y along dp_dv (both made perpendicular), z along
/// the shading normal. Unit, within the hemisphere of the geometric normal.
Vec3 mapped_normal(const SurfaceDetail& detail, Vec3 tangent_space);

/// Heights above the surface, along the shading normal: their derivatives by u and v, metres per
/// texture unit. Blinn, "Simulation of Wrinkled Surfaces", SIGGRAPH 1978, as a gradient on the
/// surface: Mikkelsen, "Bump Mapping Unparametrized Surfaces on the GPU", J. Graphics, GPU and Game
/// Tools 15(1), 2010, eq. 4. Unit, within the hemisphere of the geometric normal.
Vec3 bumped_normal(const SurfaceDetail& detail, float dh_du, float dh_dv);

}  // namespace nocturne
