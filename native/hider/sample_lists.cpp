// SPDX-License-Identifier: GPL-3.0-or-later
#include "hider/sample_lists.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace granita {
namespace {

class ListMaker {
  public:
    ListMaker(const OpaqueSurfaces& surfaces, const GridPool& pool, const ListEnd& end)
        : m_surfaces(surfaces), m_pool(pool), m_end(end) {}

    bool in_front(const SampleFragment& arrived) const {
        const float key = m_surfaces.key[arrived.sample];
        if (arrived.fragment.key != key) return arrived.fragment.key > key;
        const SurfaceId opaque = m_surfaces.id[arrived.sample];
        return opaque != kNoSurface && m_pool.before(arrived.fragment.id, opaque);
    }

    /// By insertion: grids come roughly from front to back, and lists are short.  Long ones that
    /// came in another order are left to std::sort.
    void sort(Fragment* first, Fragment* last) const {
        constexpr std::ptrdiff_t kShort = 32;
        if (last - first > kShort) {
            if (!std::is_sorted(first, last, Before{m_pool}))
                std::sort(first, last, Before{m_pool});
            return;
        }
        const Before before{m_pool};
        for (Fragment* at = first + 1; at < last; ++at) {
            if (!before(*at, at[-1])) continue;
            const Fragment moved = *at;
            Fragment* to = at;
            do {
                *to = to[-1];
                --to;
            } while (to > first && before(moved, to[-1]));
            *to = moved;
        }
    }

    /// The sorted list without what cannot count; returns its new end.
    Fragment* cut(std::uint32_t sample, Fragment* first, Fragment* last) const {
        double clear = 1.0;
        bool seen = m_end.pass_alpha_threshold <= 0.0f, ended = false;
        Fragment* kept = first;
        for (Fragment* at = first; at < last; ++at) {
            const OpacityBounds& opacity = m_pool.opacity(at->id);
            // Behind the end only the layer that stands for the sample is still looked for.
            if (ended && opacity.most < m_end.pass_alpha_threshold) continue;
            *kept++ = *at;
            clear *= 1.0 - static_cast<double>(opacity.least);
            seen = seen || opacity.least >= m_end.pass_alpha_threshold;
            ended = ended || 1.0 - clear >= m_end.opacity_threshold;
            if (!ended || !seen) continue;
            // Coincident layers that come later may still be sorted before this one.
            const float limit = std::nextafter(at->key, -std::numeric_limits<float>::infinity());
            if (limit > m_surfaces.key[sample]) {
                m_surfaces.key[sample] = limit;
                m_surfaces.id[sample] = kNoSurface;
            }
            break;
        }
        return kept;
    }

  private:
    struct Before {
        const GridPool& pool;
        bool operator()(const Fragment& a, const Fragment& b) const {
            if (a.key != b.key) return a.key > b.key;
            return a.id != b.id && pool.before(a.id, b.id);
        }
    };
    const OpaqueSurfaces& m_surfaces;
    const GridPool& m_pool;
    const ListEnd& m_end;
};

}  // namespace

SampleLists make_lists(std::vector<SampleFragment>& arrived, const OpaqueSurfaces& surfaces,
                       const GridPool& pool, const ListEnd& end) {
    SampleLists lists;
    const ListMaker maker(surfaces, pool, end);
    std::erase_if(arrived, [&](const SampleFragment& a) { return !maker.in_front(a); });
    if (arrived.empty()) return lists;
    // Counted into samples: begin[i + 1] is where sample i's next fragment goes.
    std::vector<std::uint32_t>& begin = lists.begin;
    begin.assign(surfaces.count + 2, 0);
    for (const SampleFragment& a : arrived) ++begin[a.sample + 2];
    for (std::size_t i = 2; i < begin.size(); ++i) begin[i] += begin[i - 1];
    lists.fragments.resize(begin.back());
    for (const SampleFragment& a : arrived) lists.fragments[begin[a.sample + 1]++] = a.fragment;
    begin.pop_back();

    const bool may_end = end.opacity_threshold < 1.0f;
    Fragment* const list = lists.fragments.data();
    std::uint32_t kept = 0;
    for (std::size_t i = 0; i < surfaces.count; ++i) {
        Fragment* const first = list + begin[i];
        Fragment* last = list + begin[i + 1];
        maker.sort(first, last);
        if (may_end) last = maker.cut(static_cast<std::uint32_t>(i), first, last);
        begin[i] = kept;
        if (list + kept != first) std::copy(first, last, list + kept);
        kept += static_cast<std::uint32_t>(last - first);
    }
    begin.back() = kept;
    lists.fragments.resize(kept);
    return lists;
}

void cut_lists(std::vector<SampleFragment>& arrived, const OpaqueSurfaces& surfaces,
               const GridPool& pool, const ListEnd& end) {
    const SampleLists lists = make_lists(arrived, surfaces, pool, end);
    arrived.clear();
    for (std::uint32_t sample = 0; sample < surfaces.count; ++sample)
        for (const Fragment& fragment : lists.of(sample)) arrived.push_back({sample, fragment});
}

}  // namespace granita
