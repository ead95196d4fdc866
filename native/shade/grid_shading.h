// SPDX-License-Identifier: GPL-3.0-or-later
// A grid between the two halves of its shading: what its points find by themselves, and what they
// share with each other and with the grids around.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "shade/bsdf/lobe.h"
#include "shade/bsdf/reflection.h"
#include "shade/lights/lamp_sight.h"
#include "shade/lights/light_motion.h"
#include "shade/nodes/surface_run.h"
#include "shade/told_light.h"

namespace granita {

/// Points of a grid, or samples in it.
struct PointShading {
    /// `surface` and `in`, its points among it, must outlive this.
    PointShading(const SurfaceProgram& surface, const ShadingInput& in)
        : ran(surface, in), closure(ran.take_closure()) {}

    SurfaceRun ran;
    SurfaceClosure closure;
    ReflectionParts parts;
    std::vector<Vec3f> radiance;
    std::optional<GatheredLight> gathered;  ///< none: light is not followed
    std::shared_ptr<ToldLight> told = std::make_shared<ToldLight>();
};

/// Where a grid's corners may not tell all.
struct Doubts {
    std::vector<float> noise;    ///< as DirectLight::reflect()
    std::vector<Vec3f> settled;  ///< [vertices] radiance but for what is noise at single
                                 ///< points, and what all take from the grid: empty where it
                                 ///< is all
    std::vector<float> looks;    ///< looks_of(), of patterns
    std::vector<LampSight> sights;
    std::vector<std::uint8_t> highlights;  ///< as Grid::unsettled
    bool may_pass = false;                 ///< lamps, as what moves mirrors them
};

struct GridShading {
    ShadingPoints points;
    PointPaths at;
    std::optional<ShadingInput> in;
    std::optional<PointShading> found;
    Doubts doubts;
    bool wants_refining = false;
    bool turns = false;  ///< what is seen of it to its other side
    /// Of a point's light samples what blur leaves, and with what narrow and dense ones leave.
    float sharpness = 1.0f, fewer = 1.0f;
    float light_fraction = 0.0f;  ///< as Grid::light_fraction

    GridShading() = default;
    GridShading(const GridShading&) = delete;
    GridShading& operator=(const GridShading&) = delete;
};

}  // namespace granita
