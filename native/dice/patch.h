// SPDX-License-Identifier: GPL-3.0-or-later
// A primitive: four corners in a base patch's (u, v) and the four sides between them.
//
// A patch is split between the middles of two opposite sides.  Where one of them is not to be
// bisected (its neighbour would not have that vertex), the split line ends in its corner instead
// and one child is a triangle: a side collapsed to a point.  No vertex ever lies on a side that
// does not have it, and whatever is too large can be split as long as any side has a vertex inside
// (Fisher et al. 2009).
#pragma once

#include <memory>

#include "dice/opened_mesh.h"

namespace granita {

/// An edge of 1e5 m may end in pieces of 3 mm: two pixels at the feet of a camera at eye height.  A
/// path of 64 bits holds two such budgets and the sub-faces of a face of 4,000 corners; beyond that
/// the face gets fewer levels.
inline constexpr int kMostEdgeLevels = 25;

/// [knots] of the part of a base patch inside four corners, displacement included.
std::vector<Bounds3f> patch_boxes(const OpenedMesh& mesh, const BasePatch& patch,
                                  const Vec2d* corner_uv);

class Patch final : public Primitive {
  public:
    /// A bent pair splits into its triangles at once.
    static std::unique_ptr<Patch> open(std::shared_ptr<const OpenedMesh> mesh,
                                       const BasePatch& patch);

    RasterBounds bounds() const override;
    std::vector<Bounds3f> knot_boxes() const override;
    GridKey key() const override;
    bool diceable() const override;
    std::vector<std::unique_ptr<Primitive>> split() const override;
    std::unique_ptr<Grid> dice() const override;

  private:
    enum { kBottom, kRight, kTop, kLeft };
    /// log2 of the micropolygons along u and v.
    struct Rates {
        int u = 0, v = 0;
    };

    Patch(std::shared_ptr<const OpenedMesh> mesh, const BasePatch& patch);
    void measure();
    void find_rates();
    /// 0 to 2: bottom, right, left; whether it is to be halved first.
    struct Base {
        int side = 0;
        bool halved = false;
    };
    Base best_base() const;
    void turn(int base);
    void measure_inside(const EdgeWalker& walk, int most);
    /// 0 not at all, 1 into a triangle and a rest, 2 in the middle.
    int splittable(bool along_u) const;
    /// Where a split line ends on a side: its middle, or the corner that stands in for it.
    struct Cut {
        Vec2d uv{0.0};
        EdgePoint point;
        PatchEdge halves[2];
    };
    Cut cut(int side, bool collapsed_before, int before, int after) const;

    std::shared_ptr<const OpenedMesh> m_mesh;
    BasePatch m_patch;
    std::uint64_t m_path = 1;
    Vec2d m_corner_uv[4];
    PatchEdge m_sides[4];
    int m_budget_u = 0, m_budget_v = 0;
    Rates m_border;  ///< what the sides need
    Rates m_rates;   ///< what is diced: the sides, and the surface between them
    bool m_diceable = false, m_split_u = false;
};

}  // namespace granita
