// SPDX-License-Identifier: GPL-3.0-or-later
#include "render/visit_geometry.h"

#include <algorithm>

#include "base/parallel.h"

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

/// What has become of a face, a node or a primitive of the bucket's own: pieces or a grid.
struct Expansion {
    std::vector<Entry> pieces;  ///< with their bounds
    std::shared_ptr<SharedGrid> grid;
};

/// Entries are split and diced in waves, so that several threads can: those that follow the nearest
/// one, as many as this part of what the bucket has hidden so far.  A wave is diced before its own
/// grids hide anything, so this part is the most that is diced in vain; and a wave's size depends
/// on nothing but the bucket, so that every run dices the same.
constexpr std::size_t kHiddenAWaveEntry = 32;
constexpr std::size_t kLargestWave = 32;

class Visit {
  public:
    Visit(Frame& frame, int bucket, const Rect& reach, const Occlusion& occlusion,
          const std::function<void(std::shared_ptr<SharedGrid>)>& hide)
        : m_frame(frame), m_bucket(bucket), m_reach(reach), m_occlusion(occlusion), m_hide(hide) {}

    void run() {
        m_frame.geometry.for_each_instance(m_bucket, [&](std::uint32_t instance) {
            Entry entry;
            entry.kind = Kind::Instance;
            entry.index = instance;
            entry.bounds = m_frame.geometry.bounds(instance);
            push(std::move(entry));
        });
        while (!m_heap.empty()) {
            m_frame.progress.check();
            if (m_heap.front().kind == Kind::Instance) {
                const Entry entry = pop();
                if (!is_hidden(entry)) visit_instance(entry.index);
            } else {
                visit_wave();
            }
        }
    }

  private:
    void push(Entry entry) {
        if (!touches(entry.bounds)) return;
        entry.nearest_key = entry.bounds.nearest_key;
        entry.order = m_order++;
        m_heap.push_back(std::move(entry));
        std::push_heap(m_heap.begin(), m_heap.end());
    }

    Entry pop() {
        std::pop_heap(m_heap.begin(), m_heap.end());
        Entry entry = std::move(m_heap.back());
        m_heap.pop_back();
        return entry;
    }

    void visit_wave() {
        const std::size_t size = std::min(1 + m_hidden / kHiddenAWaveEntry, kLargestWave);
        std::vector<Entry> wave;
        while (wave.size() < size && !m_heap.empty() && m_heap.front().kind != Kind::Instance) {
            Entry entry = pop();
            if (!is_hidden(entry)) wave.push_back(std::move(entry));
        }
        std::vector<Expansion> expanded(wave.size());
        parallel_for(wave.size(), 1, [&](std::size_t begin, std::size_t end) {
            for (std::size_t i = begin; i < end; ++i) {
                m_frame.progress.check();
                expanded[i] = expand(wave[i]);
            }
        });
        for (Expansion& expansion : expanded) {
            for (Entry& piece : expansion.pieces) push(std::move(piece));
            if (expansion.grid) hide(std::move(expansion.grid));
        }
    }

    bool touches(const RasterBounds& b) const {
        return b.visible && b.x0 <= static_cast<float>(m_reach.x1) &&
               b.x1 >= static_cast<float>(m_reach.x0) && b.y0 <= static_cast<float>(m_reach.y1) &&
               b.y1 >= static_cast<float>(m_reach.y0);
    }

    /// By its bounds over the shutter or, where it moves, by those of each part of it.
    bool is_hidden(const Entry& entry) {
        if (!occluded(entry.bounds)) {
            if (!is_hidden_in_time(entry)) return false;
            m_frame.statistics.add(Counter::PrimitivesCulledInTime);
        }
        m_frame.statistics.add(Counter::PrimitivesCulled);
        return true;
    }

    bool is_hidden_in_time(const Entry& entry) const {
        switch (entry.kind) {
            case Kind::Instance:
                return is_hidden_in_time(m_frame.geometry.knot_boxes(entry.index));
            case Kind::Face:
                return is_hidden_in_time(entry.opened->geometry->knot_boxes(entry.index));
            case Kind::Node:
                return is_hidden_in_time(entry.node->knot_boxes());
            case Kind::Local:
                return is_hidden_in_time(entry.primitive->knot_boxes());
        }
        return false;
    }

    bool is_hidden_in_time(std::span<const Bounds3f> boxes) const {
        if (boxes.empty()) return false;
        for (int i = 0; i < slab_count(boxes.size()); ++i) {
            const TimeSlab slab = time_slab(boxes, i, m_frame.view.projection);
            if (slab.bounds.visible && !m_occlusion(slab)) return false;
        }
        return true;
    }

    bool occluded(const RasterBounds& bounds) const {
        return m_occlusion(TimeSlab{0.0f, 1.0f, bounds});
    }

    void visit_instance(std::uint32_t instance) {
        const auto opened = m_frame.geometry.open(instance);
        m_frame.geometry.for_each_face(*opened, m_bucket, [&](std::uint32_t face) {
            Entry entry;
            entry.kind = Kind::Face;
            entry.index = face;
            entry.opened = opened;
            entry.bounds = opened->bounds[face];
            push(std::move(entry));
        });
    }

    /// Thread-safe for different entries.
    Expansion expand(const Entry& entry) const {
        switch (entry.kind) {
            case Kind::Instance:
                break;
            case Kind::Face:
                return expand_face(entry);
            case Kind::Node:
                return expand_node(*entry.node);
            case Kind::Local:
                return expand_primitive(*entry.primitive);
        }
        return {};
    }

    Expansion expand_face(const Entry& entry) const {
        if (auto node = m_frame.geometry.node(*entry.opened, entry.index))
            return expand_node(*node);
        m_frame.statistics.add(Counter::PrimitivesOpened);
        return expand_primitive(*entry.opened->geometry->primitive(entry.index));
    }

    Expansion expand_node(GeometryNode& node) const {
        auto content = node.expand(m_frame.layout, m_frame.statistics);
        Expansion out{{}, std::move(content.grid)};
        for (auto& child : content.children) {
            Entry& piece = out.pieces.emplace_back();
            piece.kind = Kind::Node;
            piece.bounds = child->bounds();
            piece.node = std::move(child);
        }
        return out;
    }

    Expansion expand_primitive(const Primitive& primitive) const {
        if (primitive.diceable()) return {{}, dice_counted(primitive, m_frame.statistics)};
        Expansion out;
        for (auto& child : split_counted(primitive, m_frame.statistics)) {
            Entry& piece = out.pieces.emplace_back();
            piece.kind = Kind::Local;
            piece.bounds = child->bounds();
            piece.primitive = std::move(child);
        }
        return out;
    }

    void hide(std::shared_ptr<SharedGrid> grid) {
        if (!touches(grid->grid().bounds)) return;
        if (occluded(grid->grid().bounds)) {
            m_frame.statistics.add(Counter::GridsCulled);
            return;
        }
        ++m_hidden;
        m_hide(std::move(grid));
    }

    Frame& m_frame;
    const int m_bucket;
    const Rect m_reach;
    const Occlusion& m_occlusion;
    const std::function<void(std::shared_ptr<SharedGrid>)>& m_hide;
    std::vector<Entry> m_heap;
    std::uint64_t m_order = 0;
    std::size_t m_hidden = 0;  ///< grids
};

}  // namespace

void visit_geometry(Frame& frame, int bucket, const Rect& reach, const Occlusion& occlusion,
                    const std::function<void(std::shared_ptr<SharedGrid>)>& hide) {
    Visit(frame, bucket, reach, occlusion, hide).run();
}

}  // namespace granita
