// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/process_memory.h"

#ifdef __linux__
#include <malloc.h>
#include <unistd.h>

#include <fstream>
#endif

namespace granita {

#ifdef __linux__
std::uint64_t process_memory() {
    std::uint64_t pages = 0, resident = 0, of_files = 0;  // proc(5), statm
    std::ifstream statm("/proc/self/statm");
    if (!(statm >> pages >> resident >> of_files) || resident < of_files) return 0;
    return (resident - of_files) * static_cast<std::uint64_t>(sysconf(_SC_PAGESIZE));
}

void return_freed_memory() {
    malloc_trim(0);
}
#else
std::uint64_t process_memory() {
    return 0;
}

void return_freed_memory() {}
#endif

}  // namespace granita
