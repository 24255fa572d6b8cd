#include "cli/report/scene_report.hpp"

#include "cli/report/group_sizes.hpp"
#include "hemi/core/ranks.hpp"
#include "hemi/scene/light_unit.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
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

Report surfaces_report(const Scene& scene) {
    std::size_t triangles = 0;
    std::size_t quads = 0;
    std::size_t polygons = 0; // in pieces
    const std::vector<Surface>& surfaces = scene.surfaces;
    for (std::size_t s = 0; s < surfaces.size(); ++s) {
        if (surfaces[s].continues) {
            continue;
        }
        if (surfaces[s].joins) {
            triangles += 2;
            continue;
        }
        const bool in_pieces = s + 1 < surfaces.size() && surfaces[s + 1].continues;
        ++(in_pieces ? polygons : surfaces[s].vertex_count == 3 ? triangles : quads);
    }
    const std::size_t all = triangles + quads + polygons;
    Report report;
    report.add(
        "surfaces",
        fmt::format("{} ({}, {}{})", count_text(all), plural(triangles, "triangle", "triangles"),
                    plural(quads, "quadrilateral", "quadrilaterals"),
                    polygons > 0 ? fmt::format(", {} in pieces", count_text(polygons)) : std::string()),
        {{"surfaces", all}, {"triangles", triangles}, {"quadrilaterals", quads}, {"polygons", polygons}});
    return report;
}

/// What the scene repeats itself by, and what need not be computed therefore.
Report symmetry_report(const Scene& scene, const PatchMesh& mesh) {
    Report report;
    report.json["symmetry"] = nullptr;
    if (!scene.symmetry) {
        return report;
    }
    std::vector<std::string> words;
    for (const MirrorPlane& plane : scene.symmetry->mirrors) {
        words.push_back("mirror " + plane_text(plane));
    }
    if (const auto& rotation = scene.symmetry->rotation) {
        words.push_back(fmt::format("{} turns about {}", rotation->folds, axis_text(rotation->axis)));
    }
    for (const Vec3& period : scene.symmetry->periods) {
        words.push_back(fmt::format("{} each way along {}", scene.symmetry->images, point_text(period)));
    }
    const std::size_t images = images_of(*scene.symmetry).all.size();
    report.add("symmetry",
               fmt::format("{} ({}): rows and unknowns for {} of {} patches",
                           plural(images, "image", "images"), fmt::join(words, ", "), count_text(mesh.size()),
                           count_text(images * mesh.size())),
               {{"symmetry", {{"images", images}, {"patches", images * mesh.size()}}}});
    return report;
}

