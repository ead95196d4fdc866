// SPDX-License-Identifier: GPL-3.0-or-later
// Native errors -> Python exceptions, in one place.
#include "python/snapshot.h"

namespace granita::python {

void bind_errors(py::module_& module) {
    // Leaked on purpose: exception types must outlive every module teardown order.
    static py::object* error = new py::exception<Error>(module, "Error", PyExc_RuntimeError);
    static py::object* scene_error =
        new py::exception<SceneError>(module, "SceneError", error->ptr());
    static py::object* gl_error = new py::exception<GlError>(module, "GlError", error->ptr());
    static py::object* internal_error =
        new py::exception<InternalError>(module, "InternalError", error->ptr());
    static py::object* cancelled = new py::exception<Cancelled>(module, "Cancelled", error->ptr());
    // NOLINTNEXTLINE(performance-unnecessary-value-param): pybind11's signature
    py::register_local_exception_translator([](std::exception_ptr pointer) {
        try {
            if (pointer) std::rethrow_exception(pointer);
        } catch (const SceneError& e) {
            py::object instance = (*scene_error)(e.what());
            instance.attr("datablock") = e.datablock();
            PyErr_SetObject(scene_error->ptr(), instance.ptr());
        } catch (const GlError& e) {
            PyErr_SetString(gl_error->ptr(), e.what());
        } catch (const InternalError& e) {
            PyErr_SetString(internal_error->ptr(), e.what());
        } catch (const Cancelled& e) {
            PyErr_SetString(cancelled->ptr(), e.what());
        } catch (const Error& e) {
            PyErr_SetString(error->ptr(), e.what());
        }
    });
}

}  // namespace granita::python
