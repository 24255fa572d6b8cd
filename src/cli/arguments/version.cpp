#include "cli/arguments/version.hpp"

#include "hemi/engine/engine.hpp"

#include <fmt/format.h>

namespace hemi::cli {

std::string version_text() {
    return fmt::format("hemi {}\nrevision  {}\ncompiler  {}\nOpenGL    4.5 core, loader {}, {}\n",
                       HEMI_VERSION, source_revision, HEMI_COMPILER, opengl_loader(), HEMI_DISPLAYS);
}

} // namespace hemi::cli