Report groups_report(const Scene& scene, const PatchMesh& mesh, std::span<const double> areas) {
    const double square_metres = std::pow(scene.unit.value_or(1.0), 2.0);
    Table table({"group", "surfaces", "patches", "area m²"});
    Json list = Json::array();
    std::vector<std::uint32_t> surfaces(mesh.groups().size(), 0);
    std::size_t all = 0;
    for (const Surface& surface : scene.surfaces) {
        const std::uint32_t faces = surface.continues ? 0 : surface.joins ? 2 : 1;
        surfaces[surface.group] += faces;
        all += faces;
    }
    const std::vector<GroupSize> sizes = group_sizes(mesh, areas);
    double area = 0.0;
    for (std::size_t g = 0; g < sizes.size(); ++g) {
        const auto& [patches, group_area] = sizes[g];
        const std::string& name = mesh.groups()[g];
        table.add(
            {name, count_text(surfaces[g]), count_text(patches), number_text(square_metres * group_area)});
        list.push_back(
            {{"name", name}, {"surfaces", surfaces[g]}, {"patches", patches}, {"area", group_area}});
        area += group_area;
    }
    table.add({"(all)", count_text(all), count_text(mesh.size()), number_text(square_metres * area)});
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

Report scene_size_report(const LoadedScene& loaded) {
    const PatchMesh& mesh = loaded.patches();
    Report report;
    report.add(
        "scene",
        fmt::format("{}, {}, {}{}{}", plural(mesh.size(), "patch", "patches"),
                    plural(mesh.surfaces().size(), "surface", "surfaces"),
                    plural(mesh.groups().size(), "group", "groups"),
                    mesh.symmetry() ? fmt::format(", {}", plural(images_of(*mesh.symmetry()).all.size(),
                                                                 "image", "images"))
                                    : std::string(),
                    loaded.as_read ? fmt::format("; cut into {}", plural(loaded.mesh.size(), "part", "parts"))
                                   : std::string()),
        {{"patches", mesh.size()}, {"parts", loaded.mesh.size()}, {"groups", mesh.groups()}});
    if (ranks().size() > 1) {
        report.add("ranks", fmt::format("{}, {} on this machine", ranks().size(), ranks().on_machine()));
    }
    return report;
}

Report imprint_report(const LoadedScene& loaded, bool all) {
    Report report;
    report.json["imprint"] = nullptr;
    if (!loaded.as_read) {
        return report;
    }
    const SceneAsRead& as_read = *loaded.as_read;
    struct Kind {
        Imprint::What what;
        const char* word;  ///< in JSON
        const char* one;   ///< what was done to one face
        const char* many;  ///< to several
        const char* other; ///< between a face and the one that does it
    };
    static constexpr Kind kinds[] = {
        {Imprint::What::duplicate, "duplicate", "is left out: others cover it in its plane",
         "are left out: others cover them in their planes", "by"},
        {Imprint::What::overlapped, "overlapped", "is cut where others lie on it in its plane",
         "are cut where others lie on them in their planes", "by"},
        {Imprint::What::cut, "cut", "is cut where others stand on it or pass through it",
         "are cut where others stand on them or pass through them", "by"},
        {Imprint::What::buried, "buried", "is left out: it lies inside another body",
         "are left out: they lie inside other bodies", "by"},
        {Imprint::What::joined, "joined", "becomes the back of one in the same place",
         "become the backs of others in the same places", "of"}};
    const std::vector<std::uint32_t> numbers = face_numbers(as_read.surfaces);
    const auto name = [&](std::uint32_t face) {
        return fmt::format("face {} of {}", numbers[face],
                           as_read.scene.groups[as_read.scene.surfaces[face].group]);
    };
    const auto is_known = [&](std::uint32_t face) { return face < as_read.scene.surfaces.size(); };
    const std::string parts = fmt::format("{} in {}", plural(as_read.mesh.size(), "patch", "patches"),
                                          plural(loaded.mesh.size(), "part", "parts"));
    if (as_read.findings.empty()) {
        report.add("parts", fmt::format("{}, which are plane and convex", parts));
    } else {
        const double square_metres = std::pow(loaded.scene.unit.value_or(1.0), 2.0);
        report.add("faces touch",
                   fmt::format("{}; {} m² are covered", parts, number_text(square_metres * as_read.covered)));
    }
    constexpr std::size_t few = 3;
    Json list = Json::array();
    for (const Kind& kind : kinds) {
        std::string examples;
        std::size_t count = 0;
        for (const Imprint::Finding& finding : as_read.findings) {
            if (finding.what != kind.what) {
                continue;
            }
            if (++count <= few || all) {
                examples += fmt::format("{}{}", count == 1 ? ": " : ", ", name(finding.face));
                examples +=
                    is_known(finding.other) ? fmt::format(" {} {}", kind.other, name(finding.other)) : "";
            }
            list.push_back(
                {{"what", kind.word},
                 {"face", numbers[finding.face]},
                 {"other", is_known(finding.other) ? Json(numbers[finding.other]) : Json(nullptr)}});
        }
        if (count > 0) {
            report.add("", fmt::format("{} {}{}{}", plural(count, "face", "faces"),
                                       count == 1 ? kind.one : kind.many, examples,
                                       count > few && !all ? ", ..." : ""));
        }
    }
    report.json["imprint"] = {{"parts", loaded.mesh.size()}, {"covered", as_read.covered}, {"faces", list}};
    return report;
}

Report contents_report(const Scene& scene, const PatchMesh& mesh, std::span<const double> areas,
                       const Report& more) {
    const auto& [lower, upper] = mesh.bounds();
    Report report;
    report.add("name", scene.name.empty() ? "-" : scene.name, {{"name", scene.name}});
    report.add(surfaces_report(scene));
    report.add("patches", count_text(mesh.size()), {{"patches", mesh.size()}});
    report.add("channels", fmt::format("{}", fmt::join(scene.channels, ", ")),
               {{"channels", scene.channels}});
    report.add("bounds", fmt::format("{} to {}", point_text(lower), point_text(upper)),
               {{"bounds", {{"lower", point_json(lower)}, {"upper", point_json(upper)}}}});
    report.add("enclosure", to_word(scene.enclosure), {{"enclosure", to_word(scene.enclosure)}});
    report.add("environment", values_text(scene.environment), {{"environment", scene.environment}});
    report.add(symmetry_report(scene, mesh));
    if (scene.sun) {
        report.add("sun",
                   fmt::format("{} {}, towards {}{}", values_text(scene.sun->irradiance),
                               irradiance_unit(scene), point_text(scene.sun->direction),
                               scene.sun->diameter > 0.0
                                   ? fmt::format(", {} degrees wide", number_text(scene.sun->diameter))
                                   : ""),
                   {{"sun",
                     {{"direction", point_json(scene.sun->direction)},
                      {"normal_irradiance", scene.sun->irradiance},
                      {"diameter", scene.sun->diameter}}}});
    }
    if (scene.sky) {
        report.add("sky",
                   fmt::format("{}, {} {}", to_word(scene.sky->distribution),
                               values_text(scene.sky->horizontal), irradiance_unit(scene)),
                   {{"sky",
                     {{"distribution", to_word(scene.sky->distribution)},
                      {"horizontal_irradiance", scene.sky->horizontal},
                      {"ground", scene.sky->ground}}}});
    }
    report.add("camera", scene.camera ? "yes" : "no", {{"camera", scene.camera.has_value()}});
    report.add(more);
    report.add(groups_report(scene, mesh, areas));
    report.add(materials_report(scene));
    return report;
}

Report cost_report(const FactorCost& cost, const PatchMesh& mesh) {
    Report report;
    report.add("memory", fmt::format("about {} for {} rows of {:.0f} entries", memory_text(cost.memory),
                                     count_text(mesh.size()), cost.entries_per_row));
    std::vector<std::string> stages;
    Json seconds = Json::object();
    for (const StageCost& stage : cost.stages) {
        stages.push_back(fmt::format("{} {}", to_word(stage.phase), seconds_text(stage.seconds)));
        seconds[std::string(to_word(stage.phase))] = stage.seconds;
    }
    report.add("time", fmt::format("about {} for form factors{} (measured on {}, {}, {})",
                                   seconds_text(cost.all_seconds()),
                                   cost.clusters ? ", far patches seen in clusters" : "",
                                   plural(cost.sampled_rows, "row", "rows"), cost.renderer,
                                   plural(cost.cores, "core", "cores")));
    if (stages.size() > 1) {
        report.add("", fmt::format("{}", fmt::join(stages, ", ")));
    }
    report.json["estimate"] = {{"measured", true},
                               {"rows", cost.sampled_rows},
                               {"renderer", cost.renderer},
                               {"cores", cost.cores},
                               {"entries_per_row", cost.entries_per_row},
                               {"memory", cost.memory},
                               {"clusters", cost.clusters},
                               {"stages", std::move(seconds)},
                               {"seconds", cost.all_seconds()}};
    return report;
}

} // namespace hemi::cli
