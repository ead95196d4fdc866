// SPDX-License-Identifier: GPL-3.0-or-later
#include "render/neighbour_grids.h"

#include <algorithm>
#include <cmath>

#include "base/parallel.h"
#include "shade/bounces/neighbours.h"

namespace granita {
namespace {

class Search {
  public:
    Search(Frame& frame, int bucket, SharedGrid& grid)
        : m_frame(frame),
          m_bucket(bucket),
          m_at(frame.layout.place(bucket)),
          m_grid(grid.grid()),
          m_margin(static_cast<float>(neighbour_margin(frame.scene.options))),
          m_place(grid.place(frame.statistics)) {}

    HiddenGrids run() {
        FrameGeometry& geometry = m_frame.geometry;
        FrameGeometry::Opened& opened = *geometry.open(m_grid.instance);
        geometry.for_each_face(opened, m_bucket, [&](std::uint32_t face) {
            if (is_beside(opened.bounds[face])) visit(*geometry.node(opened, face));
        });
        std::ranges::sort(m_found, {}, [](const auto& grid) { return grid->grid().key; });
        return std::move(m_found);
    }

  private:
    /// Whether all buckets that see the grid find it.
    bool is_beside(const RasterBounds& b) const {
        const RasterBounds& own = m_grid.bounds;
        return b.visible && b.x0 - m_margin <= own.x0 && b.x1 + m_margin >= own.x1 &&
               b.y0 - m_margin <= own.y0 && b.y1 + m_margin >= own.y1;
    }

    void visit(GeometryNode& node) {
        const GeometryNode::Content& content =
            node.expand(m_frame.layout, m_frame.geometry.ends(), m_frame.statistics);
        for (const GeometryNode::Child& child : content.children)
            if (child.buckets.holds(m_at.x, m_at.y) && is_beside(child.bounds)) visit(*child.node);
        if (content.grid) consider(content.grid);
    }

    void consider(const std::shared_ptr<SharedGrid>& other) {
        const Grid& grid = other->grid();
        if (grid.key == m_grid.key || grid.material != m_grid.material) return;
        const ShadingSystem& shading = m_frame.shading;
        // Which small faces are left to samples goes by opacity, whoever has asked for that so far.
        if (grid.triangles && shading.opacity_varies(grid.material))
            other->ensure_opacity(shading, m_frame.statistics);
        // Those have no place once their state is dropped.
        if (shading.leaves_to_samples(grid)) return;
        if (m_place.is_within(static_cast<float>(kNeighbourReach) * m_place.step,
                              other->place(m_frame.statistics)))
            m_found.push_back(other);
    }

    Frame& m_frame;
    const int m_bucket;
    const Vec2i m_at;
    const Grid& m_grid;
    const float m_margin;
    const SharedGrid::Place& m_place;
    HiddenGrids m_found;
};

}  // namespace

int neighbour_margin(const Options& options) {
    const float side = std::sqrt(static_cast<float>(options.grid_size)) * options.dicing_rate;
    return static_cast<int>(std::ceil(2.0f * side));
}

HiddenGrids neighbours_of(Frame& frame, int bucket, SharedGrid& grid) {
    return Search(frame, bucket, grid).run();
}

std::vector<HiddenGrids> all_neighbours(Frame& frame, int bucket, const HiddenGrids& grids,
                                        const std::vector<bool>& seen) {
    std::vector<HiddenGrids> around;
    if (!frame.shading.shares_light()) return around;
    around.resize(grids.size());
    parallel_for(grids.size(), 1, [&](std::size_t begin, std::size_t end) {
        for (std::size_t slot = begin; slot < end; ++slot) {
            frame.progress.check();
            if (seen[slot] && !frame.shading.leaves_to_samples(grids[slot]->grid()))
                around[slot] = neighbours_of(frame, bucket, *grids[slot]);
        }
    });
    return around;
}

}  // namespace granita
