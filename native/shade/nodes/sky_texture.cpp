// SPDX-License-Identifier: GPL-3.0-or-later
// Sky Texture: scattered sunlight (sky_table.h) and the sun's disc, or fits to daylight
// (daylight.h, hosek_wilkie.h).
#include <algorithm>
#include <cmath>

#include "math/angle_between.h"
#include "math/normalize_or.h"
#include "math/observer.h"
#include "math/sampling.h"
#include "shade/nodes/daylight.h"
#include "shade/nodes/hosek_wilkie.h"
#include "shade/nodes/multiple_scattering.h"
#include "shade/nodes/nodes.h"
#include "shade/nodes/single_scattering.h"
#include "shade/nodes/sky_table.h"
#include "shade/nodes/texture_place.h"

namespace granita {
namespace {

/// Radians: as small as Cycles lets it be.
constexpr float kLeastSun = 0.0005f;

struct Sun {
    float elevation, azimuth;  ///< radians; the azimuth from x towards y
    float diameter = 0.0f;     ///< radians; 0 = no disc
    float strength = 1.0f;
    float horizon = 0.0f;       ///< elevation that hides it
    Vec3f lowest{}, highest{};  ///< XYZ at the disc's ends
};

/// Elevations go on over the zenith and down on the other side.
Sun placed_sun(float elevation, float rotation) {
    const float up = std::remainder(elevation, 2.0f * kPi);
    const bool over = std::abs(up) > 0.5f * kPi;
    return {over ? std::copysign(kPi, up) - up : up, 0.5f * kPi - rotation + (over ? kPi : 0.0f)};
}

void light_disc(SkyModel model, const Atmosphere& air, Sun& sun) {
    const float half = 0.5f * sun.diameter;
    const float lowest = sun.elevation - half, highest = sun.elevation + half;
    if (model == SkyModel::MultipleScattering) {
        sun.lowest = MultipleScattering::sun(air, lowest, sun.diameter);
        sun.highest = MultipleScattering::sun(air, highest, sun.diameter);
    } else if (highest > 0.0f) {
        sun.lowest = SingleScattering::sun(air, std::max(lowest, 0.0f), sun.diameter);
        sun.highest = SingleScattering::sun(air, highest, sun.diameter);
    }
}

/// How far below level the earth begins.  `altitude` metres.
float dip_of_horizon(float altitude) {
    constexpr float kEarthRadius = 6371e3f;
    return std::acos(std::min(kEarthRadius / (kEarthRadius + altitude), 1.0f));
}

Vec3f rgb_of(const WorkingSpace& colors, const Vec3f& xyz) {
    return glm::max(colors.from_xyz(xyz), Vec3f(0.0f));
}

/// @param height 0 at the disc's lowest place, 1 at its highest.
/// @param away angle from its middle, within half of it.
Vec3f disc(const Sun& sun, float height, float away) {
    const float part = 2.0f * away / sun.diameter;
    const float darkening = 1.0f - 0.6f * (1.0f - std::sqrt(std::max(1.0f - part * part, 0.0f)));
    return sun.strength * darkening * glm::mix(sun.lowest, sun.highest, height);
}

float number(const NodeBuilder& b, const char* name, double otherwise) {
    return static_cast<float>(b.value(name, otherwise));
}

void build_scattering(NodeBuilder& b, SkyModel model, const VectorSource& direction) {
    const bool nishita = model == SkyModel::Nishita;
    Sun sun = placed_sun(number(b, "sun_elevation", 0.26), number(b, "sun_rotation", 0.0));
    const float dust = number(b, "dust_density", b.value("aerosol_density", 1.0));
    const Atmosphere air{sun.elevation, number(b, "altitude", 0.0), number(b, "air_density", 1.0),
                         dust, number(b, "ozone_density", 1.0)};
    if (b.value("sun_disc", 1.0) != 0.0) {
        sun.diameter = std::max(number(b, "sun_size", 0.0095), kLeastSun);
        sun.strength = number(b, "sun_intensity", 1.0);
        sun.horizon = nishita ? 0.0f : -dip_of_horizon(air.altitude);
        light_disc(model, air, sun);
    }
    const Vec3f to_sun(std::cos(sun.elevation) * std::cos(sun.azimuth),
                       std::cos(sun.elevation) * std::sin(sun.azimuth), std::sin(sun.elevation));
    // Nishita's low sun is stretched over what is left of it.
    const float half = 0.5f * sun.diameter;
    const bool cut = nishita && sun.elevation <= half;
    const float bottom = cut ? 0.0f : sun.elevation - half;
    const float extent = cut ? sun.elevation + half : sun.diameter;
    const auto table = sky_table(model, air);
    const WorkingSpace colors = b.scene().working_space;
    b.output_color("Color", b.map<Vec3f>(
                                // Not made unit, as in Cycles.
                                [=](const Vec3f& d) {
                                    const float elevation = std::asin(std::clamp(d.z, -1.0f, 1.0f));
                                    const float away = angle_between(d, to_sun);
                                    const Vec3f sky = table->look_up(
                                        elevation, std::atan2(d.y, d.x) - sun.azimuth);
                                    if (away >= half || elevation < sun.horizon)
                                        return rgb_of(colors, sky);
                                    const Vec3f seen =
                                        disc(sun, (elevation - bottom) / extent, away);
                                    return rgb_of(colors, nishita ? seen : seen + sky);
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
    b.output_color("Color", b.map<Vec3f>(
                                [sky, colors = b.scene().working_space](const Vec3f& d) {
                                    return rgb_of(colors, sky.xyz(at_its_height(d)));
                                },
                                direction));
}

Vec3f direction_to_sun(const NodeBuilder& b) {
    std::vector<float> at = b.table("sun_direction");
    at.resize(3, 0.0f);
    return normalize_or(Vec3f(at[0], at[1], at[2]), Vec3f(0.0f, 0.0f, 1.0f));
}

}  // namespace

void build_sky_texture(NodeBuilder& b) {
    const VectorSource direction = texture_place(b);
    const std::string type = b.text("sky_type", "NISHITA");
    if (type == "PREETHAM")
        build_fit(b, direction, Daylight(direction_to_sun(b), number(b, "turbidity", 2.2)));
    else if (type == "HOSEK_WILKIE")
        build_fit(b, direction,
                  HosekWilkieSky(direction_to_sun(b), number(b, "turbidity", 2.2),
                                 number(b, "ground_albedo", 0.3)));
    else if (type == "MULTIPLE_SCATTERING")
        build_scattering(b, SkyModel::MultipleScattering, direction);
    else if (type == "SINGLE_SCATTERING")
        build_scattering(b, SkyModel::SingleScattering, direction);
    else
        build_scattering(b, SkyModel::Nishita, direction);
}

}  // namespace granita
