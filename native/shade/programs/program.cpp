// SPDX-License-Identifier: GPL-3.0-or-later
#include "shade/programs/program.h"

#include <algorithm>
#include <unordered_set>

namespace granita {

namespace {

void run_load(const Load& load, Run& run) {
    const std::size_t n = run.count();
    float* out = run.write(FloatSource{load.slot, 0.0f});
    const auto* attributes = run.input().attributes;
    const GridAttribute* attribute = nullptr;
    if (attributes) {
        for (const GridAttribute& candidate : *attributes) {
            if (candidate.attribute == load.request) attribute = &candidate;
        }
    }
    if (!attribute || attribute->values.empty()) {
        std::fill(out, out + n * load.width, 0.0f);
        return;
    }
    const std::vector<float>* step = nullptr;
    if (load.shift == Shift::U && !attribute->du.empty()) step = &attribute->du;
    if (load.shift == Shift::V && !attribute->dv.empty()) step = &attribute->dv;
    const int width = attribute->width;
    for (std::size_t i = 0; i < n; ++i) {
        const float scale = step ? run.step_scale(load.bump_width, load.shift, i) : 1.0f;
        for (int c = 0; c < load.width; ++c) {
            // A scalar attribute read as a colour is grey, as in Cycles; other missing components
            // are zero.
            const int from = width == 1 ? 0 : load.first + c;
            const std::size_t index = i * width + from;
            float value = from < width ? attribute->values[index] : 0.0f;
            if (step && from < width) value += scale * (*step)[index];
            out[i * load.width + c] = value;
        }
    }
}

}  // namespace

float Run::scale_of(float width, Shift shift, std::size_t point) const {
    const ShadingPoints& points = *m_input.points;
    const std::vector<Vec3f>& steps = shift == Shift::V ? points.dp_dv : points.dp_du;
    const float away =
        points.seen_from.empty() ? glm::length(points.p[point]) : points.seen_from[point];
    const float pixel = points.pixel_width + points.pixel_slope * away;
    if (!(pixel > 0.0f)) return width;
    const float length = glm::length(steps[point]);
    return length > 0.0f ? width * pixel / length : width;
}

Program::Program(const std::vector<Load>& loads, const std::vector<Step>& steps,
                 const std::vector<int>& widths, const std::vector<int>& roots)
    : m_widths(widths) {
    std::unordered_set<int> live(roots.begin(), roots.end());
    std::vector<bool> kept(steps.size());
    for (std::size_t i = steps.size(); i-- > 0;) {
        for (const int slot : steps[i].writes) kept[i] = kept[i] || live.count(slot);
        if (kept[i]) live.insert(steps[i].reads.begin(), steps[i].reads.end());
    }
    for (std::size_t i = 0; i < steps.size(); ++i) {
        if (kept[i]) m_steps.push_back(steps[i]);
    }
    for (const Load& load : loads) {
        if (live.count(load.slot)) m_loads.push_back(load);
    }
    std::vector<int> loaded;
    for (const Load& load : m_loads) loaded.push_back(load.slot);
    std::vector<SlotUse> uses;
    for (const Step& step : m_steps) uses.push_back({step.reads, step.writes});
    m_places = place_slots(m_widths, loaded, uses, roots);
}

void Program::execute(Run& run) const {
    for (const Load& load : m_loads) run_load(load, run);
    const Progress* const progress = run.input().progress;
    for (const Step& step : m_steps) {
        if (progress) progress->check();
        step.run(run);
    }
}

bool Program::is_still() const {
    return std::ranges::all_of(m_steps, &Step::is_still) &&
           std::ranges::all_of(m_loads, [](const Load& load) { return load.bump_width == 0.0f; });
}

void Program::renumber_requests(const std::vector<int>& request) {
    for (Load& load : m_loads) load.request = request[load.request];
}

}  // namespace granita
