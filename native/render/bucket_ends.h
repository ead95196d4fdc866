// SPDX-License-Identifier: GPL-3.0-or-later
// What is freed with the last bucket that wants it.
//
// A node is kept by one of its buckets: of those that have not ended the one whose turn comes last.
// Where others still want it when that one ends, it is handed on.  So a node costs the few buckets
// that kept it: to mark each bucket's end in each node below it was a seventh of a frame of long
// hair (docs/decisions/curves.md).  end() takes no lock of a node; expand() takes one of a bucket.
#pragma once

#include <atomic>
#include <memory>
#include <mutex>
#include <vector>

#include "render/bucket_layout.h"

namespace granita {

class GeometryNode;

class BucketEnds {
  public:
    explicit BucketEnds(const BucketLayout& layout);
    /// `buckets`: in bucket coordinates.
    bool all_ended(const Rect& buckets) const;
    /// Until the last of its buckets has ended.  Thread-safe.
    void keep(std::shared_ptr<GeometryNode> node);
    /// The bucket will not ask for anything again.  Thread-safe, once a bucket.
    void end(int bucket) noexcept;

  private:
    struct Bucket {
        std::mutex mutex;
        std::atomic<bool> ended{false};
        std::vector<std::shared_ptr<GeometryNode>> kept;
        int turn = 0;
    };
    /// Of those that have not ended the last by turn; -1: none.
    int last_of(const Rect& buckets) const;

    const BucketLayout& m_layout;
    std::vector<Bucket> m_buckets;
};

}  // namespace granita
