#include "cli/report/seconds.hpp"

#include "hemi/core/error.hpp"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>

namespace hemi::cli {

double& Seconds::operator[](std::string_view stage) {
    const auto found = std::find_if(stages_.begin(), stages_.end(),
                                    [stage](const auto& known) { return known.first == stage; });
    if (found == stages_.end()) {
        throw InvalidArgument(fmt::format("no stage is called {}", stage));
    }
    return found->second;
}

std::string Seconds::summary() const {
    std::string text;
    for (const auto& [stage, seconds] : stages_) {
        text += fmt::format("{}{} {:.3f}", text.empty() ? "" : ", ", stage, seconds);
    }
    return summary_line("seconds", text);
}

Json Seconds::json() const {
    Json object = Json::object();
    for (const auto& [stage, seconds] : stages_) {
        object[stage] = seconds;
    }
    return object;
}

} // namespace hemi::cli
