#pragma once

#include "cli/report/report.hpp"
#include "cli/terminal.hpp"
#include "hemi/io/paths.hpp"

#include <filesystem>
#include <initializer_list>
#include <span>
#include <string>
#include <string_view>
#include <vector>

/// Output paths, looked at before the work whose outcome they are to hold.
namespace hemi::cli {

using io::extension_of;
using io::is_standard_output;

/// Output paths of one run.
class Outputs {
public:
    /// Tests that `path` has one of the extensions and can be made or replaced, and that no other output
    /// of this run, and nothing that is read, is there.
    /// @param option  what the path was given as, for messages
    /// @throws InvalidArgument for the extension, a path used twice or one that is read; IoError if it cannot
    /// be written.
    void add(std::string_view option, const std::filesystem::path& path,
             std::span<const std::string_view> extensions, bool allow_standard_output = false);

    void add(std::string_view option, const std::filesystem::path& path,
             std::initializer_list<std::string_view> extensions, bool allow_standard_output = false) {
        add(option, path, std::span(extensions.begin(), extensions.size()), allow_standard_output);
    }

    /// Names a file that is read and that no output may replace.
    void keep(const std::filesystem::path& input);

    [[nodiscard]] bool uses_standard_output() const noexcept { return uses_standard_output_; }
    /// @throws InvalidArgument if an output and --json would both go to standard output
    void refuse_with_json(bool json) const;
    /// Prints the JSON object on stdout, or else the text: on stdout, or on stderr where an output goes to
    /// stdout; no text with -q.
    void show(const Report& report, bool json, const Terminal& terminal) const;

private:
    std::vector<std::filesystem::path> inputs_;
    std::vector<std::filesystem::path> paths_;
    bool uses_standard_output_ = false;
};

} // namespace hemi::cli
