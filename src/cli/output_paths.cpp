#include "cli/output_paths.hpp"

#include "cli/report/text.hpp"
#include "hemi/core/error.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <unistd.h>

namespace hemi::cli {

namespace fs = std::filesystem;

void Outputs::keep(const fs::path& input) {
    inputs_.push_back(io::whole_path(input));
}

void Outputs::add(std::string_view option, const fs::path& path, std::span<const std::string_view> extensions,
                  bool allow_standard_output) {
    if (is_standard_output(path)) {
        if (!allow_standard_output) {
            throw InvalidArgument(fmt::format("{} -: this cannot be written to standard output", option));
        }
        if (uses_standard_output_) {
            throw InvalidArgument(fmt::format("{} -: something else goes to standard output", option));
        }
        uses_standard_output_ = true;
        return;
    }
    const std::string extension = extension_of(path);
    if (std::find(extensions.begin(), extensions.end(), extension) == extensions.end()) {
        throw InvalidArgument(fmt::format("{} {}: the name must end in {}", option, path.string(),
                                          fmt::join(extensions, ", ")));
    }
    std::error_code problem;
    const fs::path directory = path.has_parent_path() ? path.parent_path() : fs::path(".");
    if (!fs::is_directory(directory, problem)) {
        throw IoError(
            fmt::format("{} {}: there is no directory {}", option, path.string(), directory.string()));
    }
    if (fs::is_directory(path, problem)) {
        throw IoError(fmt::format("{} {}: is a directory", option, path.string()));
    }
    if (access(directory.c_str(), W_OK | X_OK) != 0) {
        throw IoError(
            fmt::format("{} {}: {}: {}", option, path.string(), directory.string(), std::strerror(errno)));
    }
    const fs::path whole = io::whole_path(path);
    if (std::find(inputs_.begin(), inputs_.end(), whole) != inputs_.end()) {
        throw InvalidArgument(
            fmt::format("{} {}: is what is read; choose another name", option, path.string()));
    }
    if (std::find(paths_.begin(), paths_.end(), whole) != paths_.end()) {
        throw InvalidArgument(
            fmt::format("{} {}: another output goes to the same file", option, path.string()));
    }
    paths_.push_back(whole);
}

void Outputs::refuse_with_json(bool json) const {
    if (json && uses_standard_output_) {
        throw InvalidArgument("--json and an output to - cannot both go to standard output");
    }
}

void Outputs::show(const Report& report, bool json, const Terminal& terminal) const {
    if (json) {
        print_json(report.json);
    } else if (!terminal.quiet()) {
        if (uses_standard_output_) {
            std::fputs(report.text.c_str(), stderr);
        } else {
            print(report.text);
        }
    }
}

} // namespace hemi::cli
