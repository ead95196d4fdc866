// SPDX-License-Identifier: GPL-3.0-or-later
// Colour spaces: what makes scene-linear colours of the numbers of an image, and what scene-linear
// colours stand for.
#pragma once

#include <memory>
#include <string_view>
#include <vector>

#include "math/luminance.h"
#include "math/vec.h"

namespace granita {

/// Of an image: one curve for all channels, then a matrix; or a cube for what is neither (view
/// transforms that are inverted).
struct ColorSpace {
    enum class Curve { Linear, Srgb, Table };
    Curve curve = Curve::Srgb;
    bool is_data = false;  ///< no colour at all: alpha is left alone too
    Mat3f matrix = Mat3f(1.0f);
    std::vector<float> table;  ///< equidistant from `low` to `high`
    float low = 0.0f, high = 1.0f;
    int cube_size = 0;        ///< numbers along an edge; 0: no cube
    std::vector<Vec3f> cube;  ///< [blue][green][red], each from 0 to 1, beyond which its ends are
    bool operator==(const ColorSpace&) const = default;

    /// Nothing is to be done but sRGB's curve, or nothing at all.
    bool is_plain() const {
        return cube_size == 0 && curve != Curve::Table && matrix == Mat3f(1.0f);
    }
    Vec3f linear(const Vec3f& color) const;
};

/// Those that need no description: "sRGB", "scene_linear" and "Non-Color"; nullptr for other names.
std::shared_ptr<const ColorSpace> plain_color_space(std::string_view name);

/// What scene-linear colours stand for: by default Rec. 709's primaries.  Files of Blender 5 have a
/// working space of their own, and so have studios' configurations of OpenColorIO.
struct WorkingSpace {
    Mat3f from_rec709 = Mat3f(1.0f);
    Vec3f luminance = kLuminance;  ///< of the primaries
    bool operator==(const WorkingSpace&) const = default;

    Vec3f from_xyz(const Vec3f& xyz) const;
    /// As Cycles makes a number of a colour.
    float number(const Vec3f& color) const { return glm::dot(luminance, color); }
};

}  // namespace granita
