#include "hemi/engine/engine.hpp"
#include "python/bindings.hpp"
#include "python/work.hpp"

namespace hemi::python {

namespace {

py::list devices() {
    const std::vector<DeviceInfo> found = run([] { return list_devices(); });
    py::list list;
    for (const DeviceInfo& device : found) {
        py::dict entry;
        entry["name"] = device.name;
        entry["renderer"] = device.renderer;
        entry["version"] = device.version;
        entry["problem"] =
            device.problem.empty() ? py::object(py::none()) : py::object(py::str(device.problem));
        entry["software"] = device.software;
        entry["auto"] = device.chosen;
        list.append(entry);
    }
    return list;
}

} // namespace

} // namespace hemi::python

PYBIND11_MODULE(_hemi, module) {
    using namespace hemi::python;
    module.doc() = "The compiled part of the package hemi, which has all of its names.";
    module.attr("__version__") = HEMI_VERSION;
    bind_errors(module);
    bind_scene(module);
    bind_solution(module);
    bind_factors(module);
    module.def("devices", &devices, R"(
Devices that could be used here: OpenGL ones, and "cpu", the rasteriser of hemi itself.

Returns
-------
list of dict
    name, renderer, version, problem (None: it can be used), software, auto (what "auto" takes).
)");
    module.def(
        "worker_program", [] { return hemi::find_worker_program().string(); }, R"(
Path of the program that computes rows on software OpenGL, as many at a time as there are cores. Empty: it was
not found, and rows come from one context of this process; the environment variable HEMI_WORKER names one.
)");
    install_interrupt_check();
}
