// SPDX-License-Identifier: GPL-3.0-or-later
// A subdivision surface as quads for rays: each face as many cells a side as keep the quads within
// a part of a pixel of its limit, so that rays from the limit start hardly above it.  A face that
// needs one cell takes its corners as all its neighbours have them.
//
// Faces of different numbers of cells meet without gaps: an edge has the points of the coarser
// face, evaluated by its owner, and the finer one's along it are the nearest of them.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "base/progress.h"
#include "geometry/shared_geometry.h"
#include "geometry/subdivision_topology.h"
#include "shade/rays/ray_detail.h"
#include "shade/rays/ray_faces.h"

namespace granita {

class RaySubdivision final : public RayFaces<4> {
  public:
    RaySubdivision(std::shared_ptr<const SharedGeometry> shared, const RayDetail& detail,
                   const Progress& progress);

    std::string size() const override;
    float error(std::uint32_t face) const override;
    void locate(std::uint32_t geometry, std::uint32_t quad, float u, float v,
                RayHit& hit) const override;
    std::size_t bytes() const override;
    /// It had no room for as many cells as `detail` asks for.
    bool is_coarsened() const { return m_coarsened; }
    std::size_t quad_count() const { return m_primitives.indices.size(); }

  private:
    /// A side of a patch along an edge of the cage: its point i is number first + sign * i of the
    /// edge's `whole`, from the lower vertex on, of which the edge has every `step`-th.
    struct PatchSide {
        const SubdivisionTopology::Edge* edge = nullptr;  ///< null: between two sub-faces
        std::size_t index = 0;
        int first = 0, sign = 1, step = 1, whole = 1;
        bool owned = false;  ///< by the patch's face
    };
    template <class Act>
    void parallel_patches(const Progress& progress, Act act) const;
    void find_levels(const RayDetail& detail);
    void find_edge_levels();
    void number_points();
    float place(std::size_t patch);
    float connect(std::size_t patch);
    bool is_quad(std::size_t face) const { return m_shared->data().face_sizes[face] == 4; }
    bool is_one_quad(const BasePatch& patch) const;
    /// log2 of the cells along a side of a patch.
    int patch_level(const BasePatch& patch) const;
    /// 0 bottom, 1 right, 2 top, 3 left.
    PatchSide side(const BasePatch& patch, int number) const;
    std::uint32_t edge_point(const PatchSide& side, int i) const;
    std::uint32_t own_point(std::size_t patch, int i, int j) const;
    std::uint32_t point(std::size_t patch, const PatchSide* sides, int i, int j) const;

    std::vector<std::uint8_t> m_levels;             ///< [F] log2 of the cells along an edge
    std::vector<std::uint8_t> m_edge_levels;        ///< [edges]; empty = all are 0
    std::vector<std::uint32_t> m_first_edge_point;  ///< [edges] of those inside them
    std::vector<std::uint32_t> m_first_point;       ///< [patches] of their own
    std::vector<std::uint32_t> m_first_quad;        ///< [patches + 1]; empty = one quad a patch
    bool m_coarsened = false;
    std::vector<float> m_errors;  ///< [F]
};

}  // namespace granita
