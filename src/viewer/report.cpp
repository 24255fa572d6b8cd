#include "viewer/report.hpp"

#include "hemi/io/output_file.hpp"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>

namespace hemi::viewer {

using Json = nlohmann::ordered_json;

namespace {

Json index_or_null(const std::optional<std::uint32_t>& patch) {
    return patch ? Json(*patch) : Json(nullptr);
}

Json number_or_null(double value) {
    return std::isnan(value) ? Json(nullptr) : Json(value);
}

Json point(const Vec3& p) {
    return {p.x, p.y, p.z};
}

Json dots_json(const Report& report) {
    const Look& look = report.choices.look;
    const std::shared_ptr<const PointTable>& points = report.document.input().points;
    if (!points || !look.dots) {
        return nullptr;
    }
    Json json{{"column", nullptr}, {"under_cursor", nullptr}, {"value", nullptr}};
    if (report.dot_under_cursor) {
        json["under_cursor"] = *report.dot_under_cursor;
    }
    if (look.dots_column) {
        const PointTable::Column& column = points->columns[*look.dots_column];
        json["column"] = column.name;
        if (report.dot_under_cursor && !std::isnan(column.values[*report.dot_under_cursor])) {
            json["value"] = column.values[*report.dot_under_cursor];
        }
    }
    return json;
}

/// Length in scene units.
Json line(const LineProbe& probe, const ShownValues& values) {
    Json json{{"ends", {point(probe.ends[0]), point(probe.ends[1])}},
              {"length", glm::length(probe.ends[1] - probe.ends[0])},
              {"values", Json::array()}};
    for (const ProbePoint& at : probe.points) {
        json["values"].push_back(at.patch ? number_or_null(values.values[*at.patch]) : Json(nullptr));
    }
    return json;
}

Json findings_json(const Findings* findings) {
    if (findings == nullptr) {
        return nullptr;
    }
    Json json = Json::object();
    for (const NamedValue<Finding>& kind : Names<Finding>::table) {
        Json& patches = json[std::string(kind.word)] = Json::array();
        for (const PatchFinding& finding : findings->of(kind.value)) {
            patches.push_back(finding.patch);
        }
    }
    return json;
}

} // namespace

void write_report(const std::filesystem::path& path, const Report& report) {
    Json json{{"schema", "hemi/view/1"},
              {"quantity", name_of(report.choices.look.shown).word},
              {"picked", index_or_null(report.choices.picked)},
              {"pointed_at", index_or_null(report.choices.pointed_at)},
              {"partners", Json::array()},
              {"hemicube", report.seen},
              {"values", nullptr},
              {"scale", nullptr},
              {"radiosity", Json::array()},
              {"residuals", report.document.work().residuals},
              {"light", report.document.work().light},
              {"light_note", report.document.light_note()},
              {"camera",
               {{"eye", point(report.camera.eye)},
                {"target", point(report.camera.target)},
                {"up", point(report.camera.up)},
                {"fov", report.camera.fov},
                {"orthographic", report.camera.orthographic}}},
              {"message", report.message}};
    json["under_cursor"] = nullptr;
    if (report.under_cursor) {
        json["under_cursor"] = {{"patch", report.under_cursor->patch},
                                {"position", point(report.under_cursor->position)}};
    }
    json["dots"] = dots_json(report);
    json["asks_to_close"] = report.asks_to_close;
    json["group"] = index_or_null(report.choices.group);
    json["clip"] = report.choices.cut.clip ? Json(clip_plane_text(*report.choices.cut.clip)) : Json(nullptr);
    json["line"] = report.probe ? line(*report.probe, report.values) : Json(nullptr);
    json["histogram"] = report.histogram;
    json["hides_backs"] = report.hides_backs;
    const std::shared_ptr<const Compared>& compared = report.document.input().compared;
    json["compared"] = compared ? Json(compared->file.string()) : Json(nullptr);
    json["difference"] = shows_difference(report.choices.look);
    json["findings"] = findings_json(report.document.findings());
    json["groups"] = Json::array();
    for (std::uint32_t g = 0; g < report.groups.lines.size(); ++g) {
        const GroupLine& line = report.groups.lines[g];
        json["groups"].push_back({{"name", report.document.input().mesh->groups()[g]},
                                  {"visibility", to_word(report.choices.cut.of_group(g))},
                                  {"area", line.area},
                                  {"mean", number_or_null(line.mean)},
                                  {"net_power", number_or_null(line.net_power)}});
    }
    if (report.picked) {
        for (const Partner& partner : report.picked->partners) {
            json["partners"].push_back(partner.patch);
        }
    }
    if (report.field) {
        json["values"] = Json::array();
        for (const double value : report.field->shown.values) {
            json["values"].push_back(number_or_null(value));
        }
        const ColourScale& scale = report.field->scale;
        json["scale"] = {{"low", scale.low},
                         {"high", scale.high},
                         {"logarithmic", scale.logarithmic},
                         {"map", to_word(scale.map)},
                         {"bands", scale.bands},
                         {"lines", scale.lines ? scale.levels() : std::vector<double>()}};
        json["title"] = report.field->shown.title;
        json["unit"] = report.field->shown.unit;
    }
    const std::uint32_t channels = report.document.input().channels();
    for (std::size_t i = 0; i < report.document.light().radiosity.size(); i += channels) {
        Json patch = Json::array();
        for (std::uint32_t c = 0; c < channels; ++c) {
            patch.push_back(report.document.light().radiosity[i + c]);
        }
        json["radiosity"].push_back(std::move(patch));
    }
    io::OutputFile file(path);
    file.write(json.dump() + "\n");
    file.commit();
}

std::filesystem::path free_name(const std::string& stem, const std::string& extension) {
    for (int number = 1;; ++number) {
        std::filesystem::path path = fmt::format("{}-{:03}{}", stem, number, extension);
        if (!std::filesystem::exists(path)) {
            return path;
        }
    }
}

} // namespace hemi::viewer
