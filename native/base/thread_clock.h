// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

namespace granita {

/// Processor seconds that this thread has had: a busy machine does not count.  Asking takes a
/// microsecond.
double thread_seconds();

}  // namespace granita
