#include "viewer/script.hpp"

#include "hemi/core/error.hpp"
#include "hemi/core/nearest_word.hpp"
#include "viewer/look.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <cmath>
#include <optional>
#include <utility>

namespace hemi::viewer {

namespace {

constexpr std::string_view blanks = " \t\r";

/// The words of one line, taken one after the other; every complaint names the line.
class Line {
public:
    Line(std::string_view text, const std::string& file, std::size_t number)
        : rest_(text), file_(file), number_(number) {}

    [[noreturn]] void fail(const std::string& message) const { throw ParseError(file_, number_, 0, message); }

    [[nodiscard]] std::optional<std::string_view> next() {
        skip_blanks();
        if (rest_.empty()) {
            return std::nullopt;
        }
        const std::size_t end = std::min(rest_.find_first_of(blanks), rest_.size());
        const std::string_view word = rest_.substr(0, end);
        rest_.remove_prefix(end);
        return word;
    }

    [[nodiscard]] std::string_view word(const char* what) {
        const auto found = next();
        if (!found) {
            fail(fmt::format("{} is missing", what));
        }
        return *found;
    }

    [[nodiscard]] double number(const char* what) {
        const std::string_view text = word(what);
        double value = 0.0;
        const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
        if (error != std::errc() || end != text.data() + text.size() || !(std::abs(value) <= 1e6)) {
            fail(fmt::format("\"{}\" as {}; must be a number within a million", text, what));
        }
        return value;
    }

    [[nodiscard]] std::uint32_t size(const char* what) {
        const double value = number(what);
        if (value != std::floor(value) || value < 1.0 || value > 16384.0) {
            fail(fmt::format("{} as {}; must be a whole number from 1 to 16384", value, what));
        }
        return static_cast<std::uint32_t>(value);
    }

    /// All that is left, without blanks around it.
    [[nodiscard]] std::string_view rest() {
        skip_blanks();
        const std::size_t last = rest_.find_last_not_of(blanks);
        return last == std::string_view::npos ? std::string_view{} : rest_.substr(0, last + 1);
    }

    void end() {
        if (const auto extra = next()) {
            fail(fmt::format("\"{}\" is too much", *extra));
        }
    }

private:
    void skip_blanks() { rest_.remove_prefix(std::min(rest_.find_first_not_of(blanks), rest_.size())); }

