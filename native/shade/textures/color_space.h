// SPDX-License-Identifier: GPL-3.0-or-later
// Colour spaces of images by Blender's names for them, to scene-linear Rec.709.
#pragma once

#include <optional>
#include <string>

#include "math/vec.h"

namespace granita {

struct ColorSpace {
    enum class Curve { Linear, Srgb, Gamma24, FilmicLog };
    Curve curve = Curve::Linear;
    bool is_data = false;        ///< no colour at all: alpha is left alone too
    bool is_rec709 = true;       ///< of primaries; else `to_rec709` holds
    float to_rec709[3][3] = {};  ///< of linear colours

    /// Nothing is to be done but sRGB's curve, or nothing at all.
    bool is_plain() const { return is_rec709 && (curve == Curve::Linear || curve == Curve::Srgb); }
    Vec3f linear(const Vec3f& color) const;
};

/// The spaces of Blender's own configurations, 3.4 to 5.0, that are a curve and a matrix.  Nothing
/// for those that are pictures of a view transform (Filmic sRGB, AgX), and for names of other
/// configurations.
std::optional<ColorSpace> find_color_space(const std::string& name);

}  // namespace granita
