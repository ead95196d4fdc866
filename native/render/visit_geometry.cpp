// SPDX-License-Identifier: GPL-3.0-or-later
#include "render/visit_geometry.h"

#include <algorithm>

#include "base/object_pool.h"
#include "base/parallel.h"

namespace granita {
namespace {

enum class Kind { Instance, Face, Node, Local };

/// Something with a bound.  What it points to stays until the bucket ends.
struct Entry {
    Kind kind = Kind::Instance;
    std::uint32_t index = 0;  ///< Instance: instance; Face: primitive
    RasterBounds bounds;
    FrameGeometry::Opened* opened = nullptr;     ///< Face
    GeometryNode* node = nullptr;                ///< Node
    std::unique_ptr<const Primitive> primitive;  ///< Local: wanted by this bucket alone
};

/// An entry that waits for its turn.
struct Turn {
    float nearest_key;
    std::uint32_t order;  ///< of insertion; breaks ties
    std::uint32_t slot;   ///< of the entry

    bool operator<(const Turn& other) const {
        if (nearest_key != other.nearest_key) return nearest_key < other.nearest_key;
        return order > other.order;
    }
};

/// What has become of a face, a node or a primitive of the bucket's own: pieces or a grid.
struct Expansion {
    const GeometryNode::Content* shared = nullptr;  ///< of a node
    std::vector<Entry> pieces;                      ///< of the bucket's own
    std::shared_ptr<SharedGrid> grid;
};

/// Entries are split and diced in waves, so that several threads can: those that follow the nearest
/// one, as many as this part of what the bucket has hidden so far.  A wave is diced before its own
/// grids hide anything, so this part is the most that is diced in vain; and a wave's size depends
/// on nothing but the bucket, so that every run dices the same.
constexpr std::size_t kHiddenAWaveEntry = 32;
constexpr std::size_t kLargestWave = 32;

/// After so many hidden entries it is asked whether all that are left are hidden.
constexpr int kHiddenEntries = 16;

/// What a visit leaves to the next one of its thread, for its memory.
struct Memory {
    std::vector<Turn> heap;
    std::vector<Entry> entries;  ///< [slots]
    std::vector<std::uint32_t> free_slots;
    std::vector<Entry> wave;
    std::vector<Expansion> expanded;  ///< [wave]
    std::vector<std::size_t> unmade;  ///< of the wave
};

class Visit {
  public:
    Visit(Frame& frame, int bucket, const Rect& reach, const Occlusion& occlusion,
          const std::function<void(std::shared_ptr<SharedGrid>)>& hide)
        : m_frame(frame),
          m_bucket(bucket),
          m_place(frame.layout.place(bucket)),
          m_reach(reach),
          m_occlusion(occlusion),
          m_hide(hide) {}
    Visit(const Visit&) = delete;
    Visit& operator=(const Visit&) = delete;
    ~Visit() {
        m_heap.clear();
        m_entries.clear();
        m_free_slots.clear();
        m_memory.wave.clear();
        m_memory.expanded.clear();
        ObjectPool<Memory>::give(std::move(m_memory));
    }

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
            if (nearest().kind == Kind::Instance) {
                const Entry entry = pop();
                if (!is_hidden(entry)) visit_instance(entry.index);
            } else {
                visit_wave();
            }
            leave_if_hidden();
        }
    }

  private:
    void push(Entry entry) {
        if (!touches(entry.bounds)) return;
        Turn turn{entry.bounds.nearest_key, m_order++,
                  static_cast<std::uint32_t>(m_entries.size())};
        if (m_free_slots.empty()) {
            m_entries.push_back(std::move(entry));
        } else {
            turn.slot = m_free_slots.back();
            m_free_slots.pop_back();
            m_entries[turn.slot] = std::move(entry);
        }
        m_heap.push_back(turn);
        std::push_heap(m_heap.begin(), m_heap.end());
    }

    const Entry& nearest() const { return m_entries[m_heap.front().slot]; }

    Entry pop() {
        std::pop_heap(m_heap.begin(), m_heap.end());
        const std::uint32_t slot = m_heap.back().slot;
        m_heap.pop_back();
        m_free_slots.push_back(slot);
        return std::move(m_entries[slot]);
    }

