// SPDX-License-Identifier: GPL-3.0-or-later
// Transparent layers put over each other, for the samples of a packet at once: compiled for every
// SIMD target and chosen at run time (Highway), with the same bits on all.
#pragma once

#include "hider/resolve/refined_samples.h"
#include "hider/sample_lists.h"
#include "hider/samples/sample_order.h"

namespace granita {

/// The layers of sixteen lists in front of what is behind them.  Each channel by itself, in double:
/// C += T c, O += a T, T -= a T, which keeps what float's T = (1 - a) T loses: 1e6 layers of 1e-6
/// (docs/hard_cases.md, case 36).
struct PacketLayers {
    alignas(64) double transmission[3][kPacket];  ///< T
    alignas(64) double color[3][kPacket];         ///< C
    alignas(64) double opacity[3][kPacket];       ///< O; only where lists may end
    alignas(64) double alpha[kPacket];            ///< mean opacity, of surfaces
    alignas(64) double cut[kPacket];              ///< and of holdouts
    alignas(64) float first_key[kPacket];         ///< of ListEnd's first surface; -inf = none
    std::uint32_t ended = 0;                      ///< bit i: list i reached the threshold
    std::uint32_t first_cuts = 0;                 ///< and the first surface of list i is a holdout
};

/// What else wants to know of layers, a sample's from front to back.
class LayerVisitor {
  public:
    virtual ~LayerVisitor() = default;
    /// Layer k of a slot.  `first`: it is the one that stands for the sample.  `adds`: it is in
    /// front of the list's end.  `transmission`: in front of it.
    virtual void layer(std::uint32_t slot, std::uint32_t k, const Fragment& fragment, bool first,
                       bool adds, const Vec3d& transmission) = 0;
};

/// Mean of the channels; exactly a channel where they are equal.
inline double channel_mean(double x, double y, double z) {
    return x + ((y - x) + (z - x)) / 3.0;
}

/// `lists` are sorted; `refined`: layers that look otherwise than in the table; `visitor` may be
/// absent.
void composite_packet(const FragmentLists& lists, std::size_t packet, const LayerTable& table,
                      const RefinedSamples& refined, const ListEnd& end, LayerVisitor* visitor,
                      PacketLayers& out);

}  // namespace granita
