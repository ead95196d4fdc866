// SPDX-License-Identifier: GPL-3.0-or-later
#include "gl/egl_display.h"

#include <algorithm>
#include <sstream>

#include "base/error.h"
#include "base/system.h"
#include "gl/gl_check.h"

namespace granita::gl {
namespace {

// epoxy ends the process where it cannot open a library, so we look first; it opens the same one at
// the first call.
void require_library(std::initializer_list<const char*> names) {
    for (const char* name : names)
        if (open_library(name)) return;
    throw GlError(std::string("OpenGL is not installed: no ") + *names.begin());
}

std::vector<Display> device_displays() {
    EGLint count = 0;
    if (!eglQueryDevicesEXT(0, nullptr, &count)) return {};
    std::vector<EGLDeviceEXT> devices(static_cast<std::size_t>(count));
    if (!eglQueryDevicesEXT(count, devices.data(), &count)) return {};

    std::vector<Display> displays;
    for (EGLint i = 0; i < count; ++i) {
        Display d;
        const char* extensions = eglQueryDeviceStringEXT(devices[i], EGL_EXTENSIONS);
        d.software = has_extension(extensions, "EGL_MESA_device_software");
        d.name = "EGL device " + std::to_string(i);
        if (has_extension(extensions, "EGL_EXT_device_drm"))
            if (const char* file = eglQueryDeviceStringEXT(devices[i], EGL_DRM_DEVICE_FILE_EXT))
                d.name += std::string(" (") + file + ")";
        d.display = eglGetPlatformDisplayEXT(EGL_PLATFORM_DEVICE_EXT, devices[i], nullptr);
        if (d.display != EGL_NO_DISPLAY) displays.push_back(d);
    }
    return displays;
}

}  // namespace

bool has_extension(const char* extensions, const std::string& name) {
    std::istringstream words(extensions ? extensions : "");
    for (std::string word; words >> word;)
        if (word == name) return true;
    return false;
}

std::vector<Display> headless_displays() {
    install_missing_entry_handler();
    require_library({"libEGL.so.1"});
    require_library({"libOpenGL.so.0", "libGL.so.1"});

    const char* extensions = eglQueryString(EGL_NO_DISPLAY, EGL_EXTENSIONS);
    std::vector<Display> displays;
    if (has_extension(extensions, "EGL_EXT_platform_device") &&
        (has_extension(extensions, "EGL_EXT_device_enumeration") ||
         has_extension(extensions, "EGL_EXT_device_base")))
        displays = device_displays();
    std::stable_partition(displays.begin(), displays.end(),
                          [](const Display& d) { return !d.software; });
    if (has_extension(extensions, "EGL_MESA_platform_surfaceless")) {
        const EGLDisplay display =
            eglGetPlatformDisplayEXT(EGL_PLATFORM_SURFACELESS_MESA, EGL_DEFAULT_DISPLAY, nullptr);
        if (display != EGL_NO_DISPLAY) displays.push_back({display, "surfaceless", false});
    }
    check_entry_points("looking for EGL displays");
    if (displays.empty()) throw GlError("EGL offers no device and no surfaceless display");
    return displays;
}

}  // namespace granita::gl
