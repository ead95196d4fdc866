// SPDX-License-Identifier: GPL-3.0-or-later
// What a report of a fault begins with: what this module is, and what it found to run on.
#include <OpenImageIO/oiioversion.h>
#include <embree3/rtcore.h>
#include <hwy/highway.h>
#include <opensubdiv/version.h>
#include <pybind11/stl.h>
#include <tbb/version.h>

#include "base/crash_report.h"
#include "base/system.h"
#include "gl/gl_thread.h"
#include "python/snapshot.h"

namespace granita::python {
namespace {

#ifdef GRANITA_PORTABLE
constexpr bool kPortable = true;
#else
constexpr bool kPortable = false;
#endif

std::string version(int major, int minor, int patch) {
    return std::to_string(major) + '.' + std::to_string(minor) + '.' + std::to_string(patch);
}

py::dict libraries() {
    py::dict found;
    found["Embree"] = version(RTC_VERSION_MAJOR, RTC_VERSION_MINOR, RTC_VERSION_PATCH);
    found["Highway"] = version(HWY_MAJOR, HWY_MINOR, HWY_PATCH);
    found["OpenImageIO"] = OIIO_VERSION_STRING;
    found["OpenSubdiv"] =
        version(OPENSUBDIV_VERSION_MAJOR, OPENSUBDIV_VERSION_MINOR, OPENSUBDIV_VERSION_PATCH);
    found["oneTBB"] = TBB_VERSION_STRING;
    return found;
}

/// Best first, as Highway calls them.
std::vector<std::string> vector_units() {
    std::vector<std::string> names;
    for (std::int64_t left = hwy::SupportedTargets(); left != 0; left &= left - 1) {
        const std::int64_t target = left & -left;
        // Beyond these Highway has software of its own, which every processor supports.
        if (target == HWY_SCALAR || target == HWY_EMU128) continue;
        names.emplace_back(hwy::TargetName(target));
    }
    return names;
}

py::dict system() {
    py::dict found;
    found["compiler"] = __VERSION__;
    found["portable"] = kPortable;
    found["libraries"] = libraries();
    found["vector_units"] = vector_units();
    return found;
}

/// On a thread of its own: the caller's may have a context of Blender's.
py::dict opengl() {
    gl::ContextInfo info;
    std::string problem;
    {
        const py::gil_scoped_release release;
        try {
            info = gl::GlThread().info();
        } catch (const Error& error) {
            problem = error.what();
        }
    }
    py::dict found;
    if (!problem.empty()) {
        found["problem"] = problem;
        return found;
    }
    found["vendor"] = info.vendor;
    found["renderer"] = info.renderer;
    found["version"] = info.version;
    found["software"] = info.software;
    return found;
}

}  // namespace

void bind_system(py::module_& module) {
    module.def("system", &system,
               "{'compiler', 'portable', 'libraries': {name: version}, 'vector_units': [name]}");
    py::class_<CrashReport>(module, "CrashReport", py::module_local(),
                            "While it lives, a fault writes the file `path`, which begins with the "
                            "lines `about`.")
        .def(py::init<const std::string&, const std::string&>(), py::arg("path"), py::arg("about"));
    module.def("process_memory", &process_memory,
               "Bytes that this process holds, without files that are mapped; 0 where the system "
               "does not tell.");
    module.def(
        "opengl", &opengl,
        "{'vendor', 'renderer', 'version', 'software'} of the OpenGL that a frame would get, "
        "or {'problem'}.");
}

}  // namespace granita::python
