#include "viewer/script_player.hpp"

#include "hemi/core/error.hpp"
#include "hemi/io/output_file.hpp"
#include "viewer/clipping.hpp"
#include "viewer/dots.hpp"
#include "viewer/material_change.hpp"

#include <fmt/format.h>

#include <chrono>

namespace hemi::viewer {

namespace {

/// How long things outside may take, seconds.
constexpr std::chrono::seconds resize_patience{2};
constexpr std::chrono::seconds change_patience{60};

/// Selects a group, or says how much of it is shown.
void apply_group(const GroupCommand& command, const ViewerInput& input, Choices& choices) {
    using Action = GroupCommand::Action;
    const std::vector<std::string>& names = input.mesh->groups();
    if (command.action == Action::show_all) {
        choices.cut.groups.clear();
        return;
    }
    const std::uint32_t group = group_by_name(names, command.group, "group");
    if (command.action == Action::select) {
        select_group(choices, group, *input.mesh);
    } else if (command.action == Action::isolate) {
        isolate(choices, group, names.size());
    } else {
        set_visibility(choices, group,
                       command.action == Action::show       ? Visibility::shown
                       : command.action == Action::outlines ? Visibility::outlines
                                                            : Visibility::hidden,
                       names.size());
    }
}

class Player {
public:
    explicit Player(Application& application) : application_(application) {}

