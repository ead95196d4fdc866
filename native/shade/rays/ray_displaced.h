// SPDX-License-Identifier: GPL-3.0-or-later
// A displaced mesh as quads for rays: points of the same surface that is diced, at a rate of its
// own.  Borders have the points of the coarser neighbour, each where its owner puts it: no ray
// passes between two patches.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "base/progress.h"
#include "geometry/displacement.h"
#include "geometry/patch_borders.h"
#include "shade/rays/ray_detail.h"
#include "shade/rays/ray_faces.h"

namespace granita {

class RayDisplaced final : public RayFaces<4> {
  public:
    /// `instance`: whose displacement it is.  Throws Cancelled.
    RayDisplaced(std::shared_ptr<const SharedGeometry> shared, const Displacement& displacement,
                 std::size_t instance, const RayDetail& detail, const Progress& progress);

    /// It was to be finer than memory allows.
    bool is_coarsened() const { return m_coarsened; }
    std::string size() const override;
    /// Not known: rays start where RayScene::heights_over() says.
    float error(std::uint32_t) const override { return 0.0f; }
    void locate(std::uint32_t geometry, std::uint32_t quad, float u, float v,
                RayHit& hit) const override;
    std::size_t bytes() const override;

  private:
    /// log2 of the cells along u and v, alike in a triangular patch.
    struct Levels {
        std::uint8_t u = 0, v = 0;
        bool are_none() const { return u + v == 0; }
        /// Of a side of the patch.
        int along(int side) const { return side % 2 == 0 ? u : v; }
    };
    void find_levels(const RayDetail& detail);
    void coarsen();
    void find_edge_levels();
    void number();
    void add_places(std::size_t patch, std::vector<SurfacePlace>& places) const;
    void place_vertices(const Displacement& displacement, std::size_t instance,
                        const Progress& progress);
    template <class Point>
    void place(std::span<const SurfacePlace> places, const Point& point,
               const Displacement& displacement, std::size_t instance);
    void make_quads(std::size_t patch);
    /// Its points are its corners, which are points of all such patches around.
    bool is_of_vertices(std::size_t patch) const;
    std::uint32_t vertex_of(std::uint32_t corner) const {
        return static_cast<std::uint32_t>(m_shared->data().corner_verts[corner]);
    }
    /// Of its own.
    std::size_t point_count(std::size_t patch) const;
    std::size_t quad_count(std::size_t patch) const;
    /// Of the whole edge, for a side of a patch with `level`.
    int edge_level(const PatchBorders::Side& side, int level) const;
    SurfacePlace border_place(const PatchBorders::Side& side, int i, int cells) const;

    const PatchBorders& m_borders;
    std::vector<Levels> m_levels;              ///< [patches]
    std::vector<std::uint8_t> m_edge_levels;   ///< [edges]
    std::vector<std::uint32_t> m_first_point;  ///< [patches] those of vertices go before
    std::vector<std::uint32_t> m_first_quad;   ///< [patches + 1]
    bool m_coarsened = false;
};

}  // namespace granita
