// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/coincident_patches.h"

#include <algorithm>
#include <bit>

#include "base/parallel.h"
#include "base/parallel_sort.h"

namespace granita {
namespace {

constexpr std::size_t kGrain = 4096;

/// The finalizer of Steele, Lea and Flood's SplitMix (2014).
std::uint64_t mix(std::uint64_t x) {
    x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9ULL;
    x = (x ^ (x >> 27)) * 0x94d049bb133111ebULL;
    return x ^ (x >> 31);
}

std::uint64_t hash_of(const Vec3f& p) {
    // -0 is 0.
    const auto bits = [](float x) { return std::uint64_t{std::bit_cast<std::uint32_t>(x + 0.0f)}; };
    return mix(mix(bits(p.x) << 32 | bits(p.y)) + bits(p.z));
}

}  // namespace

CoincidentPatches::CoincidentPatches(const SharedGeometry& shared) {
    const std::vector<BasePatch>& patches = shared.patches();
    const std::span<const Vec3f> points = shared.frame_points();
    // Whichever corner comes first, and whichever way around they go.
    std::vector<std::pair<std::uint64_t, std::uint32_t>> hashed(patches.size());
    parallel_for(patches.size(), kGrain, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
            const std::size_t corners = patches[i].kind == PatchKind::Triangle ? 3 : 4;
            std::uint64_t sum = 0;
            for (std::size_t k = 0; k < corners; ++k)
                sum += hash_of(points[static_cast<std::size_t>(
                    shared.data().corner_verts[patches[i].corner[k]])]);
            hashed[i] = {sum, static_cast<std::uint32_t>(i)};
        }
    });
    parallel_sort(hashed);
    for (std::size_t i = 0; i < hashed.size();) {
        std::size_t next = i + 1;
        while (next < hashed.size() && hashed[next].first == hashed[i].first) ++next;
        const auto begin = static_cast<std::uint32_t>(m_patches.size());
        if (next - i > 1)
            for (std::size_t k = i; k < next; ++k) m_patches.push_back(hashed[k].second);
        const auto end = static_cast<std::uint32_t>(m_patches.size());
        for (std::size_t k = begin; k < end; ++k) m_groups.push_back({m_patches[k], begin, end});
        i = next;
    }
    parallel_sort(m_groups);
}

std::span<const std::uint32_t> CoincidentPatches::of(std::uint32_t patch) const {
    const auto found = std::lower_bound(m_groups.begin(), m_groups.end(), Member{patch, 0, 0});
    if (found == m_groups.end() || found->patch != patch) return {};
    return std::span(m_patches).subspan(found->begin, found->end - found->begin);
}

}  // namespace granita
