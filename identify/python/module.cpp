// The Python module `wems._wems`: models, recordings and the commands; what a user sees of it is in the package beside.
#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <algorithm>
#include <memory>

#include "identify/python/bindings.hpp"
#include "models/common/error.hpp"
#include "models/parameter_access.hpp"
#include "models/recording/recording_reader.hpp"
#include "models/recording/recording_table.hpp"
#include "models/recording/recording_writer.hpp"
#include "models/sensor_place.hpp"

namespace wems::python {
namespace {

/// Becomes the package's own exception, with its parts as attributes.
void translateErrors(std::exception_ptr thrown) {
    try {
        if (thrown) std::rethrow_exception(thrown);
    } catch (const InputError& error) {
        const py::object type = py::module_::import("wems.errors").attr("InputError");
        const InputLocation& at = error.location();
        const py::object raised = type(error.what(), at.file, at.line, at.key, error.problem(), error.accepted());
        PyErr_SetObject(type.ptr(), raised.ptr());
    }
}

/// The values themselves, which live as long as `owner`; they cannot be written to.
py::array viewValues(const std::vector<double>& values, const py::object& owner) {
    py::array_t<double> view(static_cast<py::ssize_t>(values.size()), values.data(), owner);
    view.attr("setflags")(py::arg("write") = false);
    return std::move(view);
}

std::optional<ColumnMap> readMap(const std::string& file) {
    return file.empty() ? std::nullopt : std::optional(readColumnMap(file));
}

std::shared_ptr<Recording> readFile(const std::string& file, const std::string& columns) {
    const py::gil_scoped_release released;
    const auto map = readMap(columns);
    return std::make_shared<Recording>(readRecording(file, map ? &*map : nullptr));
}

using Column = std::tuple<std::string, std::string, py::array_t<double, py::array::c_style | py::array::forcecast>>;

/// Checked and repaired as a file's columns are. The values are copied once.
std::shared_ptr<Recording> makeFromArrays(const std::string& name, const std::vector<Column>& columns) {
    RecordingTable table;
    table.file = name;
    table.format = "arrays";
    table.missing_unit = MissingUnit::si;
    for (const auto& [channel, unit, values] : columns) {
        OfferedColumn offered;
        offered.text = channel;
        if (!unit.empty()) offered.unit = unit;
        table.columns.push_back(offered);
        if (values.ndim() != 1) throw InputError({name, 0, channel}, "is no list of numbers", "one dimension");
        table.values.emplace_back(values.data(), values.data() + values.size());
    }
    return std::make_shared<Recording>(makeRecording(std::move(table), nullptr));
}

void bindRecording(py::module_& module) {
    py::class_<Recording, std::shared_ptr<Recording>>(module, "Recording")
        .def_readonly("file", &Recording::file)
        .def_readonly("format", &Recording::format)
        .def_readonly("metadata", &Recording::metadata)
        .def_readonly("unused_columns", &Recording::unused_columns)
        .def_readonly("warnings", &Recording::warnings)
        .def_property_readonly(
            "time", [](const py::object& self) { return viewValues(self.cast<const Recording&>().time, self); })
        .def_property_readonly("names",
                               [](const Recording& self) {
                                   std::vector<std::string> names;
                                   for (const Channel& channel : self.channels) names.push_back(channel.name);
                                   return names;
                               })
        .def("values",
             [](const py::object& self, const std::string& name) {
                 const Channel* channel = self.cast<const Recording&>().find(name);
                 if (channel == nullptr) throw py::key_error(name);
                 return viewValues(channel->values, self);
             })
        .def("unit",
             [](const Recording&, const std::string& name) {
                 const auto parsed = parseChannelName(name);
                 if (!parsed) throw py::key_error(name);
                 return std::string(siUnit(findQuantity(*parsed)));
             })
        .def("write", [](const Recording& self, const std::string& file, int digits) {
            const py::gil_scoped_release released;
            WriteOptions options;
            options.digits = digits;
            return writeRecording(self, file, options);
        });
    module.def("read_recording", &readFile);
    module.def("make_recording", &makeFromArrays);
}

std::shared_ptr<MountModel> readModel(const std::string& file, const std::string& geometry) {
    auto model = std::make_shared<MountModel>(readMountModel(file));
    if (!geometry.empty())
        for (SensorPlace& place : readSensorPlaces(geometry)) model->places.push_back(std::move(place));
    validate(*model);
    return model;
}

/// Connection, position, and of each axis whether it has a stop below and above.
py::list listConnections(const MountModel& model) {
    py::list list;
    for (const Connection& connection : model.connections) {
        py::list stops;
        for (const AxisLaw& law : connection.axis) {
            const auto has = [&](Side side) {
                return std::any_of(law.stops.begin(), law.stops.end(),
                                   [&](const Stop& stop) { return stop.side == side; });
            };
            stops.append(py::make_tuple(has(Side::negative), has(Side::positive)));
        }
        const Eigen::Vector3d& r = connection.position;
        list.append(py::make_tuple(connection.name, py::make_tuple(r.x(), r.y(), r.z()), stops));
    }
    return list;
}

void bindModel(py::module_& module) {
    py::class_<MountModel, std::shared_ptr<MountModel>>(module, "Model")
        .def_readwrite("name", &MountModel::name)
        .def_property_readonly("connections", &listConnections)
        .def_property_readonly("mode_count", [](const MountModel& self) { return self.bracket.size(); })
        .def("get", [](const MountModel& self, const std::string& name) { return getParameter(self, name); })
        .def("set",
             [](MountModel& self, const std::string& name, double value) {
                 MountModel changed = self;
                 setParameter(changed, name, value);
                 validate(changed);
                 self = std::move(changed);
             })
        .def("to_toml", [](const MountModel& self) { return formatMountModel(self, self.bracket_file); })
        .def("save", [](const MountModel& self, const std::string& file) { writeMountModel(self, file); })
        .def("copy", [](const MountModel& self) { return std::make_shared<MountModel>(self); });
    module.def("read_model", &readModel);
    module.def("parse_model", [](const std::string& text, const std::string& file) {
        return std::make_shared<MountModel>(parseMountModel(text, file));
    });
    module.def("parameter_unit", &parameterUnit);
}

}  // namespace
}  // namespace wems::python

PYBIND11_MODULE(_wems, module) {
    using namespace wems::python;
    py::register_exception_translator(&translateErrors);
    module.attr("version") = WEMS_VERSION;
    constexpr int first_with_numpy_2 = 212;
    module.attr("knows_numpy_2") = 100 * PYBIND11_VERSION_MAJOR + PYBIND11_VERSION_MINOR >= first_with_numpy_2;
    bindRecording(module);
    bindModel(module);
    bindCommands(module);
}
