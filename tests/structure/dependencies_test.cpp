#include "structure/source_tree.hpp"

#include <catch2/catch.hpp>

#include <map>
#include <set>
#include <sstream>

using namespace hemi::structure_test;

namespace {

/// What every module may include besides itself. Everything else is a violation: dependencies run down only.
const std::map<std::string, std::set<std::string>> allowed{
    {"core", {}},
    {"scene", {"core"}},
    {"matrix", {"core"}},
    {"gl", {"core"}},
    {"engine", {"core", "scene", "matrix", "gl"}},
    {"solver", {"core", "matrix"}},
    {"io", {"core", "scene", "matrix", "solver"}},
    {"display", {"core", "scene", "gl"}},
    {"pipeline", {"core", "scene", "matrix", "gl", "engine", "solver", "io", "display"}},
    {"worker", {"core", "engine"}},
    {"python", {"core", "scene", "matrix", "engine", "solver", "io", "display", "pipeline"}},
    {"viewer", {"core", "scene", "matrix", "gl", "engine", "solver", "io", "display", "pipeline"}},
    {"cli", {"core", "scene", "matrix", "gl", "engine", "solver", "io", "display", "pipeline", "viewer"}},
    {"mpi", {"core", "cli"}}};

/// Libraries that stay behind one module, by the beginning of the header's name.
const std::map<std::string, std::string> at_home{{"glad/", "gl"},
                                                 {"EGL/", "gl"},
                                                 {"GL/gl.", "gl"},
                                                 {"GL/osmesa", "gl"},
                                                 {"GL/glu.", "io"},
                                                 {"GLFW/", "viewer"},
                                                 {"CLI/", "cli"},
                                                 {"stb_image", "io"},
                                                 {"stb_easy_font", "display"},
                                                 {"tiny_obj", "io"},
                                                 {"zip.h", "io"},
                                                 {"zlib.h", "io"},
                                                 {"pugixml", "io"},
                                                 {"embree3/", "engine"},
                                                 {"imgui", "viewer"},
                                                 {"backends/imgui", "viewer"},
                                                 {"pybind11/", "python"},
                                                 {"mpi.h", "mpi"}};

/// Private headers of the library that the window draws and shows with. The command line and the
/// module of Python use none: they prove that the public ones suffice.
const std::set<std::string> for_the_viewer{"display/colour_scale.hpp",
                                           "display/false_colour_scale.hpp",
                                           "display/legend.hpp",
                                           "display/orbit_camera.hpp",
                                           "display/painted.hpp",
                                           "display/picture_mesh.hpp",
                                           "display/picture_renderer.hpp",
                                           "display/smooth_surfaces.hpp",
                                           "display/visible_point.hpp",
                                           "engine/gathering.hpp",
                                           "engine/hemicube/gl_rows.hpp",
                                           "gl/context.hpp",
                                           "gl/objects.hpp"};

std::vector<std::string> split(const std::string& path) {
    std::vector<std::string> parts;
    std::istringstream stream(path);
    for (std::string part; std::getline(stream, part, '/');) {
        parts.push_back(part);
    }
    return parts;
}

/// Module of a file (src/io/hff.cpp, include/hemi/io/…) or of a quoted include (io/…, hemi/io/…); empty if
/// it is in none.
std::string module_of(const std::string& path) {
    std::vector<std::string> parts = split(path);
    if (!parts.empty() && (parts[0] == "src" || parts[0] == "include")) {
        parts.erase(parts.begin());
    }
    if (!parts.empty() && parts[0] == "hemi") {
        parts.erase(parts.begin());
    }
    return parts.size() >= 2 && allowed.contains(parts[0]) ? parts[0] : "";
}

bool is_standard(const std::string& name) {
    return name.find_first_of("./") == std::string::npos;
}

/// Why the include must not stand in that file; empty if it may.
std::string objection(const SourceFile& file, const Include& include) {
    const std::string module = module_of(file.path);
    const bool is_public = file.path.starts_with("include/");
    if (file.path == "include/hemi/hemi.hpp") {
        return include.quoted && include.name.starts_with("hemi/")
                   ? ""
                   : "it gathers public headers, nothing else";
    }
    if (module.empty()) {
        return "the file is in no module";
    }
    if (!include.quoted) {
        if (is_public && !is_standard(include.name) && !include.name.starts_with("glm/")) {
            return "a public header has no third-party type but GLM's";
        }
        for (const auto& [prefix, home] : at_home) {
            if (include.name.starts_with(prefix) && module != home) {
                return "only " + home + " uses that library";
            }
        }
        return "";
    }
    const std::string used = module_of(include.name);
    if (used.empty()) {
        return "a quoted name begins with a module, or with hemi and a module";
    }
    if (is_public && !include.name.starts_with("hemi/")) {
        return "a public header includes public headers only";
    }
    if (used != module && !allowed.at(module).contains(used)) {
        return module + " must not depend on " + used;
    }
    const bool of_library =
        !include.name.starts_with("hemi/") && used != "cli" && used != "viewer" && used != "python";
    if ((module == "cli" || module == "python") && of_library) {
        return "the command line and the module of Python use public headers of the library only";
    }
    if (module == "viewer" && of_library && !for_the_viewer.contains(include.name)) {
        return "the window uses public headers, and the private ones named in this test";
    }
    return "";
}

std::vector<std::string> objections(const std::vector<SourceFile>& files) {
    std::vector<std::string> all;
    for (const SourceFile& file : files) {
        for (const Include& include : includes_of(file.text)) {
            if (const std::string reason = objection(file, include); !reason.empty()) {
                all.push_back(file.path + ":" + std::to_string(include.line) + ": " + include.name + ": " +
                              reason);
            }
        }
    }
    return all;
}

std::string joined(const std::vector<std::string>& lines) {
    std::string text;
    for (const std::string& line : lines) {
        text += line + "\n";
    }
    return text;
}

} // namespace

