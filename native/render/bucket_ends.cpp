// SPDX-License-Identifier: GPL-3.0-or-later
#include "render/bucket_ends.h"

#include <new>
#include <utility>

#include "render/geometry_node.h"

namespace granita {

BucketEnds::BucketEnds(const BucketLayout& layout)
    : m_layout(layout), m_buckets(static_cast<std::size_t>(layout.count())) {
    int turn = 0;
    for (const int bucket : layout.spiral()) m_buckets[bucket].turn = turn++;
}

bool BucketEnds::all_ended(const Rect& buckets) const {
    for (int y = buckets.y0; y < buckets.y1; ++y)
        for (int x = buckets.x0; x < buckets.x1; ++x)
            if (!m_buckets[m_layout.index(x, y)].ended.load(std::memory_order_acquire))
                return false;
    return true;
}

int BucketEnds::last_of(const Rect& buckets) const {
    int last = -1;
    for (int y = buckets.y0; y < buckets.y1; ++y)
        for (int x = buckets.x0; x < buckets.x1; ++x) {
            const int bucket = m_layout.index(x, y);
            if (m_buckets[bucket].ended.load(std::memory_order_acquire)) continue;
            if (last < 0 || m_buckets[bucket].turn > m_buckets[last].turn) last = bucket;
        }
    return last;
}

void BucketEnds::keep(std::shared_ptr<GeometryNode> node) {
    for (int last; (last = last_of(node->buckets())) >= 0;) {
        Bucket& bucket = m_buckets[last];
        const std::lock_guard lock(bucket.mutex);
        if (bucket.ended.load(std::memory_order_relaxed)) continue;
        bucket.kept.push_back(std::move(node));
        return;
    }
    node->free();
}

void BucketEnds::end(int bucket) noexcept {
    std::vector<std::shared_ptr<GeometryNode>> kept;
    {
        const std::lock_guard lock(m_buckets[bucket].mutex);
        m_buckets[bucket].ended.store(true, std::memory_order_release);
        kept.swap(m_buckets[bucket].kept);
    }
    for (auto& node : kept) try {
            keep(std::move(node));
        } catch (const std::bad_alloc&) {
            // Without memory to be handed on it goes with what it was split from.
        }
}

}  // namespace granita
