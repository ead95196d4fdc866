// SPDX-License-Identifier: GPL-3.0-or-later
// What this process holds of the machine's memory.
#pragma once

#include <cstdint>

namespace granita {

/// Bytes that the system cannot take back by itself: files that are mapped do not count.  0 where
/// it does not tell.
std::uint64_t process_memory();

/// Has the C library give back what it keeps of what was freed.
void return_freed_memory();

}  // namespace granita
