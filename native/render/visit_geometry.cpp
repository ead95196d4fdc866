// SPDX-License-Identifier: GPL-3.0-or-later
#include "render/visit_geometry.h"

#include <algorithm>
#include <queue>

namespace granita {
namespace {

enum class Kind { Instance, Face, Node, Local };

/// Something with a bound, waiting for its turn.
struct Entry {
    float nearest_key = 0;
    std::uint64_t order = 0;  ///< of insertion; breaks ties
    Kind kind = Kind::Instance;
    std::uint32_t index = 0;                        ///< Instance: instance; Face: primitive
    std::shared_ptr<FrameGeometry::Opened> opened;  ///< Face
    std::shared_ptr<GeometryNode> node;             ///< Node
    std::shared_ptr<Primitive> primitive;           ///< Local: wanted by this bucket alone
    RasterBounds bounds;

    bool operator<(const Entry& other) const {
        if (nearest_key != other.nearest_key) return nearest_key < other.nearest_key;
        return order > other.order;
    }
};

class Visit {
  public:
    Visit(Frame& frame, int bucket, const Occlusion& occlusion,
          const std::function<void(std::shared_ptr<SharedGrid>)>& hide)
        : m_frame(frame),
          m_bucket(bucket),
          m_reach(frame.layout.reach(bucket)),
          m_occlusion(occlusion),
          m_hide(hide) {}

    void run() {
        for (const std::uint32_t instance : m_frame.geometry.instances(m_bucket)) {
            Entry entry;
            entry.kind = Kind::Instance;
            entry.index = instance;
            push(std::move(entry), m_frame.geometry.bounds(instance));
        }
        while (!m_heap.empty()) {
            m_frame.progress.check();
            std::pop_heap(m_heap.begin(), m_heap.end());
            const Entry entry = std::move(m_heap.back());
            m_heap.pop_back();
            if (!is_hidden(entry)) visit(entry);
        }
    }

  private:
    void push(Entry entry, const RasterBounds& bounds) {
        if (!touches(bounds)) return;
        entry.bounds = bounds;
        entry.nearest_key = bounds.nearest_key;
        entry.order = m_order++;
        m_heap.push_back(std::move(entry));
        std::push_heap(m_heap.begin(), m_heap.end());
    }

    bool touches(const RasterBounds& b) const {
        return b.visible && b.x0 <= static_cast<float>(m_reach.x1) &&
               b.x1 >= static_cast<float>(m_reach.x0) && b.y0 <= static_cast<float>(m_reach.y1) &&
               b.y1 >= static_cast<float>(m_reach.y0);
    }

    /// By its bounds over the shutter or, where it moves, by those of each part of it.
    bool is_hidden(const Entry& entry) {
        if (occluded(entry.bounds)) {
            m_frame.statistics.add(Counter::PrimitivesCulled);
            return true;
        }
        const std::vector<Bounds3f> boxes = knot_boxes(entry);
        if (boxes.empty()) return false;
        for (int i = 0; i < slab_count(boxes.size()); ++i) {
            const TimeSlab slab = time_slab(boxes, i, m_frame.view.projection);
            if (slab.bounds.visible && !m_occlusion(slab)) return false;
        }
        m_frame.statistics.add(Counter::PrimitivesCulled);
        m_frame.statistics.add(Counter::PrimitivesCulledInTime);
        return true;
    }

    bool occluded(const RasterBounds& bounds) const {
        return m_occlusion(TimeSlab{0.0f, 1.0f, bounds});
    }

    std::vector<Bounds3f> knot_boxes(const Entry& entry) const {
        switch (entry.kind) {
            case Kind::Instance: {
                const auto boxes = m_frame.geometry.knot_boxes(entry.index);
                return {boxes.begin(), boxes.end()};
            }
            case Kind::Face:
                return entry.opened->geometry->knot_boxes(entry.index);
            case Kind::Node:
                return entry.node->knot_boxes();
            case Kind::Local:
                return entry.primitive->knot_boxes();
        }
        return {};
    }

    void visit(const Entry& entry) {
        switch (entry.kind) {
            case Kind::Instance:
                return visit_instance(entry.index);
            case Kind::Face:
                return visit_face(entry);
            case Kind::Node:
                return visit_node(*entry.node);
            case Kind::Local:
                return visit_primitive(*entry.primitive);
        }
    }

    void visit_instance(std::uint32_t instance) {
        const auto opened = m_frame.geometry.open(instance);
        for (const std::uint32_t face : m_frame.geometry.faces(*opened, m_bucket)) {
            Entry entry;
            entry.kind = Kind::Face;
            entry.index = face;
            entry.opened = opened;
            push(std::move(entry), opened->bounds[face]);
        }
    }

    void visit_face(const Entry& entry) {
        if (auto node = m_frame.geometry.node(*entry.opened, entry.index)) return visit_node(*node);
        m_frame.statistics.add(Counter::PrimitivesOpened);
        visit_primitive(*entry.opened->geometry->primitive(entry.index));
    }

    void visit_node(GeometryNode& node) {
        auto content = node.expand(m_frame.layout, m_frame.statistics);
        for (auto& child : content.children) {
            const RasterBounds bounds = child->bounds();
            Entry entry;
            entry.kind = Kind::Node;
            entry.node = std::move(child);
            push(std::move(entry), bounds);
        }
        if (content.grid) hide(std::move(content.grid));
    }

    void visit_primitive(const Primitive& primitive) {
        if (primitive.diceable()) {
            if (auto grid = dice_counted(primitive, m_frame.statistics)) hide(std::move(grid));
            return;
        }
        for (auto& child : split_counted(primitive, m_frame.statistics)) {
            const RasterBounds bounds = child->bounds();
            Entry entry;
            entry.kind = Kind::Local;
            entry.primitive = std::move(child);
            push(std::move(entry), bounds);
        }
    }

    void hide(std::shared_ptr<SharedGrid> grid) {
        if (!touches(grid->grid().bounds)) return;
        if (occluded(grid->grid().bounds)) {
            m_frame.statistics.add(Counter::GridsCulled);
            return;
        }
        m_hide(std::move(grid));
    }

    Frame& m_frame;
    const int m_bucket;
    const Rect m_reach;
    const Occlusion& m_occlusion;
    const std::function<void(std::shared_ptr<SharedGrid>)>& m_hide;
    std::vector<Entry> m_heap;
    std::uint64_t m_order = 0;
};

}  // namespace

void visit_geometry(Frame& frame, int bucket, const Occlusion& occlusion,
                    const std::function<void(std::shared_ptr<SharedGrid>)>& hide) {
    Visit(frame, bucket, occlusion, hide).run();
}

}  // namespace granita
