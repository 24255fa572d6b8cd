#include "cli/report/diff_report.hpp"

#include "hemi/core/text.hpp"

#include <fmt/format.h>

#include <cmath>

namespace hemi::cli {

namespace {

std::string percent_text(const GroupDifference& group) {
    return std::isfinite(group.first) && group.first != 0.0
               ? fmt::format("{:+.3g}", 100.0 * group.difference / group.first)
               : "-";
}

std::string pairing_text(const SolutionDifference& found) {
    const std::string size = plural(found.partner.size(), "patch", "patches");
    if (found.pairing == Pairing::same_patches) {
        return fmt::format("{}, the same in both", size);
    }
    return fmt::format(
        "{}, not the same in both: each with the one of the second on which its centre lies{}", size,
        found.off == 0 ? std::string()
                       : fmt::format("; {} with the nearest instead, up to {} away",
                                     plural(found.off, "patch", "patches"), number_text(found.farthest)));
}

} // namespace

Report diff_report(const SolutionDifference& found, std::span<const std::string> names,
                   std::string_view quantity, const std::string& channel, double metres) {
    Report report;
    report.add("patches", pairing_text(found),
               {{"patches", found.partner.size()},
                {"pairing", to_word(found.pairing)},
                {"off", found.off},
                {"farthest", found.farthest}});
    const std::string unit = found.first.unit.empty() ? std::string() : fmt::format(" {}", found.first.unit);
    report.add("quantity", fmt::format("{}{}; differences are second less first", found.first.title, unit),
               {{"quantity", quantity}, {"channel", channel}, {"unit", found.first.unit}});
    Table table({"group", "area m²", fmt::format("first{}", unit), fmt::format("second{}", unit),
                 fmt::format("difference{}", unit), "%", fmt::format("rms{}", unit),
                 fmt::format("largest{}", unit)});
    report.json["groups"] = Json::array();
    const std::initializer_list<const char*> keys{"areas", "difference", "rms", "largest"};
    for (const char* key : keys) {
        report.json[key] = Json::array();
    }
    report.json["means"] = {{"first", Json::array()}, {"second", Json::array()}};
    for (std::size_t g = 0; g < found.groups.size(); ++g) {
        const GroupDifference& group = found.groups[g];
        const bool total = g + 1 == found.groups.size();
        table.add({total ? std::string("(all)") : names[g], number_text(metres * metres * group.area),
                   value_text(group.first), value_text(group.second), value_text(group.difference),
                   percent_text(group), value_text(group.rms), value_text(group.largest)});
        if (total) {
            report.json["all"] = {{"area", group.area},
                                  {"first", value_json(group.first)},
                                  {"second", value_json(group.second)},
                                  {"difference", value_json(group.difference)},
                                  {"rms", value_json(group.rms)},
                                  {"largest", value_json(group.largest)}};
            break;
        }
        report.json["groups"].push_back(names[g]);
        report.json["areas"].push_back(group.area);
        report.json["means"]["first"].push_back(value_json(group.first));
        report.json["means"]["second"].push_back(value_json(group.second));
        report.json["difference"].push_back(value_json(group.difference));
        report.json["rms"].push_back(value_json(group.rms));
        report.json["largest"].push_back(value_json(group.largest));
    }
    report.text += fmt::format("\n{}", table.text());
    return report;
}

} // namespace hemi::cli
