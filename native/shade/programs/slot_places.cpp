// SPDX-License-Identifier: GPL-3.0-or-later
#include "shade/programs/slot_places.h"

#include <map>

namespace granita {
namespace {

/// Gives out places, those that were given back first.
class Places {
  public:
    explicit Places(SlotPlaces& out) : m_out(out) {}

    void take(int slot, int width) {
        int& first = m_out.first[static_cast<std::size_t>(slot)];
        if (first >= 0) return;  // written by several steps
        std::vector<int>& free = m_free[width];
        if (free.empty()) {
            first = m_out.floats_a_point;
            m_out.floats_a_point += width;
        } else {
            first = free.back();
            free.pop_back();
        }
    }
    void give_back(int slot, int width) {
        m_free[width].push_back(m_out.first[static_cast<std::size_t>(slot)]);
    }

  private:
    SlotPlaces& m_out;
    std::map<int, std::vector<int>> m_free;  ///< [width] places
};

/// The last step that has each slot; [slots].
std::vector<std::size_t> last_uses(std::size_t slot_count, std::span<const SlotUse> uses,
                                   std::span<const int> roots) {
    std::vector<std::size_t> last(slot_count, 0);
    for (std::size_t step = 0; step < uses.size(); ++step)
        for (const std::span<const int> slots : {uses[step].reads, uses[step].writes})
            for (const int slot : slots)
                if (slot >= 0) last[static_cast<std::size_t>(slot)] = step;
    for (const int root : roots)
        if (root >= 0) last[static_cast<std::size_t>(root)] = uses.size();
    return last;
}

}  // namespace

SlotPlaces place_slots(std::span<const int> widths, std::span<const int> written_first,
                       std::span<const SlotUse> uses, std::span<const int> roots) {
    SlotPlaces out{std::vector<int>(widths.size(), -1), 0};
    Places places(out);
    const auto width = [&](int slot) { return widths[static_cast<std::size_t>(slot)]; };
    for (const int slot : written_first) places.take(slot, width(slot));
    const std::vector<std::size_t> last = last_uses(widths.size(), uses, roots);
    std::vector<bool> is_given_back(widths.size());
    for (std::size_t step = 0; step < uses.size(); ++step) {
        // Before what is read is given back: a step may write while it still reads.
        for (const int slot : uses[step].writes) places.take(slot, width(slot));
        for (const std::span<const int> slots : {uses[step].reads, uses[step].writes})
            for (const int slot : slots) {
                const auto s = static_cast<std::size_t>(slot);
                if (slot < 0 || last[s] != step || is_given_back[s]) continue;
                is_given_back[s] = true;
                places.give_back(slot, width(slot));
            }
    }
    return out;
}

}  // namespace granita