    std::string_view rest_;
    const std::string& file_;
    std::size_t number_;
};

/// A line up to the comment, which begins with a `#` at the beginning of a word.
std::string_view without_comment(std::string_view line) {
    for (std::size_t at = line.find('#'); at != std::string_view::npos; at = line.find('#', at + 1)) {
        if (at == 0 || blanks.find(line[at - 1]) != std::string_view::npos) {
            return line.substr(0, at);
        }
    }
    return line;
}

bool take(std::string_view prefix, std::string_view& word) {
    const bool there = word.starts_with(prefix);
    word.remove_prefix(there ? prefix.size() : 0);
    return there;
}

DragCommand parse_drag(Line& line) {
    DragCommand drag{};
    std::string_view name = line.word("a button");
    drag.shift = take("shift+", name);
    drag.control = take("ctrl+", name);
    if (name == "left") {
        drag.button = Button::left;
    } else if (name == "middle") {
        drag.button = Button::middle;
    } else if (name == "right") {
        drag.button = Button::right;
    } else {
        line.fail(fmt::format("button \"{}\"; must be left, middle or right", name));
    }
    while (drag.path.size() < 2 || !line.rest().empty()) {
        const double x = line.number("x");
        drag.path.push_back({x, line.number("y")});
    }
    return drag;
}

KeyCommand parse_key(Line& line) {
    std::string_view name = line.word("a key");
    const bool control = take("ctrl+", name);
    const bool alt = take("alt+", name);
    const bool shift = take("shift+", name);
    constexpr std::array<std::pair<std::string_view, char>, 7> named{{{"Escape", escape_key},
                                                                      {"Tab", tab_key},
                                                                      {"Home", home_key},
                                                                      {"F1", help_key},
                                                                      {"F5", reload_key},
                                                                      {"Enter", enter_key},
                                                                      {"Backspace", backspace_key}}};
    for (const auto& [word, key] : named) {
        if (name == word) {
            return {{key, shift, control, alt}};
        }
    }
    if (name.size() != 1 || std::isalnum(static_cast<unsigned char>(name[0])) == 0) {
        line.fail(fmt::format(
            "key \"{}\"; must be a letter, a digit, Escape, Tab, Home, Enter, Backspace, F1 or F5", name));
    }
    return {{static_cast<char>(std::toupper(static_cast<unsigned char>(name[0]))), shift, control, alt}};
}

/// WIDTHxHEIGHT; nothing if the word is none.
std::optional<std::array<std::uint32_t, 2>> parse_extent(std::string_view word) {
    std::array<std::uint32_t, 2> size{};
    const char* const end = word.data() + word.size();
    const auto width = std::from_chars(word.data(), end, size[0]);
    if (width.ec != std::errc() || width.ptr == end || *width.ptr != 'x') {
        return std::nullopt;
    }
    const auto height = std::from_chars(width.ptr + 1, end, size[1]);
    return height.ec == std::errc() && height.ptr == end ? std::optional(size) : std::nullopt;
}

ScreenshotCommand parse_screenshot(Line& line) {
    ScreenshotCommand screenshot{};
    Line ahead = line;
    if (const auto size = parse_extent(ahead.word("a name"))) {
        screenshot.size = *size;
        for (const std::uint32_t edge : *size) {
            if (edge < 1 || edge > 16384) {
                line.fail(fmt::format("size {}x{}; each must be 1 to 16384", (*size)[0], (*size)[1]));
            }
        }
        (void)line.next();
        const std::string_view word = ahead.word("a name");
        if (word.size() == 1 && word[0] >= '1' && word[0] <= '8') {
            screenshot.samples = static_cast<std::uint32_t>(word[0] - '0');
            (void)line.next();
        }
    }
    screenshot.path = line.rest();
    if (!screenshot.path.ends_with(".png") && !screenshot.path.ends_with(".hdr")) {
        line.fail(fmt::format("screenshot \"{}\"; the name must end in .png or .hdr", screenshot.path));
    }
    return screenshot;
}

/// A file name, the rest of the line, that ends in `extension`.
std::string parse_file(Line& line, std::string_view command, std::string_view extension) {
    std::string path(line.rest());
    if (!path.ends_with(extension)) {
        line.fail(fmt::format("{} \"{}\"; the name must end in {}", command, path, extension));
    }
    return path;
}

SetCommand parse_set(Line& line) {
    const std::string_view property = line.word("a property");
    using Property = SetCommand::Property;
    if (property != "reflectance" && property != "exitance" && property != "temperature" &&
        property != "environment") {
        line.fail(fmt::format("property \"{}\"; must be reflectance, exitance, temperature or environment",
                              property));
    }
    SetCommand set{property == "exitance"      ? Property::exitance
                   : property == "temperature" ? Property::temperature
                   : property == "environment" ? Property::environment
                                               : Property::reflectance,
                   {},
                   {}};
    const double most = set.property == Property::reflectance ? 0.999999 : 1e30;
    std::string_view values = line.word("a value");
    while (true) {
        const std::size_t end = std::min(values.find(','), values.size());
        double value = 0.0;
        const auto [last, error] = std::from_chars(values.data(), values.data() + end, value);
        if (error != std::errc() || last != values.data() + end || !(value >= 0.0 && value <= most)) {
            line.fail(fmt::format("\"{}\" as {}; must be a number from 0 to {}", values.substr(0, end),
                                  property, most));
        }
        set.values.push_back(value);
        if (end == values.size()) {
            break;
        }
        values.remove_prefix(end + 1);
    }
    if (set.property == Property::environment) {
        line.end();
    }
    set.name = line.rest();
    return set;
}

ShowCommand parse_show(Line& line) {
    const std::string_view word = line.word("a quantity");
    if (!shown_by_word(word)) {
        std::vector<std::string> all;
        for (const ShownName& name : shown_names()) {
            all.emplace_back(name.word);
        }
        line.fail(fmt::format("quantity \"{}\"; must be one of {}{}", word, fmt::join(all, ", "),
                              did_you_mean(std::string(word), all)));
    }
    return {std::string(word)};
}

MapCommand parse_map(Line& line) {
    const std::string_view word = line.word("a colour map");
    const std::optional<ColourMap> map = from_word<ColourMap>(word);
    if (!map) {
        line.fail(
            fmt::format("colour map \"{}\"; must be one of {}", word, fmt::join(words<ColourMap>(), ", ")));
    }
    return {*map};
}

RangeCommand parse_range(Line& line) {
    if (line.rest() == "auto") {
        (void)line.next();
        return {};
    }
    const double low = line.number("the low end");
    const double high = line.number("the high end");
    if (!(low < high)) {
        line.fail(fmt::format("range {} to {}; must ascend, or be auto", low, high));
    }
    return {std::array{low, high}};
}

BandsCommand parse_bands(Line& line) {
    if (line.rest() == "off") {
        (void)line.next();
        return {0};
    }
    const double count = line.number("the number of bands");
    if (count != std::floor(count) || count < 2.0 || count > 32.0) {
        line.fail(fmt::format("{} bands; must be a whole number from 2 to 32, or off", count));
    }
    return {static_cast<std::uint32_t>(count)};
}

bool parse_on_off(Line& line, std::string_view command) {
    const std::string_view word = line.word("on or off");
    if (word != "on" && word != "off") {
        line.fail(fmt::format("{} \"{}\"; must be on or off", command, word));
    }
    return word == "on";
}

FindingCommand parse_finding(Line& line) {
    const std::string_view word = line.word("a kind of finding");
    const std::optional<Finding> kind = from_word<Finding>(word);
    if (!kind) {
        line.fail(fmt::format("finding \"{}\"; must be one of {}", word, fmt::join(words<Finding>(), ", ")));
    }
    return {*kind, line.size("its number")};
}

ClipCommand parse_clip(Line& line) {
    const std::string word(line.word("a plane"));
    if (word == "patch" || word == "off") {
        return {word == "patch", std::nullopt};
    }
    try {
        return {false, parse_clip_plane(word)};
    } catch (const InvalidArgument& error) {
        line.fail(fmt::format("clip {}, patch or off", error.what()));
    }
}

/// Nothing where the command is not of groups.
std::optional<GroupCommand> parse_group(std::string_view command, Line& line) {
    using Action = GroupCommand::Action;
    constexpr std::array<std::pair<std::string_view, Action>, 6> known{{{"select", Action::select},
                                                                        {"show-group", Action::show},
                                                                        {"outline", Action::outlines},
                                                                        {"hide", Action::hide},
                                                                        {"isolate", Action::isolate},
                                                                        {"show-all", Action::show_all}}};
    for (const auto& [word, action] : known) {
        if (word != command) {
            continue;
        }
        GroupCommand result{action, {}};
        if (action == Action::show_all) {
            line.end();
        } else if ((result.group = line.rest()).empty()) {
            line.fail("a group is missing");
        }
        return result;
    }
    return std::nullopt;
}

ScriptCommand parse_command(std::string_view command, Line& line, std::size_t number) {
    if (command == "screenshot") {
        return {number, parse_screenshot(line)};
    }
    if (command == "set") {
        return {number, parse_set(line)};
    }
    if (std::optional<GroupCommand> of_group = parse_group(command, line)) {
        return {number, *std::move(of_group)};
    }
    if (command == "type") {
        return {number, TypeCommand{std::string(line.rest())}};
    }
    if (command == "windowshot") {
        return {number, WindowshotCommand{parse_file(line, command, ".png")}};
    }
    if (command == "report") {
        return {number, ReportCommand{parse_file(line, command, ".json")}};
    }
    if (command == "drop") {
        const std::string_view path = line.rest();
        if (path.empty()) {
            line.fail("a file is missing");
        }
        return {number, DropCommand{std::string(path)}};
    }
    if (command == "save-probe") {
        return {number, SaveProbeCommand{parse_file(line, command, ".csv")}};
    }
    if (command == "save-result") {
        return {number, SaveResultCommand{parse_file(line, command, ".hres")}};
    }
    if (command == "channel") {
        const std::string_view name = line.rest();
        if (name.empty()) {
            line.fail("a channel is missing");
        }
        return {number, ChannelCommand{std::string(name)}};
    }
    if (command == "dots") {
        const std::string_view name = line.rest();
        if (name.empty()) {
            line.fail("a column is missing");
        }
        return {number, DotsCommand{std::string(name)}};
    }
    if (command == "command") {
        return {number, CommandLineCommand{parse_file(line, command, ".txt")}};
    }
    ScriptCommand result{number, QuitCommand{}};
    if (command == "drag") {
        result.action = parse_drag(line);
    } else if (command == "scroll") {
        const double x = line.number("x");
        const double y = line.number("y");
        result.action = ScrollCommand{x, y, line.number("the amount")};
    } else if (command == "click") {
        const double x = line.number("x");
        result.action = ClickCommand{x, line.number("y")};
    } else if (command == "measure") {
        MeasureCommand measure{};
        for (auto* end : {&measure.from, &measure.to}) {
            (*end)[0] = line.number("x");
            (*end)[1] = line.number("y");
        }
        result.action = measure;
    } else if (command == "move") {
        const double x = line.number("x");
        result.action = MoveCommand{x, line.number("y")};
    } else if (command == "show") {
        result.action = parse_show(line);
    } else if (command == "map") {
        result.action = parse_map(line);
    } else if (command == "range") {
        result.action = parse_range(line);
    } else if (command == "bands") {
        result.action = parse_bands(line);
    } else if (command == "iso-lines") {
        result.action = IsoLinesCommand{parse_on_off(line, command)};
    } else if (command == "difference") {
        result.action = DifferenceCommand{parse_on_off(line, command)};
    } else if (command == "finding") {
        result.action = parse_finding(line);
    } else if (command == "long-work") {
        result.action = LongWorkCommand{line.number("the time")};
    } else if (command == "clip") {
        result.action = parse_clip(line);
    } else if (command == "key") {
        result.action = parse_key(line);
    } else if (command == "resize") {
        const std::uint32_t width = line.size("the width");
        result.action = ResizeCommand{width, line.size("the height")};
    } else if (command == "fov") {
        result.action = FovCommand{line.number("the field of view")};
    } else if (command == "minimise" || command == "restore") {
        result.action = MinimiseCommand{command == "minimise"};
    } else if (command == "reload") {
        result.action = ReloadCommand{};
    } else if (command == "changed") {
        result.action = ChangedCommand{};
    } else if (command == "save-camera") {
        result.action = SaveCameraCommand{};
    } else if (command == "save-materials") {
        result.action = SaveMaterialsCommand{};
    } else if (command == "live") {
        result.action = LiveCommand{};
    } else if (command == "preview") {
        result.action = PreviewCommand{};
    } else if (command == "rows") {
        const double share = line.number("the share");
        if (!(share > 0.0 && share <= 1.0)) {
            line.fail(fmt::format("{} as the share of the rows; must be above 0, at most 1", share));
        }
        result.action = RowsCommand{share};
    } else if (command == "patches") {
        result.action = PatchesCommand{line.size("the number of patches")};
    } else if (command == "wait") {
        result.action = WaitCommand{};
    } else if (command == "cancel") {
        result.action = CancelCommand{};
    } else if (command != "quit") {
        line.fail(fmt::format(
            "command \"{}\"; must be drag, click, move, scroll, key, type, show, channel, map, range, dots, "
            "bands, "
            "iso-lines, difference, finding, long-work, select, show-group, outline, hide, isolate, "
            "show-all, clip, measure, set, "
            "fov, resize, minimise, restore, screenshot, windowshot, report, command, save-result, "
            "save-probe, "
            "save-camera, save-materials, drop, reload, "
            "changed, live, preview, rows, patches, wait, cancel or quit",
            command));
    }
    line.end();
    return result;
}

} // namespace

std::vector<ScriptCommand> parse_script(std::string_view text, const std::string& file) {
    std::vector<ScriptCommand> commands;
    std::size_t number = 0;
    while (!text.empty()) {
        ++number;
        const std::size_t end = std::min(text.find('\n'), text.size());
        Line line(without_comment(text.substr(0, end)), file, number);
        text.remove_prefix(std::min(end + 1, text.size()));
        const auto command = line.next();
        if (command) {
            commands.push_back(parse_command(*command, line, number));
        }
    }
    return commands;
}

} // namespace hemi::viewer
