// SPDX-License-Identifier: GPL-3.0-or-later
// A system that has no memory left for a moment: preloaded, operator new throws bad_alloc the n-th
// time it is asked from fail_new_after(n) on, once, whichever thread asks.
#include <atomic>
#include <cstdlib>
#include <new>

namespace {

std::atomic<long> left{-1};
std::atomic<long> asked{0};

void* obtained(std::size_t size, std::size_t alignment) {
    asked.fetch_add(1, std::memory_order_relaxed);
    if (left.load(std::memory_order_relaxed) >= 0 && left.fetch_sub(1) == 0) throw std::bad_alloc();
    size = size ? size : 1;
    void* memory =
        alignment ? std::aligned_alloc(alignment, (size + alignment - 1) / alignment * alignment)
                  : std::malloc(size);
    if (!memory) throw std::bad_alloc();
    return memory;
}

}  // namespace

/// n = 0: the very next one; below 0: none.
extern "C" void fail_new_after(long n) {
    asked = 0;
    left = n;
}

/// How often memory was asked for since.
extern "C" long asked_new() {
    return asked;
}

void* operator new(std::size_t size) {
    return obtained(size, 0);
}
void* operator new[](std::size_t size) {
    return obtained(size, 0);
}
void* operator new(std::size_t size, std::align_val_t alignment) {
    return obtained(size, static_cast<std::size_t>(alignment));
}
void* operator new[](std::size_t size, std::align_val_t alignment) {
    return obtained(size, static_cast<std::size_t>(alignment));
}
void* operator new(std::size_t size, const std::nothrow_t&) noexcept {
    try {
        return obtained(size, 0);
    } catch (const std::bad_alloc&) {
        return nullptr;
    }
}
void operator delete(void* memory) noexcept {
    std::free(memory);
}
void operator delete[](void* memory) noexcept {
    std::free(memory);
}
void operator delete(void* memory, std::size_t) noexcept {
    std::free(memory);
}
void operator delete[](void* memory, std::size_t) noexcept {
    std::free(memory);
}
void operator delete(void* memory, std::align_val_t) noexcept {
    std::free(memory);
}
void operator delete[](void* memory, std::align_val_t) noexcept {
    std::free(memory);
}
void operator delete(void* memory, std::size_t, std::align_val_t) noexcept {
    std::free(memory);
}
void operator delete[](void* memory, std::size_t, std::align_val_t) noexcept {
    std::free(memory);
}
