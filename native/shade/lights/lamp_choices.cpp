// SPDX-License-Identifier: GPL-3.0-or-later
#include "shade/lights/lamp_choices.h"

namespace granita {
namespace {

/// Of few, for each light sample of what rays meet.
constexpr float kAskedOfFew = 4.0f;
/// A choice that many points share knows its lamps as much better.
constexpr float kFiner = 4.0f;

}  // namespace

LampChoices::LampChoices(const LampSet& set, const LitGrid& grid, float finer) {
    if (set.chooses_of_few(grid))
        m_all.push_back(
            {LampChoice(*set.few), set.always, set.everywhere, kAskedOfFew, kAskedOfFew});
    if (!set.tree) return;
    const float asked = set.asked * (grid.placed ? 1.0f : finer);
    m_all.push_back({LampChoice(*set.tree), set.everywhere, set.lamps.size(), asked,
                     grid.placed ? asked : kFiner * asked});
}

void LampChoices::aim(const LightReceiver& receiver, int samples) {
    const auto count = static_cast<float>(samples);
    for (Choice& choice : m_all)
        choice.of.aim(receiver, samples, choice.asked * count, choice.parts * count);
}

void LampChoices::choose(const Vec2f& u, std::uint32_t point, std::vector<LampTurn>& turns) {
    for (std::size_t i = 0; i < m_all.size(); ++i) {
        m_chosen.clear();
        m_all[i].of.choose(i == 0 ? u.x : u.y, m_chosen);
        int by_chance = 0;
        for (const ChosenLamp& one : m_chosen)
            turns.push_back({point, static_cast<std::uint32_t>(m_all[i].first) + one.lamp, one.rate,
                             one.by_chance ? LitGrid::sign(by_chance++, 2) : 0.0f});
    }
}

LampRate LampChoices::rate_of(std::size_t lamp, int samples) const {
    for (const Choice& choice : m_all)
        if (lamp >= choice.first && lamp < choice.end)
            return choice.of.rate_of(static_cast<std::uint32_t>(lamp - choice.first));
    return {1.0f, samples};
}

std::uint64_t LampChoices::nodes_seen() const {
    std::uint64_t sum = 0;
    for (const Choice& choice : m_all) sum += choice.of.nodes_seen();
    return sum;
}

}  // namespace granita
