// SPDX-License-Identifier: GPL-3.0-or-later
#include "render/sample_levels.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "base/stage_timer.h"
#include "render/frame_blur.h"
#include "scene/scene.h"

namespace granita {
namespace {

/// From level to level: counts that are 16 * 4^k keep their order in memory (sample_bits.h).
constexpr int kStep = 4;
/// By which a level's errors are less than those of the level before: 2.5 to 2.7 with motion and
/// lens, where independent samples would give 2.
constexpr float kGain = 2.5f;

std::vector<int> sample_counts(const Options& options, bool adapts) {
    std::vector<int> counts{options.samples};
    while (adapts && counts.back() / kStep >= options.min_samples)
        counts.push_back(counts.back() / kStep);
    std::reverse(counts.begin(), counts.end());
    return counts;
}

}  // namespace

SampleLevels::SampleLevels(const View& view, const PixelFilter& filter, bool adapts, Report& report)
    : m_threshold(view.scene->options.noise_threshold) {
    const StageTimer timer(*view.statistics, Stage::Hide);
    const Scene& scene = *view.scene;
    const SampleNeeds needs{scene.moves(), scene.camera.projection.has_lens()};
    Options options = scene.options;
    const bool regular = options.sampling == Sampling::Regular;
    if (m_threshold > 0.0f && (regular || !adapts))
        report.warn(
            "render settings",
            std::string("Noise Threshold is not read: every pixel takes all samples with ") +
                (regular ? "regular sampling" : "the raster executor"));
    const int passes = regular && options.time_samples == 0 ? automatic_passes(view, filter, report)
                                                            : SampleTable::kDefaultPasses;
    for (const int count : sample_counts(options, m_threshold > 0.0f && adapts && !regular)) {
        options.samples = count;
        m_tables.push_back(
            std::make_unique<const SampleTable>(options, scene.camera, needs, passes));
    }
}

int SampleLevels::next(int level, float noise) const {
    const int last = count() - 1;
    if (level == last || noise <= m_threshold) return level;
    while (++level < last && !(noise / kGain <= m_threshold)) noise /= kGain;
    return level;
}

}  // namespace granita
