/// @file
/// The parts of the module.
#pragma once

#include <pybind11/pybind11.h>

namespace wems::python {

namespace py = pybind11;

/// The commands of `identify` and the fast forward model.
void bindCommands(py::module_& module);

}  // namespace wems::python
