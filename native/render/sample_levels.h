// SPDX-License-Identifier: GPL-3.0-or-later
// How many samples a tile may take.  All tiles are seen with few; those that this leaves in doubt
// (film/tile_noise.h) are seen again with more, which replace the few: a tile that takes all of
// Options::samples is what it is without a threshold, to the bit.
#pragma once

#include <memory>
#include <vector>

#include "base/report.h"
#include "dice/view.h"
#include "film/filter.h"
#include "hider/samples/sample_table.h"

namespace granita {

class SampleLevels {
  public:
    /// @param adapts whether the executor can see a tile again.
    SampleLevels(const View& view, const PixelFilter& filter, bool adapts, Report& report);
    int count() const { return static_cast<int>(m_tables.size()); }
    /// From few samples to Options::samples; each has four times those of the one before.
    const SampleTable& table(int level) const { return *m_tables[static_cast<std::size_t>(level)]; }
    const SampleTable& fewest() const { return *m_tables.front(); }
    const SampleTable& all() const { return *m_tables.back(); }
    /// The level that a tile wants after it was seen at `level` and left in doubt by `noise`
    /// (film/tile_noise.h); `level` itself where that is enough.  What would not be enough either
    /// is not tried.
    int next(int level, float noise) const;

  private:
    float m_threshold;
    std::vector<std::unique_ptr<const SampleTable>> m_tables;
};

}  // namespace granita
