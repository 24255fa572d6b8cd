#include "cli/commands.hpp"
#include "cli/report/report.hpp"
#include "hemi/core/error.hpp"
#include "hemi/engine/engine.hpp"

#include <algorithm>

namespace hemi::cli {

namespace {

Report devices_report(const std::vector<DeviceInfo>& devices) {
    Table table({"device", "auto", "kind", "renderer", "version"}, 5);
    Json list = Json::array();
    for (const DeviceInfo& device : devices) {
        const bool usable = device.problem.empty();
        table.add({device.name, device.chosen ? "*" : "",
                   !usable           ? "-"
                   : device.software ? "software"
                                     : "gpu",
                   usable ? device.renderer : "not usable: " + device.problem, device.version});
        list.push_back({{"name", device.name},
                        {"renderer", device.renderer},
                        {"version", device.version},
                        {"usable", usable},
                        {"problem", usable ? Json(nullptr) : Json(device.problem)},
                        {"software", device.software},
                        {"auto", device.chosen}});
    }
    Report report{devices.empty() ? "" : table.text(), {{"devices", list}}};
    report.select("hemi/devices/1", {"devices"});
    return report;
}

} // namespace

ExitStatus run(const DevicesArguments& arguments, const Terminal& terminal) {
    const std::vector<DeviceInfo> devices = list_devices();
    show(devices_report(devices), arguments.common.json);
    const bool usable = std::any_of(devices.begin(), devices.end(),
                                    [](const DeviceInfo& device) { return device.problem.empty(); });
    if (!usable) {
        terminal.error("no usable OpenGL device: neither EGL nor OSMesa gives an OpenGL 4.5 core context");
        return ExitStatus::no_device;
    }
    return ExitStatus::ok;
}

} // namespace hemi::cli
