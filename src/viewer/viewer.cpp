#include "viewer/viewer.hpp"

#include "hemi/core/error.hpp"
#include "hemi/io/output_file.hpp"
#include "viewer/application.hpp"
#include "viewer/script_player.hpp"

#include <utility>

namespace hemi::viewer {

void run_viewer(ViewerInput input, const ViewerSettings& settings) {
    if (input.mesh == nullptr || input.scene == nullptr) {
        throw InvalidArgument("viewer: no scene");
    }
    if (settings.script.empty()) {
        Application(std::move(input), settings).run();
        return;
    }
    const std::vector<ScriptCommand> script = parse_script(io::read_file(settings.script), settings.script);
    Application application(std::move(input), settings);
    play(script, settings.script, application);
}

} // namespace hemi::viewer
