// SPDX-License-Identifier: GPL-3.0-or-later
#include "python/snapshot.h"

PYBIND11_MODULE(granita_core, module) {
    module.doc() = "Granita's native renderer: scene snapshot in, finished tiles out.";
    module.attr("__version__") = GRANITA_VERSION;
    granita::python::bind_errors(module);
    granita::python::bind_render(module);
    granita::python::bind_system(module);
}
