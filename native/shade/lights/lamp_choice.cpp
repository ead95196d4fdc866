// SPDX-License-Identifier: GPL-3.0-or-later
#include "shade/lights/lamp_choice.h"

#include <algorithm>
#include <bit>
#include <cmath>

namespace granita {
namespace {

/// Where a few lamps give most, the rest's own sum is in doubt by no more than this part less: it
/// may be all that is left, where the few are shadowed.
constexpr float kLeastOfRest = 0.25f;
constexpr int kMostOpened = 512;
/// Samples of a soft lamp for each time that it would be asked; of a mesh's face one.
constexpr float kSamplesPerRate = 4.0f;

}  // namespace

float LampChoice::importances(std::uint32_t node, float (&of_child)[LightTree::kWidth]) const {
    ++m_nodes_seen;
    return m_tree.importances(node, m_receiver, m_receives, of_child);
}

/// Puts a node's children where `link` points.
void LampChoice::expand(std::uint32_t node, std::uint32_t* link) {
    float importance[LightTree::kWidth];
    importances(node, importance);
    std::uint32_t next = *link;
    for (std::uint32_t i = LightTree::kWidth; i-- > 0;) {
        if (importance[i] == 0.0f) continue;
        const Slot slot = node * LightTree::kWidth + i;
        const auto entry = static_cast<std::uint32_t>(m_entries.size());
        m_entries.push_back({slot, next, importance[i]});
        next = entry;
        m_total += importance[i];
        if (m_tree.is_lamp(slot)) continue;
        m_open.push_back(entry);
        std::ranges::push_heap(m_open, {},
                               [this](std::uint32_t e) { return m_entries[e].importance; });
    }
    *link = next;
}

void LampChoice::aim(const LightReceiver& receiver, int samples, float asked, float parts) {
    m_receiver = receiver.view();
    m_receives = receiver.receives();
    m_samples = samples;
    m_entries.clear();
    m_open.clear();
    m_total = 0.0f;
    m_first = kEnd;
    m_opened = 0;
    expand(0, &m_first);
    open([this, parts] { return m_total / parts; });
    // Where few lamps give most, the rest is asked more often than their share of all.
    const float once = importance_of_one(asked);
    open([once, part = asked / parts] { return once * part; });
    sort_out(importance_of_one(asked));
}

/// Opens nodes that may give more than `least()`.
template <class Least>
void LampChoice::open(const Least& least) {
    while (!m_open.empty() && m_opened < kMostOpened) {
        const std::uint32_t entry = m_open.front();
        Entry& top = m_entries[entry];
        if (top.importance <= least()) return;
        std::ranges::pop_heap(m_open, {},
                              [this](std::uint32_t e) { return m_entries[e].importance; });
        m_open.pop_back();
        ++m_opened;
        // Its children follow it in the list; itself it gives nothing more.
        m_total -= top.importance;
        top.importance = 0.0f;
        std::uint32_t next = top.next;
        expand(m_tree.node(top.slot), &next);  // moves the entries
        m_entries[entry].next = next;
    }
}

/// What is asked once may give.  The variance of lamps asked by chance is at most this times their
/// sum: so much that it is 1 / asked of the square of all light.
float LampChoice::importance_of_one(float asked) {
    m_total = 0.0f;
    for (const Entry& entry : m_entries) m_total += entry.importance;
    float once = m_total / asked, rest = m_total;
    for (int step = 0; step < 4 && rest > 0.0f; ++step) {
        const float part = rest / m_total;
        once = rest / (asked * std::max(kLeastOfRest, part * part));
        rest = 0.0f;
        for (const Entry& entry : m_entries)
            if (entry.importance < once || !m_tree.is_lamp(entry.slot)) rest += entry.importance;
    }
    return std::max(once, 1e-30f);
}

void LampChoice::sort_out(float once) {
    m_always.clear();
    m_chances.clear();
    double sum = 0.0;
    for (std::uint32_t at = m_first; at != kEnd; at = m_entries[at].next) {
        const Entry& entry = m_entries[at];
        if (entry.importance == 0.0f) continue;
        const float rate = entry.importance / once;
        if (rate >= 1.0f && m_tree.is_lamp(entry.slot)) {
            const std::uint32_t lamp = m_tree.lamp(entry.slot);
            m_always.push_back({lamp, {1.0f, samples_at(lamp, rate)}, false});
        } else {
            sum += static_cast<double>(rate);
            m_chances.push_back({entry.slot, rate, sum});
        }
    }
}

int LampChoice::samples_at(std::uint32_t lamp, float rate) const {
    // Rounded differently on two ways, the same rate has as many samples.
    constexpr float kRounding = 1.0f - 1e-5f;
    const float wanted =
        std::min((m_tree.is_face(lamp) ? 1.0f : kSamplesPerRate) * kRounding * rate,
                 static_cast<float>(m_samples));
    const auto whole = static_cast<std::uint32_t>(std::ceil(wanted));
    return std::min(m_samples, static_cast<int>(std::bit_ceil(std::max(1u, whole))));
}

void LampChoice::choose(float u, std::vector<ChosenLamp>& chosen) const {
    chosen.insert(chosen.end(), m_always.begin(), m_always.end());
    auto chance = m_chances.begin();
    for (double next = u;; next += 1.0) {
        chance = std::upper_bound(chance, m_chances.end(), next,
                                  [](double a, const Chance& b) { return a < b.until; });
        if (chance == m_chances.end()) return;
        const double from = chance == m_chances.begin() ? 0.0 : std::prev(chance)->until;
        const double part = (next - from) / (chance->until - from);
        const ChosenLamp lamp = descend(chance->slot, static_cast<float>(part), chance->rate);
        if (lamp.rate.mean > 0.0f) chosen.push_back(lamp);
    }
}

ChosenLamp LampChoice::descend(Slot slot, float u, float rate) const {
    while (!m_tree.is_lamp(slot)) {
        float importance[LightTree::kWidth];
        const std::uint32_t node = m_tree.node(slot);
        const float sum = importances(node, importance);
        if (!(sum > 0.0f)) return {0, {}, true};
        float left = std::min(u, 0x1.fffffep-1f) * sum;
        std::uint32_t last = 0;
        for (std::uint32_t i = 0; i < LightTree::kWidth; ++i) {
            if (importance[i] == 0.0f) continue;
            last = i;
            if (left < importance[i]) break;
            left -= importance[i];
        }
        u = left / importance[last];
        rate *= importance[last] / sum;
        slot = node * LightTree::kWidth + last;
    }
    const std::uint32_t lamp = m_tree.lamp(slot);
    return {lamp, {rate, samples_at(lamp, rate)}, true};
}

LampRate LampChoice::rate_of(std::uint32_t lamp) const {
    Slot slot = m_tree.slot_of_lamp(lamp);
    const auto always = std::ranges::find(m_always, lamp, &ChosenLamp::lamp);
    if (always != m_always.end()) return always->rate;
    float share = 1.0f;
    auto chance = std::ranges::find(m_chances, slot, &Chance::slot);
    while (chance == m_chances.end()) {
        const std::uint32_t node = slot / LightTree::kWidth;
        float importance[LightTree::kWidth];
        const float sum = importances(node, importance);
        const float here = importance[slot % LightTree::kWidth];
        slot = m_tree.slot_of_node(node);
        if (here == 0.0f || slot == LightTree::kNoSlot) return {0.0f, 1};
        share *= here / sum;
        chance = std::ranges::find(m_chances, slot, &Chance::slot);
    }
    return {chance->rate * share, samples_at(lamp, chance->rate * share)};
}

}  // namespace granita
