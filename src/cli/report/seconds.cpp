#include "cli/report/seconds.hpp"

#include "hemi/core/error.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace hemi::cli {

std::size_t Seconds::index(std::string_view stage) const {
    const auto found = std::find_if(stages_.begin(), stages_.end(),
                                    [stage](const auto& known) { return known.first == stage; });
    if (found == stages_.end()) {
        throw InvalidArgument(fmt::format("no stage is called {}", stage));
    }
    return static_cast<std::size_t>(found - stages_.begin());
}

Report Seconds::report() const {
    std::string text;
    Json object = Json::object();
    for (const auto& [stage, seconds] : stages_) {
        text += fmt::format("{} {:.3f}, ", stage, seconds);
        object[stage] = seconds;
    }
    const double total = total_.seconds();
    object["total"] = total;
    Report report;
    report.add("seconds", fmt::format("{}total {:.3f}", text, total), {{"seconds", object}});
    return report;
}

} // namespace hemi::cli
