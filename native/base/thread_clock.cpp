// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/thread_clock.h"

#include <time.h>

namespace granita {

double thread_seconds() {
    timespec t{};
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
    return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

}  // namespace granita
