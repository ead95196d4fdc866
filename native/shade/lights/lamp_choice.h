// SPDX-License-Identifier: GPL-3.0-or-later
// Which of many lamps points ask: those that matter always, of the rest as many as the noise
// allows, each as often as the light that it may give.
//
//   choice.aim(receiver, samples, asked, parts);   // points that share it
//   choice.choose(u, chosen);               // u in [0, 1): `rate` times any lamp on the mean
//   choice.rate_of(lamp);                   // the same rate, for what meets the lamp otherwise
#pragma once

#include <cstdint>
#include <vector>

#include "shade/lights/light_receiver.h"
#include "shade/lights/light_tree.h"

namespace granita {

/// How often a lamp is asked.
struct LampRate {
    float mean = 0.0f;  ///< times, the mean over all choices; what it gives is divided by it
    int samples = 1;    ///< of a soft lamp, each time
};

struct ChosenLamp {
    std::uint32_t lamp;
    LampRate rate;
    bool by_chance;
};

class LampChoice {
  public:
    explicit LampChoice(const LightTree& tree) : m_tree(tree) {}

    /// `samples`: that a soft lamp takes where there are few; `asked`: lamps that are asked where
    /// all give little; `parts`: a node that may give more than one of so many of all light is
    /// opened.  The receiver is read until the next aim().
    void aim(const LightReceiver& receiver, int samples, float asked, float parts);
    /// Adds to `chosen`.  The choices of evenly spread `u` are evenly spread over the lamps.
    void choose(float u, std::vector<ChosenLamp>& chosen) const;
    LampRate rate_of(std::uint32_t lamp) const;
    /// Nodes whose children were compared, ever.
    std::uint64_t nodes_seen() const { return m_nodes_seen; }

  private:
    using Slot = LightTree::Slot;
    /// Part of a cut through the tree: a lamp, or all below a node.
    struct Entry {
        Slot slot;
        std::uint32_t next;
        float importance;
    };
    struct Chance {
        Slot slot;
        float rate;
        double until;  ///< sum of the rates so far
    };
    static constexpr std::uint32_t kEnd = ~0u;

    float importances(std::uint32_t node, float (&of_child)[LightTree::kWidth]) const;
    void expand(std::uint32_t node, std::uint32_t* link);
    template <class Least>
    void open(const Least& least);
    float importance_of_one(float asked);
    void sort_out(float once);
    int samples_at(std::uint32_t lamp, float rate) const;
    /// To one of the lamps below, by u in [0, 1).
    ChosenLamp descend(Slot slot, float u, float rate) const;

    const LightTree& m_tree;
    LightReceiverView m_receiver{};
    std::uint64_t m_receives = 0;
    int m_samples = 1;
    float m_total = 0.0f;
    std::vector<Entry> m_entries;
    std::vector<std::uint32_t> m_open;  ///< entries that are nodes: a heap by importance
    std::uint32_t m_first = kEnd;
    int m_opened = 0;
    std::vector<ChosenLamp> m_always;
    std::vector<Chance> m_chances;  ///< the rest, in the order of the tree
    mutable std::uint64_t m_nodes_seen = 0;
};

}  // namespace granita
