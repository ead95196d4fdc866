// SPDX-License-Identifier: GPL-3.0-or-later
// Points of a grid, or samples in it, to radiance, in two halves: find_light(), shade().
#pragma once

#include "dice/grid.h"
#include "shade/frame_shading.h"
#include "shade/grid_shading.h"
#include "shade/shading_input.h"

namespace granita {

struct PointShader : FrameShading {
    using FrameShading::FrameShading;

    template <class Points>
    ShadingInput input(const Grid& grid, const Points& points) const {
        return shading_input(grid, points, scene, light ? light->rays() : nullptr, progress);
    }

    /// The light that points of `grid` find each by themselves, once its surface was run over them.
    void find_light(PointShading& s, const Grid& grid, const PointPaths& at,
                    Doubts* doubts = nullptr) const;

    /// Fills radiance and channels of `grid` with what its points found, and what those `around`
    /// tell them.
    void shade(Grid& grid, PointShading& s, const ToldLights& around = ToldLights(),
               Doubts* doubts = nullptr) const;

    /// Fills opacity of `grid`, whose points are `in.points`.
    void shade_opacity(Grid& grid, const ShadingInput& in) const;

  private:
    /// What surfaces send to each other: to points of a grid, which tell each other of it, or to
    /// samples in it, whose diffuse lobes take it from the grid.
    void gather(PointShading& s, LeavingRays& leaving, const Grid& grid,
                const PointPaths& at) const;

    /// Again where too few points share.
    void gather_more(PointShading& s, LeavingRays& leaving, const Grid& grid,
                     const PointPaths& at) const;
};

}  // namespace granita
