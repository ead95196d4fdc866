// SPDX-License-Identifier: GPL-3.0-or-later
// Errors of OpenGL as exceptions.
#pragma once

#include <functional>
#include <string>

namespace granita::gl {

/// Throws GlError naming `what` if OpenGL has recorded an error since the last call, or if an entry
/// point without provider was called on this thread, or if the driver has reset the GPU, which
/// loses the context.  In a debug context the driver's own message is added.  Costs a
/// synchronisation in some drivers: once an object or pass, not once a call.
void check(const std::string& what);

/// libepoxy aborts the process where an entry point has no provider.  After this call it records
/// the name, the entry point returns 0 and check() throws.  Idempotent, thread-safe.
void install_missing_entry_handler();

/// Throws GlError if an entry point without provider was called on this thread.
void check_entry_points(const std::string& what);

/// Called by every check() of this thread; none: an empty function (DriverFaults::at_check).
void set_check_hook(std::function<void(const std::string& what)> hook);

/// Collects the driver's messages of the current (debug) context for check().
void collect_debug_messages();

}  // namespace granita::gl
