// SPDX-License-Identifier: GPL-3.0-or-later
#include "shade/textures/color_space.h"

#include <algorithm>
#include <cmath>
#include <initializer_list>

#include "shade/textures/texel.h"

namespace granita {

namespace {

using Curve = ColorSpace::Curve;

struct Primaries {
    float to_rec709[3][3];
};

// From the primaries and white points of SMPTE RP 431-2 (white D65), ITU-R BT.2020 and SMPTE ST
// 2065-1, the last adapted from D60 to D65 after Bradford.
constexpr Primaries kP3 = {{{1.2249402f, -0.2249402f, 0.0f},
                            {-0.0420570f, 1.0420570f, 0.0f},
                            {-0.0196376f, -0.0786360f, 1.0982736f}}};
constexpr Primaries kRec2020 = {{{1.6604910f, -0.5876411f, -0.0728499f},
                                 {-0.1245505f, 1.1328999f, -0.0083494f},
                                 {-0.0181508f, -0.1005789f, 1.1187297f}}};
constexpr Primaries kAp1 = {{{1.7050510f, -0.6217921f, -0.0832589f},
                             {-0.1302564f, 1.1408047f, -0.0105483f},
                             {-0.0240034f, -0.1289690f, 1.1529723f}}};
constexpr Primaries kAp0 = {{{2.5216862f, -1.1341310f, -0.3875552f},
                             {-0.2764799f, 1.3727191f, -0.0962392f},
                             {-0.0153781f, -0.1529753f, 1.1683534f}}};
constexpr Primaries kXyz = {{{3.2409699f, -1.5373832f, -0.4986108f},
                             {-0.9692436f, 1.8759675f, 0.0415551f},
                             {0.0556301f, -0.2039770f, 1.0569715f}}};
// With the adaptation from illuminant E, and the gamut, that Blender's configuration states.
constexpr Primaries kXyzE = {{{3.1467518f, -1.6663891f, -0.4802035f},
                              {-0.9955120f, 1.9557183f, 0.0397706f},
                              {0.0635826f, -0.2145451f, 1.1507225f}}};
constexpr Primaries kEGamut = {{{1.9072483f, -0.6929665f, -0.2142818f},
                                {-0.1624979f, 1.3766553f, -0.2141574f},
                                {-0.1275930f, -0.2352385f, 1.3628315f}}};

struct Entry {
    const char* name;
    Curve curve;
    const Primaries* primaries;  ///< nullptr: Rec.709
    bool is_data = false;
};

constexpr Entry kEntries[] = {
    {"Non-Color", Curve::Linear, nullptr, true},
    {"Raw", Curve::Linear, nullptr, true},
    {"data", Curve::Linear, nullptr},
    {"Linear", Curve::Linear, nullptr},
    {"Linear Rec.709", Curve::Linear, nullptr},
    {"Linear BT.709", Curve::Linear, nullptr},
    {"scene_linear", Curve::Linear, nullptr},
    {"sRGB", Curve::Srgb, nullptr},
    {"Rec.1886", Curve::Gamma24, nullptr},
    {"Filmic Log", Curve::FilmicLog, nullptr},
    {"Display P3", Curve::Srgb, &kP3},
    {"Linear DCI-P3 D65", Curve::Linear, &kP3},
    {"Rec.2020", Curve::Gamma24, &kRec2020},
    {"Linear Rec.2020", Curve::Linear, &kRec2020},
    {"ACEScg", Curve::Linear, &kAp1},
    {"Linear ACEScg", Curve::Linear, &kAp1},
    {"ACES2065-1", Curve::Linear, &kAp0},
    {"Linear ACES", Curve::Linear, &kAp0},
    {"XYZ", Curve::Linear, &kXyz},
    {"Linear CIE-XYZ D65", Curve::Linear, &kXyz},
    {"Linear CIE-XYZ E", Curve::Linear, &kXyzE},
    {"Linear FilmLight E-Gamut", Curve::Linear, &kEGamut},
};

float linear_number(Curve curve, float x) {
    switch (curve) {
        case Curve::Linear:
            return x;
        case Curve::Srgb:
            return linear_from_srgb(x);
        case Curve::Gamma24:
            return std::pow(std::max(x, 0.0f), 2.4f);
        case Curve::FilmicLog:
            return std::exp2(x * 16.5f - 12.473931188f);
    }
    return x;
}

}  // namespace

Vec3f ColorSpace::linear(const Vec3f& color) const {
    const Vec3f c(linear_number(curve, color.x), linear_number(curve, color.y),
                  linear_number(curve, color.z));
    if (is_rec709) return c;
    Vec3f out;
    for (int k = 0; k < 3; ++k)
        out[k] = to_rec709[k][0] * c.x + to_rec709[k][1] * c.y + to_rec709[k][2] * c.z;
    return out;
}

std::optional<ColorSpace> find_color_space(const std::string& name) {
    const Entry* entry = std::find_if(std::begin(kEntries), std::end(kEntries),
                                      [&](const Entry& e) { return name == e.name; });
    if (entry == std::end(kEntries)) return std::nullopt;
    ColorSpace space;
    space.curve = entry->curve;
    space.is_data = entry->is_data;
    space.is_rec709 = entry->primaries == nullptr;
    if (entry->primaries)
        std::copy(&entry->primaries->to_rec709[0][0], &entry->primaries->to_rec709[0][0] + 9,
                  &space.to_rec709[0][0]);
    return space;
}

}  // namespace granita
