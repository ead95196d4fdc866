// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

namespace granita {

/// Blocks of a power of two of bytes for lists that grow while a bucket is hidden and go with it.
/// They come from slabs of two megabytes that the next bucket has again: pages that the system
/// gives and takes back for every bucket cost a sixth of a frame of feathers.  The slabs ask for
/// huge pages, since lists are met in no order: 5 to 12 % of such a frame.
class Arena {
  public:
    static constexpr int kLeastLog2 = 9, kSlabLog2 = 21;

    /// A block of 2^log2 bytes, aligned to 64; log2 >= kLeastLog2.  Its contents are anything.
    void* take(int log2);
    void give(void* block, int log2);
    /// Of the blocks that are out.
    std::uint64_t bytes() const { return m_bytes; }
    /// Ends all blocks; slabs are kept.
    void clear();

  private:
    struct Free {
        void operator()(void* memory) const;
    };
    using Slab = std::unique_ptr<std::byte, Free>;
    static Slab make(std::size_t bytes);

    std::vector<Slab> m_slabs, m_large;  ///< m_large: blocks beyond a slab
    std::size_t m_slab = 0, m_used = 0;  ///< blocks come from m_slabs[m_slab], from byte m_used on
    void* m_given[kSlabLog2 + 1] = {};   ///< by log2; a block begins with the next one's address
    std::uint64_t m_bytes = 0;
};

}  // namespace granita
