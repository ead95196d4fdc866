// SPDX-License-Identifier: GPL-3.0-or-later
// A side of a patch: a node of the binary tree over an edge (edge_rate.h).
//
// The edge is a base edge of the mesh, shared by its faces, or a line that a split drew, shared by
// the two children.  Every point of it is evaluated in the edge's own direction and by its owner,
// whoever asks: both neighbours get the same bits, at every knot, displaced or not (decision 10).
#pragma once

#include <cstdint>
#include <limits>
#include <memory>
#include <vector>

#include "dice/knots.h"
#include "geometry/surface_place.h"
#include "math/vec.h"

namespace granita {

class OpenedMesh;
struct BasePatch;

/// A point of an edge at every knot, camera space, not displaced.
struct EdgePoint {
    Vec3f p[kMaxKnots];
    SurfacePlace place;  ///< as of OpenedMesh::edge_place(); EdgeWalker::point() fills it
};

/// A base edge as its mesh numbers it.
struct EdgeRef {
    std::uint32_t a = 0, b = 0;
};

/// A line inside a patch, straight in (u, v).
struct Line {
    Vec2d uv0{0.0}, uv1{0.0};
    /// Start then end, [2][knots]: copied from the edges that the line meets there.
    std::vector<Vec3f> p;
    SurfacePlace place[2];  ///< of start and end, as EdgePoint's
};

struct PatchEdge {
    EdgeRef edge;                      ///< where `line` is null
    std::shared_ptr<const Line> line;  ///< or else this
    std::uint32_t index = 0;           ///< node: covers [index, index + 1] / 2^depth of the edge
    std::uint8_t depth = 0;
    std::uint8_t budget = 0;  ///< levels that may still follow
    std::int8_t levels = 0;   ///< of the tree below: uniform, or EdgeRate::kAdaptive
    std::int8_t rough = -1;   ///< of the edge, of these levels by roughness; -1: not known
    bool reversed = false;    ///< the patch's direction is against the edge's
    bool collapsed = false;   ///< no edge at all: one point, its neighbours know which
    /// Counts as no farther outside the frame than this, pixels: lines that stand for a surface.
    float most_outside = std::numeric_limits<float>::infinity();

    bool refined() const { return levels != 0; }
};

/// The sides of a patch from those around a triangle, each of which leaves its corner: `base` is
/// the bottom, the top its apex.
void set_triangle_sides(const PatchEdge* around, int base, PatchEdge* sides);

/// Sides seen from a patch; `at` runs in the patch's direction.
class EdgeWalker {
  public:
    EdgeWalker(const OpenedMesh& mesh, const BasePatch& patch) : m_mesh(mesh), m_patch(patch) {}

    void point(const PatchEdge& side, double at, EdgePoint& out) const;
    /// Fills `levels` from the edge's data.
    void classify(PatchEdge& side) const;
    /// `half` 0 or 1 of a refined side.
    PatchEdge half(const PatchEdge& side, int half) const;
    /// Levels of the tree; anything above `cap` is cap + 1.
    int depth(const PatchEdge& side, int cap) const;
    /// Appends where the leaves end, in units of 1 / steps of the side (steps = 2^n, n at least the
    /// depth): `first` < ... <= first + steps.
    void leaf_ends(const PatchEdge& side, int first, int steps, std::vector<int>& ends) const;
    /// The line between two points, classified.
    PatchEdge draw(const Vec2d& uv0, const Vec2d& uv1, const EdgePoint& start, const EdgePoint& end,
                   int budget, float most_outside = std::numeric_limits<float>::infinity()) const;

  private:
    int levels(const PatchEdge& side) const;
    int rough_levels(const PatchEdge& side) const;
    void edge_point(const PatchEdge& side, double t, EdgePoint& out) const;
    SurfacePlace edge_place(const PatchEdge& side, double t) const;

    const OpenedMesh& m_mesh;
    const BasePatch& m_patch;
};

}  // namespace granita