TEST_CASE("dependencies: every include in the tree runs down", "[structure]") {
    const auto files = source_files({"include", "src"});
    REQUIRE(files.size() > 100);
    INFO(joined(objections(files)));
    CHECK(objections(files).empty());
}

TEST_CASE("dependencies: the directions themselves have no cycle", "[structure]") {
    std::set<std::string> settled;
    for (std::size_t round = 0; round < allowed.size(); ++round) {
        for (const auto& [module, below] : allowed) {
            if (std::includes(settled.begin(), settled.end(), below.begin(), below.end())) {
                settled.insert(module);
            }
        }
    }
    CHECK(settled.size() == allowed.size());
}

TEST_CASE("dependencies: an include that does not run down is found", "[structure]") {
    struct Case {
        const char* path;
        const char* line;
        bool wrong;
    };
    const std::vector<Case> cases{
        {"src/core/error.cpp", "#include \"hemi/scene/scene.hpp\"", true},
        {"src/solver/solver.cpp", "#include \"hemi/scene/scene.hpp\"", true},
        {"src/solver/solver.cpp", "  #  include   \"hemi/engine/engine.hpp\"", true},
        {"src/matrix/balance.cpp", "#include \"gl/context.hpp\"", true},
        {"src/io/hff.cpp", "#include \"hemi/display/picture.hpp\"", true},
        {"src/viewer/window.cpp", "#include \"cli/report.hpp\"", true},
        {"src/gl/context.cpp", "#include \"hemi/scene/scene.hpp\"", true},
        {"src/engine/eye.cpp", "#include \"eye.hpp\"", true},
        {"src/engine/eye.cpp", "#include \"../core/welder.hpp\"", true},
        {"src/engine/eye.cpp", "#include <glad/gl.h>", true},
        {"src/cli/solve.cpp", "#include \"engine/gathering.hpp\"", true},
        {"src/core/ranks.cpp", "#include <mpi.h>", true},
        {"src/python/scene.cpp", "#include \"core/parallel_for.hpp\"", true},
        {"src/viewer/window.cpp", "#include \"engine/gathering.hpp\"", false},
        {"src/viewer/window.cpp", "#include \"io/formats/chunk_file.hpp\"", true},
        {"src/newcomer/a.cpp", "#include <vector>", true},
        {"src/stray.cpp", "#include <vector>", true},
        {"include/hemi/scene/scene.hpp", "#include \"core/welder.hpp\"", true},
        {"include/hemi/io/result_file.hpp", "#include <nlohmann/json.hpp>", true},
        {"include/hemi/display/picture.hpp", "#include <GL/gl.h>", true},
        {"src/scene/tessellation.cpp", "#include <GL/glu.h>", true},
        {"src/io/meshes/tessellation.cpp", "#include <GL/glu.h>", false},
        {"include/hemi/core/error.hpp", "#include <unistd.h>", true},
        {"include/hemi/solver/solver.hpp", "#include \"hemi/scene/scene.hpp\"", true},
        {"include/hemi/scene/scene.hpp", "#include \"hemi/core/geometry.hpp\"", false},
        {"include/hemi/core/geometry.hpp", "#include <glm/vec3.hpp>", false},
        {"src/engine/eye.cpp", "#include \"engine/eye.hpp\"", false},
        {"src/engine/eye.cpp", "#include <fmt/format.h>", false},
        {"src/cli/main.cpp", "#include \"viewer/viewer.hpp\"", false},
        {"src/engine/eye.cpp", "// #include \"cli/report.hpp\"", false}};
    for (const Case& c : cases) {
        INFO(c.path << ": " << c.line);
        const auto found = objections({{c.path, std::string("#pragma once\n") + c.line + "\n"}});
        CHECK(found.size() == (c.wrong ? 1u : 0u));
    }
}
