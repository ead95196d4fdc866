// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <cstdint>
#include <limits>
#include <numeric>
#include <span>
#include <vector>

namespace granita {

/// Calls act(indices) for those of the first `count` numbers that have a key in common, keys in
/// their order, numbers of one in theirs; of more than `most` several times.  `order` is memory to
/// be used again.
template <class Key, class Act>
void for_sorted_runs(std::vector<std::uint32_t>& order, std::size_t count, Key key, Act act,
                     std::size_t most = std::numeric_limits<std::size_t>::max()) {
    order.resize(count);
    std::iota(order.begin(), order.end(), 0u);
    std::ranges::stable_sort(order, {}, key);
    for (std::size_t begin = 0, end; begin < count; begin = end) {
        const auto of = key(order[begin]);
        for (end = begin + 1; end < count && end - begin < most && key(order[end]) == of;) ++end;
        act(std::span<const std::uint32_t>(order).subspan(begin, end - begin));
    }
}

}  // namespace granita
