// SPDX-License-Identifier: GPL-3.0-or-later
// Which geometry each bucket has to look at.  Instances are opened (transformed, their faces
// binned) when the first bucket cannot rule them out, and closed after the last bucket that they
// can touch.
#pragma once

#include <atomic>
#include <memory>
#include <mutex>
#include <span>
#include <vector>

#include "base/parallel.h"
#include "base/report.h"
#include "dice/open_instance.h"
#include "render/geometry_node.h"
#include "render/hierarchical_grid.h"

namespace granita {

class FrameGeometry {
  public:
    /// What there is to say of geometries goes to `report`, of opened instances to `said`.
    /// `revisited`: buckets look at parts of themselves again, or around their things, and find
    /// what they have diced.
    FrameGeometry(const View& view, const BucketLayout& layout, Report& report, Report& said,
                  bool revisited = false);

    /// visit(instance) for those whose bound touches the bucket.
    template <class Visit>
    void for_each_instance(int bucket, Visit visit) const {
        const Vec2i at = m_layout.place(bucket);
        m_instances.for_each(at.x, at.y, [&](std::uint32_t i) {
            if (m_states[i].buckets.holds(at.x, at.y)) visit(i);
        });
    }
    const RasterBounds& bounds(std::uint32_t instance) const { return m_states[instance].bounds; }
    /// [knots] in camera space; empty where it stands still.
    std::span<const Bounds3f> knot_boxes(std::uint32_t instance) const {
        return m_states[instance].boxes;
    }

    /// An opened instance with its faces binned.
    struct Opened {
        std::shared_ptr<const OpenedInstance> geometry;
        std::vector<RasterBounds> bounds;  ///< [primitives]
        HierarchicalGrid faces;            ///< primitives
        std::mutex mutex;                  ///< of `nodes`
        std::vector<std::shared_ptr<GeometryNode>>
            nodes;  ///< [primitives], of those that are wanted more than once
    };
    /// For a bucket that the instance touches, until its release().  Buckets that ask while it is
    /// being opened take a share of that.
    Opened* open(std::uint32_t instance);
    /// visit(primitive) for those of an opened instance that touch the bucket.
    template <class Visit>
    void for_each_face(const Opened& opened, int bucket, Visit visit) const {
        const Vec2i at = m_layout.place(bucket);
        opened.faces.for_each(at.x, at.y, [&](std::uint32_t face) {
            if (m_layout.range(opened.bounds[face]).holds(at.x, at.y)) visit(face);
        });
    }
    /// The node of a primitive that is wanted more than once; nullptr if it is not.
    GeometryNode* node(Opened& opened, std::uint32_t primitive);
    BucketEnds& ends() { return m_ends; }
    /// The bucket is done: releases everything that only it was still waiting for.
    void release(int bucket);

    /// Calls visit(instance) for those that were opened.
    template <class Visit>
    void for_each_opened(Visit visit) const {
        for (std::size_t i = 0; i < m_states.size(); ++i)
            if (m_states[i].is_open) visit(static_cast<std::uint32_t>(i));
    }

    const BucketLayout& layout() const { return m_layout; }
    /// As HierarchicalGrid::entries(), of instances.
    std::size_t list_entries() const { return m_instances.entries(); }

  private:
    struct State {
        RasterBounds bounds;
        Rect buckets;  ///< that it touches, bucket coordinates
        std::vector<Bounds3f> boxes;
        SharedOnce once;
        std::atomic<bool> is_open{false};
        std::atomic<int> buckets_left{0};
        std::unique_ptr<Opened> opened;
    };
    std::unique_ptr<Opened> make_opened(std::uint32_t instance) const;

    const View& m_view;
    const BucketLayout& m_layout;
    Report &m_report, &m_said;
    const bool m_revisited;
    std::vector<State> m_states;
    HierarchicalGrid m_instances;
    BucketEnds m_ends;
};

}  // namespace granita
