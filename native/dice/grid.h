// SPDX-License-Identifier: GPL-3.0-or-later
// The micropolygon grid (paper, section 9.3.2): what dicing makes, shading fills and the hider
// hides.
//
//   v          vertex (i, j) has index j * (n_u + 1) + i
//   ^  3---2   micropolygon (i, j) has index j * n_u + i and the corners
//   |  | / |   0 = (i, j)  1 = (i+1, j)  2 = (i+1, j+1)  3 = (i, j+1)
//   |  0---1   it is the two triangles (0, 1, 2) and (0, 2, 3): the diagonal is fixed
//   +-----> u
//
// Where a border of the patch carries fewer vertices than the interior (crack-free dicing),
// neighbouring border vertices of the grid coincide bit for bit: micropolygons there are triangles
// or empty.
//
// A grid is immutable after dicing (decision 4) except for the slots `opacity` and `radiance`, each
// filled once.
#pragma once

#include <compare>
#include <cstdint>
#include <vector>

#include "math/bounds.h"
#include "math/vec.h"

namespace granita {

/// Identity of a grid, from the scene alone (decision 3): orders pools, breaks ties, seeds shading.
struct GridKey {
    std::uint32_t instance = 0;  ///< Instance::key
    std::uint32_t face = 0;
    std::uint64_t path = 1;  ///< split path: 1 then one bit a split
    auto operator<=>(const GridKey&) const = default;
};

/// A primitive variable at the grid's vertices.
struct GridAttribute {
    int attribute = 0;  ///< index in the material's list of requested attributes
    int width = 1;
    std::vector<float> values;  ///< [vertices][width]
    std::vector<float> du,
        dv;  ///< [vertices][width] change over one grid step, parametric; empty if not asked
};

struct Grid {
    GridKey key;
    std::uint32_t instance = 0;  ///< index in Scene::instances
    std::int32_t material = -1;  ///< index in Scene::materials, slot already resolved
    int n_u = 0, n_v = 0;        ///< micropolygons along u and v, each >= 1
    int knots = 1;               ///< equidistant in shutter time

    std::vector<Vec3f> positions;  ///< [knots][vertices] camera space at each knot
    /// Shading state at the frame time, camera space of the frame time.
    std::vector<Vec3f> p;  ///< [vertices]; empty when knots == 1: positions serve
    std::vector<Vec3f>
        normal;  ///< [vertices] unit shading normal, outward as modelled (not yet faced forward)
    std::vector<Vec3f> geometric_normal;  ///< [vertices] unit, of the surface itself
    std::vector<Vec3f> dp_du, dp_dv;      ///< [vertices] change of P over one grid step
    std::vector<GridAttribute> attributes;

    RasterBounds bounds;   ///< swept over shutter and lens
    bool motion = false;   ///< knots differ
    bool holdout = false;  ///< Instance::holdout: hides what is behind and cuts alpha, adds nothing
    std::uint64_t bytes() const;

    // Slots, filled once by shade.
    bool opacity_varies = false;  ///< opacity holds values; otherwise the grid is opaque
    bool additive =
        false;  ///< may have radiance where its opacity is 0: such points are not dropped
    std::vector<Vec3f> opacity;  ///< [vertices]
    std::vector<Vec3f>
        radiance;  ///< [vertices] premultiplied by opacity, plus emission; linear, unclamped

    std::vector<float> channels;  ///< [vertices][ChannelSet::vertex_width()]; empty = none asked

    int vertex_count() const { return (n_u + 1) * (n_v + 1); }
    int micropolygon_count() const { return n_u * n_v; }
    const std::vector<Vec3f>& shading_p() const { return p.empty() ? positions : p; }
    /// The four vertex indices of a micropolygon.
    struct Corners {
        int v0, v1, v2, v3;
    };
    Corners corners(int micropolygon) const {
        const int i = micropolygon % n_u, j = micropolygon / n_u;
        const int v0 = j * (n_u + 1) + i;
        return {v0, v0 + 1, v0 + n_u + 2, v0 + n_u + 1};
    }
};

}  // namespace granita
