#pragma once

#include "cli/report/text.hpp"

#include <string>
#include <utility>
#include <vector>

namespace hemi::cli {

/// Wall times by stage, in the order in which they are reported: one line for people, one JSON object for
/// programs.
class Seconds {
public:
    /// @param stages  names of the stages, such as "load"
    explicit Seconds(const std::vector<const char*>& stages) {
        for (const char* const stage : stages) {
            stages_.emplace_back(stage, 0.0);
        }
    }

    /// The time of a stage that was named.
    [[nodiscard]] double& operator[](std::string_view stage);
    [[nodiscard]] std::string summary() const;
    [[nodiscard]] Json json() const;

private:
    std::vector<std::pair<std::string, double>> stages_;
};

} // namespace hemi::cli
