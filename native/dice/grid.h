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
// Small faces of a mesh share a grid, though its micropolygons then share no vertices (`disjoint`):
// micropolygon m has its corners 0, 1, 3 and 2 at m, m + n_u, m + 2 n_u and m + 3 n_u, in one row.
//
// Where a border of the patch carries fewer vertices than the interior (crack-free dicing),
// neighbouring border vertices of the grid coincide bit for bit: micropolygons there are triangles
// or empty.
//
// Shading points are the vertices, or fewer: see ShadingPositions.
//
// A grid is immutable after dicing (decision 4) except for the slots `opacity` and `radiance`, each
// filled once.
#pragma once

#include <compare>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "dice/grid_light.h"
#include "math/bounds.h"
#include "math/vec.h"
#include "scene/lifespan.h"

namespace granita {

struct ToldLight;

/// Identity of a grid, from the scene alone (decision 3): orders pools, breaks ties, seeds shading.
struct GridKey {
    std::uint32_t instance = 0;  ///< Instance::key
    std::uint32_t face = 0;
    std::uint64_t path = 1;  ///< split path: 1, then a bit for two pieces, two for four
    auto operator<=>(const GridKey&) const = default;
};

/// One of the two that a micropolygon is: corners 0, 1, 2 or 0, 2, 3.
struct GridTriangle {
    std::uint32_t micropolygon = 0;
    bool second = false;
    auto operator<=>(const GridTriangle&) const = default;
};

/// A place in a triangle, by weights of its corners.
struct GridPlace {
    GridTriangle triangle;
    float weight[3] = {1.0f, 0.0f, 0.0f};
};

/// A primitive variable at the grid's shading points.
struct GridAttribute {
    int attribute = 0;  ///< index in the material's list of requested attributes
    int width = 1;
    std::vector<float> values;  ///< [points][width]
    /// [points][width] change from one point to the next, parametric; empty if not asked
    std::vector<float> du, dv;
};

/// Where a grid is shaded, if not at every vertex.
struct ShadingPositions {
    /// [points] a vertex of each point: it moves along with it.  Empty: the vertices are the
    /// points.
    std::vector<std::uint32_t> anchors;
    /// A lattice is shaded at every step_u-th vertex of every step_v-th row; steps divide n_u, n_v.
    int step_u = 1, step_v = 1;
    /// [vertices] of a grid of separate micropolygons: the point whose colour each has.
    std::vector<std::uint32_t> point_of;
    /// [points] the face that each lies on, where that is not GridKey::face.  Empty: it is.
    std::vector<std::uint32_t> faces;
};

/// Corners of a mesh, and what part each has in a place; all 0 where a face is flat.
struct CornerBlend {
    std::uint32_t corner[4]{};
    float weight[4]{};
};

class KnotNormals;

struct Grid {
    GridKey key;
    std::uint32_t instance = 0;  ///< index in Scene::instances
    std::int32_t material = -1;  ///< index in Scene::materials, slot already resolved
    int n_u = 0, n_v = 0;        ///< micropolygons along u and v, each >= 1
    bool disjoint = false;       ///< micropolygons share no vertices; n_v is 1
    int knots = 1;               ///< equidistant in shutter time

    std::vector<Vec3f> positions;  ///< [knots][vertices] camera space at each knot
    /// Fills in the shading state and the attributes of a grid of dice() before its first shading:
    /// many grids are hidden and never shaded.  Outlives the primitive.  Empty: nothing is missing.
    std::function<void(Grid&)> shading_state;
    bool state_asks_displacement = false;  ///< which ends with the picture
    /// Of small faces and ribbons: makes a grid of the triangles of some places, one each,
    /// with the shading state of their corners, the last of which repeats; of ribbons that at the
    /// place. Samples that are shaded by themselves need no other: this grid's own shading points
    /// would stand for whole faces, or for most of a pixel of hair.
    std::function<Grid(const Grid&, std::span<const GridPlace>)> triangles;
    /// Shading state at the frame time, camera space of the frame time.
    ShadingPositions shading_positions;
    std::vector<Vec3f> p;  ///< [points]; empty when knots == 1 and vertices are points: positions
    std::vector<Vec3f>
        normal;  ///< [points] unit shading normal, outward as modelled (not yet faced forward)
    std::vector<Vec3f> geometric_normal;  ///< [points] unit, of the surface itself
    /// Normals of a mesh that changes its shape; nullptr: they go along with the micropolygons.
    std::shared_ptr<const KnotNormals> knot_normals;
    std::vector<CornerBlend>
        normal_corners;               ///< [points] whose normals are blended; with `knot_normals`
    std::vector<Vec3f> dp_du, dp_dv;  ///< [points] change of P from one point to the next
    std::vector<GridAttribute> attributes;
    /// [points] from p to the hair or sphere that is drawn here as something flat: rays start
    /// outside of it, those of hairs as LitPlace::start_around() says.  Empty: at p.
    std::vector<Vec3f> ray_offset;
    /// [points] from p to the smooth surface that normals of a mesh tell of, on the side that is
    /// seen (geometry/smooth_rise.h).  Empty: the surface has no normals but its own.
    std::vector<Vec3f> rise;
    /// Cosine to its faces below which rays to lamps start there.
    float terminator_offset = 0.0f;
    /// Part of a square pixel that a point stands for, at most 1: how much light it is worth.
    float point_share = 1.0f;
    /// Part of a point's light samples that blur leaves, once it is known; 0 = not yet.
    float sharpness = 0.0f;

