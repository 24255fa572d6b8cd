#pragma once

#include <filesystem>
#include <initializer_list>
#include <span>
#include <string>
#include <string_view>
#include <vector>

/// Output paths, looked at before the work whose outcome they are to hold.
namespace hemi::cli {

/// Extension in lower case with its dot, ".png"; empty for "-".
[[nodiscard]] std::string extension_of(const std::filesystem::path& path);

[[nodiscard]] bool is_standard_output(const std::filesystem::path& path);

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

    /// Tells of a file that is read and that no output may replace.
    void keep(const std::filesystem::path& input);

    [[nodiscard]] bool uses_standard_output() const noexcept { return uses_standard_output_; }

private:
    std::vector<std::filesystem::path> inputs_;
    std::vector<std::filesystem::path> paths_;
    bool uses_standard_output_ = false;
};

} // namespace hemi::cli