    /// Everything that waits lies behind the nearest of it.
    void leave_if_hidden() {
        if (m_hidden_entries < kHiddenEntries || m_heap.empty()) return;
        m_hidden_entries = 0;
        RasterBounds all;
        all.x0 = static_cast<float>(m_reach.x0), all.x1 = static_cast<float>(m_reach.x1);
        all.y0 = static_cast<float>(m_reach.y0), all.y1 = static_cast<float>(m_reach.y1);
        all.nearest_key = m_heap.front().nearest_key;
        all.visible = true;
        if (!occluded(all)) return;
        m_frame.statistics.add(Counter::PrimitivesCulled, m_heap.size());
        m_heap.clear();
    }

    void visit_wave() {
        const std::size_t size = std::min(1 + m_hidden / kHiddenAWaveEntry, kLargestWave);
        m_memory.wave.clear();
        m_memory.unmade.clear();
        m_memory.expanded.clear();
        while (m_memory.wave.size() < size && !m_heap.empty() && nearest().kind != Kind::Instance) {
            Entry entry = pop();
            if (is_hidden(entry)) continue;
            const bool is_made = entry.kind == Kind::Node && entry.node->is_expanded();
            if (!is_made) m_memory.unmade.push_back(m_memory.wave.size());
            m_memory.expanded.push_back(is_made ? expand(entry) : Expansion{});
            m_memory.wave.push_back(std::move(entry));
        }
        parallel_for(m_memory.unmade.size(), 1, [&](std::size_t begin, std::size_t end) {
            for (std::size_t i = begin; i < end; ++i) {
                m_frame.progress.check();
                m_memory.expanded[m_memory.unmade[i]] = expand(m_memory.wave[m_memory.unmade[i]]);
            }
        });
        for (std::size_t i = 0; i < m_memory.wave.size(); ++i) {
            push_pieces(m_memory.expanded[i]);
            if (m_memory.expanded[i].grid) hide(std::move(m_memory.expanded[i].grid));
        }
    }

    void push_pieces(Expansion& expansion) {
        if (expansion.shared)
            for (const GeometryNode::Child& child : expansion.shared->children)
                if (child.buckets.holds(m_place.x, m_place.y)) {
                    Entry piece;
                    piece.kind = Kind::Node;
                    piece.bounds = child.bounds;
                    piece.node = child.node.get();
                    push(std::move(piece));
                }
        for (Entry& piece : expansion.pieces) push(std::move(piece));
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
        ++m_hidden_entries;
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
        FrameGeometry::Opened* const opened = m_frame.geometry.open(instance);
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
        if (GeometryNode* node = m_frame.geometry.node(*entry.opened, entry.index))
            return expand_node(*node);
        m_frame.statistics.add(Counter::PrimitivesOpened);
        return expand_primitive(*entry.opened->geometry->primitive(entry.index));
    }

    Expansion expand_node(GeometryNode& node) const {
        FrameGeometry& geometry = m_frame.geometry;
        const auto& content = node.expand(m_frame.layout, geometry.ends(), m_frame.statistics);
        return {&content, {}, content.grid};
    }

    Expansion expand_primitive(const Primitive& primitive) const {
        if (primitive.diceable()) return {nullptr, {}, dice_counted(primitive, m_frame.statistics)};
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
    const Vec2i m_place;  ///< in bucket coordinates
    const Rect m_reach;
    const Occlusion& m_occlusion;
    const std::function<void(std::shared_ptr<SharedGrid>)>& m_hide;
    Memory m_memory = ObjectPool<Memory>::take();
    std::vector<Turn>& m_heap = m_memory.heap;
    std::vector<Entry>& m_entries = m_memory.entries;
    std::vector<std::uint32_t>& m_free_slots = m_memory.free_slots;
    std::uint32_t m_order = 0;
    std::size_t m_hidden = 0;  ///< grids
    int m_hidden_entries = 0;  ///< since it was last asked whether all are
};

}  // namespace

void visit_geometry(Frame& frame, int bucket, const Rect& reach, const Occlusion& occlusion,
                    const std::function<void(std::shared_ptr<SharedGrid>)>& hide) {
    Visit(frame, bucket, reach, occlusion, hide).run();
}

}  // namespace granita
