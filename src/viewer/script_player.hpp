#pragma once

#include "viewer/application.hpp"
#include "viewer/script.hpp"

#include <string>
#include <vector>

namespace hemi::viewer {

/// Drives the window as the script says, until that ends or the window is closed.
/// @param file  the script's name for messages
/// @throws InvalidArgument for what cannot be done; IoError naming file and line
void play(const std::vector<ScriptCommand>& script, const std::string& file, Application& application);

} // namespace hemi::viewer
