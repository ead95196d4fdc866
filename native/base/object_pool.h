// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <new>
#include <utility>
#include <vector>

namespace granita {

/// Objects that a thread has done with, kept for the memory inside them: a bucket's arrays are
/// megabytes, which the C library gives back to the system and takes again, page by page, for every
/// bucket (a sixth of the time to hide one).  They go when the thread ends.
template <class T>
class ObjectPool {
  public:
    /// One of them, as it was left, or a new one.
    static T take() {
        std::vector<T>& pool = list();
        if (pool.empty()) return T();
        T out = std::move(pool.back());
        pool.pop_back();
        return out;
    }
    /// Takes it in any case, for destructors too: one that there is no room or memory to keep is
    /// destroyed.
    static void give(T&& object) noexcept {
        T taken = std::move(object);
        std::vector<T>& pool = list();
        if (pool.size() >= kMost) return;
        try {
            pool.push_back(std::move(taken));
        } catch (const std::bad_alloc&) {
            return;
        }
    }

  private:
    static constexpr std::size_t kMost = 64;  ///< a bucket of 128 pixels
    static std::vector<T>& list() {
        thread_local std::vector<T> pool;
        return pool;
    }
};

}  // namespace granita
