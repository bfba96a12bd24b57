#pragma once

namespace nocturne {

/// IEC 61966-2-1: XYZ of white D65 to linear sRGB.
inline constexpr float kRgbOfXyz[3][3] = {
    {3.2406f, -1.5372f, -0.4986f}, {-0.9689f, 1.8758f, 0.0415f}, {0.0557f, -0.2040f, 1.0570f}};

}  // namespace nocturne