    void perform(const DragCommand& drag) {
        application_.handle(CursorEvent{drag.path[0][0], drag.path[0][1]});
        application_.handle(ButtonEvent{drag.button, true, drag.shift, drag.control});
        for (std::size_t i = 1; i < drag.path.size(); ++i) {
            application_.handle(CursorEvent{drag.path[i][0], drag.path[i][1]});
        }
        application_.handle(ButtonEvent{drag.button, false, drag.shift, drag.control});
    }
    void perform(const ClickCommand& click) {
        application_.handle(CursorEvent{click.x, click.y});
        application_.handle(ButtonEvent{Button::left, true, false});
        application_.handle(ButtonEvent{Button::left, false, false});
    }
    void perform(const MoveCommand& move) { application_.handle(CursorEvent{move.x, move.y}); }
    void perform(const ScrollCommand& scroll) {
        application_.handle(CursorEvent{scroll.x, scroll.y});
        application_.handle(ScrollEvent{scroll.amount});
    }
    void perform(const KeyCommand& key) {
        application_.handle(key.event);
        if (key.event.key == 'G') {
            application_.wait_for_work();
        }
    }
    void perform(const ShowCommand& show) {
        const Shown shown = shown_by_word(show.word).value_or(Shown{});
        Choices& choices = application_.choices();
        if (const char* problem = why_not(shown, application_.document().input(), choices.picked)) {
            throw InvalidArgument(fmt::format("show {}: {}", show.word, problem));
        }
        choices.look.shown = shown;
        application_.settle();
        if (shown.view == View::findings) {
            application_.wait_for_work();
        }
    }
    void perform(const ChannelCommand& command) {
        check_channel(application_.document().input().scene->channels, command.channel);
        application_.choices().look.channel = command.channel;
        application_.settle();
    }
    void perform(const MapCommand& command) {
        map_of(application_.choices().look) = command.map;
        application_.settle();
    }
    void perform(const RangeCommand& command) {
        application_.choices().look.range = command.range;
        application_.settle();
    }
    void perform(const DotsCommand& command) {
        choose_dots(application_.document().input(), command.column, application_.choices().look);
        application_.settle();
    }
    void perform(const BandsCommand& command) {
        application_.choices().look.bands = command.count;
        application_.settle();
    }
    void perform(const IsoLinesCommand& command) {
        application_.choices().look.iso_lines = command.drawn;
        application_.settle();
    }
    void perform(const DifferenceCommand& command) {
        Look& look = application_.choices().look;
        const char* problem =
            command.shown ? why_no_difference(look.shown, application_.document().input()) : nullptr;
        if (problem != nullptr) {
            throw InvalidArgument(fmt::format("difference: {}", problem));
        }
        look.difference = command.shown;
        application_.settle();
    }
    void perform(const FindingCommand& command) {
        application_.document().look_for_findings();
        application_.wait_for_work();
        const Findings* findings = application_.document().findings();
        const std::size_t count = findings == nullptr ? 0 : findings->of(command.kind).size();
        if (command.number > count) {
            throw InvalidArgument(
                fmt::format("finding {} {}: there are {}", to_word(command.kind), command.number, count));
        }
        application_.go_to_patch(findings->of(command.kind)[command.number - 1].patch);
        application_.settle();
    }
    void perform(const LongWorkCommand& command) {
        application_.set_long_work(std::chrono::duration<double>(command.seconds));
    }
    void perform(const GroupCommand& command) {
        apply_group(command, application_.document().input(), application_.choices());
        application_.settle();
    }
    void perform(const ClipCommand& command) {
        Choices& choices = application_.choices();
        if (command.through_patch && !choices.picked) {
            throw InvalidArgument("clip patch: click a patch first");
        }
        choices.cut.clip =
            command.through_patch
                ? std::optional(plane_of_patch(*application_.document().input().mesh, *choices.picked))
                : command.plane;
        application_.settle();
    }
    void perform(const MeasureCommand& command) {
        Choices& choices = application_.choices();
        choices.measuring = true;
        choices.measured.clear();
        perform(ClickCommand{command.from[0], command.from[1]});
        perform(ClickCommand{command.to[0], command.to[1]});
        if (choices.measured.size() < 2) {
            throw InvalidArgument("measure: nothing is seen at one of the ends");
        }
    }
    void perform(const SaveProbeCommand& command) { application_.save_probe(command.path); }
    void perform(const TypeCommand& command) {
        for (const char letter : command.text) { // ASCII, as fields of the window take
            application_.handle(TextEvent{static_cast<char32_t>(static_cast<unsigned char>(letter))});
        }
    }
    void perform(const SetCommand& set) {
        apply_set(set, application_.document().input(), application_.choices());
        application_.settle();
        application_.wait_for_work();
    }
    void perform(const FovCommand& fov) {
        application_.navigator().orbit().set_fov(fov.degrees);
        application_.refresh();
    }
    void perform(const ResizeCommand& resize) {
        Window& window = application_.window();
        window.resize(resize.width, resize.height);
        // A window manager takes its time, or has its own ideas.
        const auto late = std::chrono::steady_clock::now() + resize_patience;
        while (window.size() != std::array{resize.width, resize.height} &&
               std::chrono::steady_clock::now() < late && !application_.closing()) {
            application_.watch(0.05);
        }
        application_.refresh();
        application_.settle();
    }
    void perform(const MinimiseCommand& command) {
        application_.window().minimise(command.minimised);
        application_.watch(0.2);
    }
    void perform(const ScreenshotCommand& command) {
        application_.screenshot(command.path, command.size[0] == 0 ? application_.view_size() : command.size,
                                command.samples);
    }
    void perform(const WindowshotCommand& command) { application_.windowshot(command.path); }
    void perform(const ReportCommand& command) { application_.report(command.path); }
    void perform(const CommandLineCommand& command) {
        io::OutputFile file(command.path);
        file.write(application_.command_line() + "\n");
        file.commit();
    }
    void perform(const SaveResultCommand& command) { application_.save_result(command.path); }
    void perform(const SaveCameraCommand&) { application_.save_camera(); }
    void perform(const SaveMaterialsCommand&) { application_.save_materials(); }
    void perform(const DropCommand& drop) {
        application_.handle(DropEvent{drop.path});
        application_.wait_for_work();
    }
    void perform(const ReloadCommand&) {
        application_.open(application_.document().input().file);
        application_.wait_for_work();
    }
    void perform(const ChangedCommand&) {
        const auto late = std::chrono::steady_clock::now() + change_patience;
        while (!application_.closing() && !application_.file_changed()) {
            if (std::chrono::steady_clock::now() > late) {
                throw IoError("the file does not change");
            }
            application_.watch(0.05);
        }
        perform(ReloadCommand{});
    }
    void perform(const LiveCommand&) {}
    void perform(const PreviewCommand&) {
        application_.wait_for_work([this] { return !application_.document().lamps_only(); });
    }
    void perform(const RowsCommand& rows) {
        application_.wait_for_work(
            [this, &rows] { return application_.document().gathered_share() >= rows.share; });
    }
    void perform(const PatchesCommand& patches) {
        application_.wait_for_work(
            [this, &patches] { return application_.document().input().mesh->size() >= patches.count; });
    }
    void perform(const WaitCommand&) { application_.wait_for_work(); }
    void perform(const CancelCommand&) {
        application_.document().cancel();
        application_.wait_for_work();
    }
    void perform(const QuitCommand&) { application_.close(); }

private:
    Application& application_;
};

} // namespace

void play(const std::vector<ScriptCommand>& script, const std::string& file, Application& application) {
    if (script.empty() || !std::holds_alternative<LiveCommand>(script[0].action)) {
        application.wait_for_work();
    }
    Player player(application);
    for (const ScriptCommand& command : script) {
        if (application.closing()) {
            return;
        }
        try {
            std::visit([&player](const auto& action) { player.perform(action); }, command.action);
        } catch (const IoError& error) {
            throw IoError(fmt::format("{}:{}: {}", file, command.line, error.what()));
        }
        application.watch(0.0);
        application.update();
        if (!application.closing()) {
            application.draw();
        }
    }
}

} // namespace hemi::viewer
