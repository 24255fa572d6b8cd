#include "engine/rasteriser/cpu_rows.hpp"
#include "gl/context.hpp"

#include "hemi/core/error.hpp"
#include "hemi/engine/engine.hpp"

namespace hemi {

std::vector<DeviceInfo> list_devices() {
    std::vector<DeviceInfo> devices;
    for (const std::string& name : gl::device_names()) {
        DeviceInfo info;
        info.name = name;
        try {
            const auto context = gl::make_context(name);
            info.renderer = context->renderer();
            info.version = context->version();
            info.software = context->software();
        } catch (const GlError& error) {
            info.problem = error.what();
        }
        devices.push_back(std::move(info));
    }
    DeviceInfo& cpu = devices.emplace_back();
    cpu.name = cpu_device;
    try {
        cpu.renderer = cpu_renderer();
    } catch (const InvalidArgument& error) { // HEMI_SIMD
        cpu.problem = error.what();
    }
    // As make_hemicube_engine() takes "auto": the first GPU, else the CPU, which comes last.
    for (DeviceInfo& info : devices) {
        if (info.problem.empty() && (!info.software || info.name == cpu_device)) {
            info.chosen = true;
            break;
        }
    }
    return devices;
}

std::string opengl_loader() {
    return gl::loader_version();
}

} // namespace hemi
