// SPDX-License-Identifier: GPL-3.0-or-later
// What a grid's points ask of the lamps that not all of them ask: of many lamps or faces each point
// chooses, of few what rays meet alone, many of which a pixel averages.
#pragma once

#include <cstdint>
#include <vector>

#include "shade/lights/lamp_choice.h"
#include "shade/lights/lamp_set.h"
#include "shade/lights/lamp_turn.h"

namespace granita {

class LampChoices {
  public:
    /// `finer`: how many times more lamps corners ask.
    LampChoices(const LampSet& set, const LitGrid& grid, float finer);

    bool empty() const { return m_all.empty(); }
    /// As LampChoice::aim(), of points with as many light samples.
    void aim(const LightReceiver& receiver, int samples);
    /// Adds the turns of a point, number `point` in the list of lit points; u in [0, 1) x [0, 1).
    void choose(const Vec2f& u, std::uint32_t point, std::vector<LampTurn>& turns);
    /// How often a point that has `samples` asks a lamp, chosen or not.
    LampRate rate_of(std::size_t lamp, int samples) const;
    std::uint64_t nodes_seen() const;

  private:
    struct Choice {
        LampChoice of;
        std::size_t first, end;  ///< of LampSet::lamps
        float asked, parts;      ///< for each light sample
    };
    std::vector<Choice> m_all;
    std::vector<ChosenLamp> m_chosen;
};

}  // namespace granita
