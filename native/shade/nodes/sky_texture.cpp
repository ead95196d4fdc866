// SPDX-License-Identifier: GPL-3.0-or-later
// Sky Texture: sunlight scattered once (atmosphere.h) and the sun's disc, or fits to daylight
// (daylight.h, hosek_wilkie.h).  Blender 5's multiple scattering is a gradient from horizon to
// zenith in its mean colours at default settings, without a sun (measured from Cycles, mean over
// all azimuths).
#include <algorithm>
#include <cmath>

#include "math/angle_between.h"
#include "math/normalize_or.h"
#include "math/sampling.h"
#include "shade/nodes/atmosphere.h"
#include "shade/nodes/coordinates.h"
#include "shade/nodes/daylight.h"
#include "shade/nodes/hosek_wilkie.h"
#include "shade/nodes/nodes.h"

namespace granita {
namespace {

struct Sun {
    float elevation, azimuth;  ///< radians; the azimuth from x towards y
    float diameter;            ///< radians; 0 = no disc
    float strength;
    Vec3f lowest, highest;  ///< XYZ at the disc's ends
};

/// Elevations go on over the zenith and down on the other side.
void place_sun(float elevation, float rotation, Sun& sun) {
    const float up = std::remainder(elevation, 2.0f * kPi);
    const bool over = std::abs(up) > 0.5f * kPi;
    sun.elevation = over ? std::copysign(kPi, up) - up : up;
    sun.azimuth = 0.5f * kPi - rotation + (over ? kPi : 0.0f);
}

Vec3f rgb_of(const Vec3f& xyz) {
    const Vec3f rgb(3.2404542f * xyz.x - 1.5371385f * xyz.y - 0.4985314f * xyz.z,
                    -0.9692660f * xyz.x + 1.8760108f * xyz.y + 0.0415560f * xyz.z,
                    0.0556434f * xyz.x - 0.2040259f * xyz.y + 1.0572252f * xyz.z);
    return glm::max(rgb, Vec3f(0.0f));
}

/// @param away angle from its middle, within half of it.
Vec3f disc(const Sun& sun, float elevation, float away) {
    const float half = 0.5f * sun.diameter;
    if (sun.elevation + half <= 0.0f) return Vec3f(0.0f);
    const float height = sun.elevation > half ? (elevation - sun.elevation) / sun.diameter + 0.5f
                                              : elevation / (sun.elevation + half);
    const float part = away / half;
    const float darkening = 1.0f - 0.6f * (1.0f - std::sqrt(std::max(1.0f - part * part, 0.0f)));
    return sun.strength * darkening * glm::mix(sun.lowest, sun.highest, height);
}

/// Below the horizon its light fades within 24 degrees.
float fade(float up) {
    const float left = std::clamp(1.0f + 2.5f * up, 0.0f, 1.0f);
    return left * left * left;
}

float number(const NodeBuilder& b, const char* name, double otherwise) {
    return static_cast<float>(b.value(name, otherwise));
}

void build_scattering(NodeBuilder& b, const VectorSource& direction) {
    Sun sun;
    place_sun(number(b, "sun_elevation", 0.26), number(b, "sun_rotation", 0.0), sun);
    const float dust = number(b, "dust_density", b.value("aerosol_density", 1.0));
    const Atmosphere atmosphere{sun.elevation, number(b, "altitude", 0.0),
                                number(b, "air_density", 1.0), dust,
                                number(b, "ozone_density", 1.0)};
    sun.diameter = b.value("sun_disc", 1.0) != 0.0 ? number(b, "sun_size", 0.0095) : 0.0f;
    sun.strength = number(b, "sun_intensity", 1.0);
    if (sun.diameter > 0.0f) {
        const float half = 0.5f * sun.diameter;
        sun.lowest = atmosphere.sun(std::max(sun.elevation - half, 0.0f), sun.diameter);
        sun.highest = atmosphere.sun(std::max(sun.elevation + half, 0.0f), sun.diameter);
    }
    const Vec3f to_sun(std::cos(sun.elevation) * std::cos(sun.azimuth),
                       std::cos(sun.elevation) * std::sin(sun.azimuth), std::sin(sun.elevation));
    const auto table = sky_table(atmosphere);
    b.output_color("Color", b.map<Vec3f>(
                                // Not made unit, as in Cycles.
                                [=](const Vec3f& d) {
                                    const float up = std::clamp(d.z, -1.0f, 1.0f);
                                    const float elevation = std::asin(up);
                                    const float away = angle_between(d, to_sun);
                                    if (2.0f * away < sun.diameter && up >= 0.0f)
                                        return rgb_of(disc(sun, elevation, away));
                                    const float azimuth = std::atan2(d.y, d.x) - sun.azimuth;
                                    return rgb_of(fade(up) * table->look_up(elevation, azimuth));
                                },
                                direction));
}

/// Cycles takes a direction's height and azimuth as they are, whatever its length.
Vec3f at_its_height(const Vec3f& d) {
    const float up = std::clamp(d.z, -1.0f, 1.0f);
    const Vec3f level = normalize_or(Vec3f(d.x, d.y, 0.0f), Vec3f(1.0f, 0.0f, 0.0f));
    return std::sqrt(1.0f - up * up) * level + Vec3f(0.0f, 0.0f, up);
}

template <class Sky>
void build_fit(NodeBuilder& b, const VectorSource& direction, const Sky& sky) {
    b.output_color("Color",
                   b.map<Vec3f>([sky](const Vec3f& d) { return rgb_of(sky.xyz(at_its_height(d))); },
                                direction));
}

Vec3f direction_to_sun(const NodeBuilder& b) {
    std::vector<float> at = b.table("sun_direction");
    at.resize(3, 0.0f);
    return normalize_or(Vec3f(at[0], at[1], at[2]), Vec3f(0.0f, 0.0f, 1.0f));
}

void build_gradient(NodeBuilder& b, const std::string& type, const VectorSource& direction) {
    b.warn("Sky Texture's model " + type +
           " is not supported; rendered as a plain gradient without a sun");
    b.output_color("Color", b.map<Vec3f>(
                                [](const Vec3f& v) {
                                    const float length = glm::length(v);
                                    const float up = length > 0.0f ? v.z / length : 0.0f;
                                    if (up < 0.0f) return Vec3f(0.0f);
                                    return glm::mix(Vec3f(8.3f, 7.7f, 5.9f),
                                                    Vec3f(0.55f, 0.87f, 1.44f), up);
                                },
                                direction));
}

}  // namespace

void build_sky_texture(NodeBuilder& b) {
    const VectorSource direction =
        b.linked("Vector") ? b.vector("Vector") : generated_at(b, b.shift());
    const std::string type = b.text("sky_type", "NISHITA");
    if (type == "NISHITA" || type == "SINGLE_SCATTERING")
        build_scattering(b, direction);
    else if (type == "PREETHAM")
        build_fit(b, direction, Daylight(direction_to_sun(b), number(b, "turbidity", 2.2)));
    else if (type == "HOSEK_WILKIE")
        build_fit(b, direction,
                  HosekWilkieSky(direction_to_sun(b), number(b, "turbidity", 2.2),
                                 number(b, "ground_albedo", 0.3)));
    else
        build_gradient(b, type, direction);
}

}  // namespace granita
