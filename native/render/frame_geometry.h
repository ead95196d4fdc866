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

#include "base/report.h"
#include "dice/open_instance.h"
#include "render/geometry_node.h"

namespace granita {

class FrameGeometry {
  public:
    FrameGeometry(const View& view, const BucketLayout& layout, Report& report);

    /// Instances whose bound touches the bucket.
    const std::vector<std::uint32_t>& instances(int bucket) const { return m_buckets[bucket]; }
    const RasterBounds& bounds(std::uint32_t instance) const { return m_states[instance].bounds; }
    /// [knots] in camera space; empty where it stands still.
    std::span<const Bounds3f> knot_boxes(std::uint32_t instance) const {
        return m_states[instance].boxes;
    }

    /// An opened instance with its faces binned.
    struct Opened {
        std::shared_ptr<const OpenedInstance> geometry;
        std::vector<RasterBounds> bounds;  ///< [primitives]
        Rect buckets;                      ///< bucket coordinates
        std::vector<std::uint32_t> first;  ///< [buckets + 1] into `faces`
        std::vector<std::uint32_t> faces;  ///< primitives by bucket, ascending in each
        std::mutex mutex;                  ///< of `nodes`
        std::vector<std::shared_ptr<GeometryNode>>
            nodes;  ///< [primitives], of those in several buckets
    };
    std::shared_ptr<Opened> open(std::uint32_t instance);
    /// The primitives of an opened instance that touch the bucket.
    std::span<const std::uint32_t> faces(const Opened& opened, int bucket) const;
    /// The node of a primitive that several buckets want; nullptr if only one does.
    std::shared_ptr<GeometryNode> node(Opened& opened, std::uint32_t primitive);
    /// The bucket is done: releases everything that only it was still waiting for.
    void release(int bucket);

    const BucketLayout& layout() const { return m_layout; }

  private:
    struct State {
        RasterBounds bounds;
        std::vector<Bounds3f> boxes;
        std::mutex mutex;
        std::shared_ptr<Opened> opened;
        std::atomic<int> buckets_left{0};
    };
    std::shared_ptr<Opened> make_opened(std::uint32_t instance);

    const View& m_view;
    const BucketLayout& m_layout;
    Report& m_report;
    std::vector<State> m_states;
    std::vector<std::vector<std::uint32_t>> m_buckets;  ///< instances by bucket
    std::vector<std::atomic<bool>> m_finished;          ///< [buckets]
};

}  // namespace granita
