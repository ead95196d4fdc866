// SPDX-License-Identifier: GPL-3.0-or-later
// From the filtered channels of a cell to its passes.
#include <algorithm>

#include "film/cell_sums.h"

namespace granita {
namespace {

/// Light by colour.  A channel without colour takes the mean of those that have some, so that the
/// light on a pure red surface is not red (Cycles does the same).
void divide_by_color(const float* light, const float* color, int width, float* out) {
    float sum = 0.0f;
    int count = 0;
    for (int c = 0; c < width; ++c) {
        out[c] = color[c] != 0.0f ? light[c] / color[c] : 0.0f;
        if (color[c] == 0.0f) continue;
        sum += out[c];
        ++count;
    }
    if (count == 0) return;
    for (int c = 0; c < width; ++c)
        if (color[c] == 0.0f) out[c] = sum / static_cast<float>(count);
}

}  // namespace

void Film::finish_passes(const CellSums& sums, Tile& out) const {
    const std::size_t pixels = out.combined.size();
    for (const Pass& pass : m_channels.passes()) {
        const Channel& channel = m_channels.channels()[pass.channel];
        const bool of_center =
            channel.merge == Merge::Center || channel.merge == Merge::CenterConstant;
        const std::vector<float>& rows = of_center ? sums.center : sums.channels;
        const int row = of_center ? m_channels.center_width() : m_channels.sample_width();
        TilePass& made = out.passes.emplace_back(TilePass{pass.name, pass.width, {}});
        made.values.resize(pixels * pass.width);
        for (std::size_t i = 0; i < pixels; ++i) {
            const float* from = &rows[i * row + channel.first];
            float* to = &made.values[i * pass.width];
            if (pass.divisor >= 0) {
                const float* by = &rows[i * row + m_channels.channels()[pass.divisor].first];
                float rest[4];
                if (pass.complement) {
                    for (int c = 0; c < pass.width; ++c) rest[c] = 1.0f - by[c];
                    by = rest;
                }
                divide_by_color(from, by, pass.width, to);
            } else {
                std::copy_n(from, pass.width, to);
            }
            if (pass.complement)
                for (int c = 0; c < pass.width; ++c) to[c] = 1.0f - to[c];
        }
    }
}

}  // namespace granita
