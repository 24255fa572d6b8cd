#include "cli/report/scene_report.hpp"

#include "cli/report/group_sizes.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <vector>

namespace hemi::cli {

namespace {

std::string values_text(const std::vector<double>& values) {
    std::vector<std::string> words;
    for (const double value : values) {
        words.push_back(number_text(value));
    }
    return fmt::format("{}", fmt::join(words, " "));
}

std::string point_text(const Vec3& point) {
    return fmt::format("{} {} {}", number_text(point.x), number_text(point.y), number_text(point.z));
}

Json point_json(const Vec3& point) {
    return {point.x, point.y, point.z};
}

Report surfaces_report(const PatchMesh& mesh) {
    const std::span<const Surface> surfaces = mesh.surfaces();
    const auto triangles = static_cast<std::size_t>(std::count_if(
        surfaces.begin(), surfaces.end(), [](const Surface& surface) { return surface.vertex_count == 3; }));
    const std::size_t quads = surfaces.size() - triangles;
    Report report;
    report.add("surfaces",
               fmt::format("{} ({}, {})", count_text(surfaces.size()),
                           plural(triangles, "triangle", "triangles"),
                           plural(quads, "quadrilateral", "quadrilaterals")),
               {{"surfaces", surfaces.size()}, {"triangles", triangles}, {"quadrilaterals", quads}});
    return report;
}

Report groups_report(const PatchMesh& mesh) {
    Table table({"group", "surfaces", "patches", "area"});
    Json list = Json::array();
    std::vector<std::uint32_t> surfaces(mesh.groups().size(), 0);
    for (const Surface& surface : mesh.surfaces()) {
        ++surfaces[surface.group];
    }
    const std::vector<GroupSize> sizes = group_sizes(mesh);
    double area = 0.0;
    for (std::size_t g = 0; g < sizes.size(); ++g) {
        const auto& [patches, group_area] = sizes[g];
        const std::string& name = mesh.groups()[g];
        table.add({name, count_text(surfaces[g]), count_text(patches), number_text(group_area)});
        list.push_back(
            {{"name", name}, {"surfaces", surfaces[g]}, {"patches", patches}, {"area", group_area}});
        area += group_area;
    }
    table.add({"(all)", count_text(mesh.surfaces().size()), count_text(mesh.size()), number_text(area)});
    return {fmt::format("\n{}", table.text()), {{"groups", list}}};
}

Report materials_report(const Scene& scene) {
    Table table({"material", "reflectance", "exitance"}, 3);
    Json list = Json::array();
    for (const Material& material : scene.materials) {
        table.add({material.name, values_text(material.reflectance), values_text(material.exitance)});
        list.push_back({{"name", material.name},
                        {"reflectance", material.reflectance},
                        {"exitance", material.exitance}});
    }
    return {fmt::format("\n{}", table.text()), {{"materials", list}}};
}

} // namespace

Report scene_size_report(const PatchMesh& mesh) {
    Report report;
    report.add("scene",
               fmt::format("{}, {}, {}", plural(mesh.size(), "patch", "patches"),
                           plural(mesh.surfaces().size(), "surface", "surfaces"),
                           plural(mesh.groups().size(), "group", "groups")),
               {{"patches", mesh.size()}, {"groups", mesh.groups()}});
    return report;
}

Report contents_report(const Scene& scene, const PatchMesh& mesh, const Report& more) {
    const auto& [lower, upper] = mesh.bounds();
    Report report;
    report.add("name", scene.name.empty() ? "-" : scene.name, {{"name", scene.name}});
    report.add(surfaces_report(mesh));
    report.add("patches", count_text(mesh.size()), {{"patches", mesh.size()}});
    report.add("channels", fmt::format("{}", fmt::join(scene.channels, ", ")),
               {{"channels", scene.channels}});
    report.add("bounds", fmt::format("{} to {}", point_text(lower), point_text(upper)),
               {{"bounds", {{"lower", point_json(lower)}, {"upper", point_json(upper)}}}});
    report.add("enclosure", to_word(scene.enclosure), {{"enclosure", to_word(scene.enclosure)}});
    report.add("environment", values_text(scene.environment), {{"environment", scene.environment}});
    report.add("camera", scene.camera ? "yes" : "no", {{"camera", scene.camera.has_value()}});
    report.add(more);
    report.add(groups_report(mesh));
    report.add(materials_report(scene));
    return report;
}

Report cost_report(const FactorCost& cost, const PatchMesh& mesh) {
    Report report;
    report.add("memory", fmt::format("about {} for {} rows of {:.0f} entries", memory_text(cost.memory),
                                     count_text(mesh.size()), cost.entries_per_row));
    report.add("time", fmt::format("about {} for the rows (measured on {}, {}, {})",
                                   seconds_text(cost.seconds), plural(cost.sampled_rows, "row", "rows"),
                                   cost.renderer, plural(cost.cores, "core", "cores")));
    report.json["estimate"] = {{"measured", true},
                               {"rows", cost.sampled_rows},
                               {"renderer", cost.renderer},
                               {"cores", cost.cores},
                               {"entries_per_row", cost.entries_per_row},
                               {"memory", cost.memory},
                               {"seconds", cost.seconds}};
    return report;
}

} // namespace hemi::cli
