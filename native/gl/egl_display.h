// SPDX-License-Identifier: GPL-3.0-or-later
// The EGL displays that need no screen: one for each device that EGL enumerates, and Mesa's
// surfaceless platform.
#pragma once

#include <epoxy/egl.h>

#include <string>
#include <vector>

namespace granita::gl {

struct Display {
    EGLDisplay display = EGL_NO_DISPLAY;
    std::string name;       ///< e.g. "EGL device 0 (/dev/dri/card0)"
    bool software = false;  ///< EGL says that it computes on the CPU
};

/// All displays, devices in EGL's order, hardware before software, surfaceless last.  Not yet
/// initialised.  Throws GlError where there is no EGL library or it offers neither platform.
std::vector<Display> headless_displays();

/// Whether a space-separated list of extensions holds the name.
bool has_extension(const char* extensions, const std::string& name);

}  // namespace granita::gl
