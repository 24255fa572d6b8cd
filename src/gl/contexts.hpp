#pragma once

#include "gl/context.hpp"

#include <cstddef>
#include <memory>

namespace hemi::gl {

/// Whether the GL functions were last loaded for that backend (see load_functions()).
[[nodiscard]] bool functions_loaded_for(const char* backend) noexcept;
/// EGL devices (EGL_EXT_device_enumeration); 0 where EGL or the extension is missing.
[[nodiscard]] std::size_t egl_device_count();
/// Whether a device says that it rasterises on the CPU; told without making a context.
[[nodiscard]] bool egl_device_is_software(std::size_t device);
/// @throws NoDevice
[[nodiscard]] std::unique_ptr<Context> make_egl_context(std::size_t device);
/// @throws NoDevice
[[nodiscard]] std::unique_ptr<Context> make_osmesa_context();

} // namespace hemi::gl
