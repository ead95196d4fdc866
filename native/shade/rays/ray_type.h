// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstddef>

namespace granita {

/// What a ray is traced for: materials and worlds tell it by the node Light Path.  Light of the
/// world is asked for by the lobe that sends it on, Singular by mirrors, Clear by what is as sharp
/// and transmits, Translucent by what is diffuse and transmits, Scattered by what fills things.
enum class RayType {
    Camera,
    Shadow,
    Diffuse,
    Glossy,
    Singular,
    Transmission,
    Clear,
    Translucent,
    Scattered
};
constexpr std::size_t kRayTypes = 9;
/// Those that bring light: all but shadow rays, which ask what lets it through.
inline constexpr std::array kSeeingRays{
    RayType::Camera,       RayType::Diffuse, RayType::Glossy,      RayType::Singular,
    RayType::Transmission, RayType::Clear,   RayType::Translucent, RayType::Scattered};
/// Of these, those that lobes send.
inline constexpr std::array kLightRays{RayType::Diffuse,      RayType::Glossy, RayType::Singular,
                                       RayType::Transmission, RayType::Clear,  RayType::Translucent,
                                       RayType::Scattered};

/// Of lobes that send light through the surface.
constexpr bool goes_through(RayType ray) {
    return ray == RayType::Transmission || ray == RayType::Clear || ray == RayType::Translucent;
}
/// Of diffuse lobes, to either side.
constexpr bool is_diffuse(RayType ray) {
    return ray == RayType::Diffuse || ray == RayType::Translucent;
}
/// Of lobes that send light on in one direction.
constexpr bool is_sharp(RayType ray) {
    return ray == RayType::Singular || ray == RayType::Clear;
}

}  // namespace granita
