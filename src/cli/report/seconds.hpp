#pragma once

#include "cli/report/report.hpp"
#include "hemi/core/stopwatch.hpp"

#include <cstddef>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace hemi::cli {

/// Wall times by stage, in the order in which they are reported; the last is "total", all since it was made.
class Seconds {
public:
    /// @param stages  names of the stages, such as "load"
    explicit Seconds(const std::vector<const char*>& stages) {
        for (const char* const stage : stages) {
            stages_.emplace_back(stage, 0.0);
        }
    }

    /// The time of a stage that was named.
    [[nodiscard]] double& operator[](std::string_view stage) { return stages_[index(stage)].second; }
    [[nodiscard]] double operator[](std::string_view stage) const { return stages_[index(stage)].second; }
    /// The line and the key "seconds".
    [[nodiscard]] Report report() const;

private:
    [[nodiscard]] std::size_t index(std::string_view stage) const;

    Stopwatch total_;
    std::vector<std::pair<std::string, double>> stages_;
};

} // namespace hemi::cli
