// SPDX-License-Identifier: GPL-3.0-or-later
// Grids beside a grid, of the same surface: what they gather of other surfaces' light they tell
// each other (shade/told_light.h), or each would end in a step of its noise.
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <vector>

#include "render/frame.h"

namespace granita {

/// Pixels around a bucket in which grids may lie that tell grids of the bucket something.
int neighbour_margin(const Options& options);

/// Finds those of the grids that a bucket sees.  They are listed once an instance, by where they
/// are: of a million faces with a grid each every one would else look at thousands around it.
class NeighbourGrids {
  public:
    /// @param grids those that may ask, where they are `seen` [grids]; all stay while this lives.
    NeighbourGrids(Frame& frame, int bucket, const HiddenGrids& grids,
                   const std::vector<bool>& seen);
    ~NeighbourGrids();
    /// Those that may tell one something, in the order of their keys: the same whichever bucket
    /// asks, and whatever is seen of them.  Thread-safe.
    HiddenGrids of(SharedGrid& grid);

  private:
    struct Listed {
        std::shared_ptr<SharedGrid> grid;
        RasterBounds bounds;  ///< common to all nodes on the way to it
        SharedGrid::Place place;
    };
    struct List;
    class Maker;

    Frame& m_frame;
    const int m_bucket;
    std::map<std::uint32_t, std::unique_ptr<List>> m_lists;  ///< by instance
};

/// [grids] the same of all that are `seen`; empty where nobody asks.
std::vector<HiddenGrids> all_neighbours(Frame& frame, int bucket, const HiddenGrids& grids,
                                        const std::vector<bool>& seen);

}  // namespace granita
