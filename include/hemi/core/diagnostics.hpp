#pragma once

#include <string>
#include <utility>
#include <vector>

namespace hemi {

/// Things that a person should know but that do not stop the work. The library collects them here and never
/// prints; the program shows them on stderr.
class Diagnostics {
public:
    /// Adds a warning: one sentence, without a line end.
    void warn(std::string message) { warnings_.push_back(std::move(message)); }
    /// All warnings, in the order in which they were given.
    [[nodiscard]] const std::vector<std::string>& warnings() const noexcept { return warnings_; }
    /// Adds a note on what was done as it was asked for: one sentence, without a line end.
    void note(std::string message) { notes_.push_back(std::move(message)); }
    /// All notes, in the order in which they were given.
    [[nodiscard]] const std::vector<std::string>& notes() const noexcept { return notes_; }

private:
    std::vector<std::string> warnings_;
    std::vector<std::string> notes_;
};

} // namespace hemi
