// SPDX-License-Identifier: GPL-3.0-or-later
// Where the slots of a program lie in a run's memory, when only some of the program is left: those
// that are not needed at once share a place.
#pragma once

#include <span>
#include <vector>

namespace granita {

/// What a step does to slots.
struct SlotUse {
    std::span<const int> reads, writes;
};

struct SlotPlaces {
    std::vector<int> first;  ///< [slots] floats a point before it; -1: no step has it
    int floats_a_point = 0;
};

/// @param widths [slots] floats of each.
/// @param written_first slots that are full before the first step.
/// @param uses [steps] in their order.
/// @param roots slots that are read when all steps have run.
SlotPlaces place_slots(std::span<const int> widths, std::span<const int> written_first,
                       std::span<const SlotUse> uses, std::span<const int> roots);

}  // namespace granita