    RasterBounds bounds;   ///< swept over shutter and lens
    bool motion = false;   ///< knots differ, or it does not exist throughout
    Lifespan lifespan;     ///< when it exists; less than the shutter only with motion, so that what
                           ///< is always there costs no test
    bool holdout = false;  ///< Scene::holds_out(): hides what is behind, cuts alpha
    std::uint64_t bytes() const;

    // Slots, filled once by shade.
    bool opacity_varies = false;  ///< opacity holds values; otherwise the grid is opaque
    bool additive =
        false;  ///< may have radiance where its opacity is 0: such points are not dropped
    std::vector<Vec3f> opacity;  ///< [vertices]
    std::vector<Vec3f>
        radiance;  ///< [vertices] premultiplied by opacity, plus emission; linear, unclamped

    GridLight found;
    /// Of a shadow catcher, whose radiance is what is left of its light: where nothing is composed
    /// in.
    std::optional<GridLight> found_alone;

    /// [micropolygons] 1 where the corners' radiance or opacity differs so much that samples are to
    /// be shaded by themselves, for which the shading state is kept; empty = nowhere.
    std::vector<std::uint8_t> unsettled;
    /// The same of opacity alone: hiding knows nothing of it there.
    std::vector<std::uint8_t> unsettled_opacity;

    std::vector<float> channels;  ///< [vertices][ChannelSet::vertex_width()]; empty = none asked

    /// Part of the light samples of a point that radiance was made with; 0 = not shaded, or not to
    /// the end.
    float light_fraction = 0.0f;
    /// What its points tell grids around (shade/told_light.h), by what part of their light samples,
    /// and what they were told by these, of a grid that is kept.  nullptr: they tell nothing.
    std::shared_ptr<const ToldLight> told;
    float told_share = 0.0f;
    std::vector<std::shared_ptr<const ToldLight>> told_around;
    /// Something of radiance, or of opacity, was not finite, which is left out and was said.
    bool broken_radiance = false, broken_opacity = false;

    int vertex_count() const { return disjoint ? 4 * n_u : (n_u + 1) * (n_v + 1); }
    int micropolygon_count() const { return n_u * n_v; }
    std::size_t point_count() const {
        return shading_positions.anchors.empty() ? static_cast<std::size_t>(vertex_count())
                                                 : shading_positions.anchors.size();
    }
    /// From corner 0 of a micropolygon to corners 1 and 3; corner 2 is both steps away.
    int right() const { return disjoint ? n_u : 1; }
    int up() const { return disjoint ? 2 * n_u : n_u + 1; }
    /// Whether shading points stand for whole small faces, whose vertices have one colour.
    bool shades_faces() const { return disjoint && shading_positions.faces.empty(); }
    /// Whether shading points are fewer than vertices, each of a cell of several micropolygons.
    bool shades_lattice() const { return !disjoint && !shading_positions.anchors.empty(); }
    /// The shading point of a vertex, of what is no lattice.
    std::size_t point_at(std::size_t vertex) const {
        return shading_positions.point_of.empty() ? vertex : shading_positions.point_of[vertex];
    }
    const std::vector<Vec3f>& shading_p() const { return p.empty() ? positions : p; }
    /// The four vertex indices of a micropolygon.
    struct Corners {
        int v0, v1, v2, v3;
        /// Of a triangle's corner 0, 1 or 2.
        int of(const GridTriangle& triangle, std::size_t corner) const {
            const int first[3] = {v0, v1, v2}, second[3] = {v0, v2, v3};
            return triangle.second ? second[corner] : first[corner];
        }
    };
    Corners corners(int micropolygon) const {
        const int i = micropolygon % n_u, j = micropolygon / n_u;
        const int v0 = j * up() + i;
        return {v0, v0 + right(), v0 + right() + up(), v0 + up()};
    }
    /// The micropolygon whose corner 0 a vertex is.
    int micropolygon_at(int v0) const { return v0 / up() * n_u + v0 % up(); }
};

}  // namespace granita
