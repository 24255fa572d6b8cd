#include "hemi/core/error.hpp"
#include "hemi/io/result_file.hpp"
#include "io/formats/chunk_file.hpp"
#include "io/formats/json_node.hpp"
#include "io/formats/patch_cuts_chunk.hpp"
#include "io/formats/surface_chunk.hpp"
#include "io/scenes/json_symmetry.hpp"

#include <fmt/format.h>

#include <cmath>
#include <functional>
#include <limits>
#include <utility>

namespace hemi::io {

namespace {

constexpr ChunkFormat hres_format{"HEMIRS\r\n", 2, "a solution (.hres)"};
constexpr std::uint64_t most = std::numeric_limits<std::uint32_t>::max();

Json point(const Vec3& p) {
    return Json::array({p.x, p.y, p.z});
}

/// Groups whose error is not a number are null.
Json patch_size_json(const PatchSizeError& error) {
    const auto field = [](const FieldError& of) { return Json{{"rms", of.rms}, {"p95", of.percentile95}}; };
    Json groups = Json::array();
    for (const GroupError& group : error.groups) {
        groups.push_back(std::isfinite(group.patch_size) ? Json::array({group.patch_size, group.factors})
                                                         : Json());
    }
    return {{"vertices", field(error.vertices)},
            {"field", field(error.field)},
            {"groups", std::move(groups)},
            {"sampled", error.sampled}};
}

Json header(const ResultFile& result, const PatchMesh& mesh, const std::optional<PatchMesh>& as_read) {
    const Scene& scene = result.scene;
    const bool heat = !result.solution.temperature.empty();
    Json materials = Json::array();
    for (const Material& material : scene.materials) {
        materials.push_back({{"name", material.name},
                             {"reflectance", material.reflectance},
                             {"exitance", material.exitance}});
        if (heat && !material.emissivity_table.empty()) { // of the reflectance that is at 300 K
            materials.back()["emissivity_by_kelvin"] = material.emissivity_table;
        }
    }
    Json head{{"name", scene.name},
              {"channels", scene.channels},
              {"materials", std::move(materials)},
              {"groups", scene.groups},
              {"enclosure", static_cast<int>(scene.enclosure)},
              {"environment", scene.environment},
              {"surfaces", mesh.surfaces().size()},
              {"patches", mesh.size()},
              {"gathered", !result.solution.vertex_radiosity.empty()},
              {"parts", !mesh.parts().empty()},
              {"solver", to_word(result.solution.method)},
              {"sweeps", result.solution.sweeps},
              {"residual", result.solution.residual},
              {"renderer", result.solution.renderer},
              {"chosen_for", result.solution.chosen_for}};
    if (result.solution.factor_error && result.solution.error) {
        const FactorErrorEstimate& error = *result.solution.factor_error;
        head["error"] = {{"sampled", error.sampled}, {"rms", error.rms},
                         {"max", error.max},         {"row_rms", error.row_rms},
                         {"row_max", error.row_max}, {"radiosity_rms", result.solution.error->rms}};
    }
    if (result.solution.patch_size_error) {
        head["patch_size_error"] = patch_size_json(*result.solution.patch_size_error);
        head["dominance"] = result.solution.dominance;
    }
    if (as_read) {
        head["as_read"] = {{"surfaces", as_read->surfaces().size()}, {"patches", as_read->size()}};
    }
    if (heat) {
        head["heat"] = {{"band_limits", scene.thermal ? scene.thermal->band_limits : std::vector<double>()}};
    }
    if (scene.photometric) {
        head["photometric"] = true;
    }
    if (scene.unit) {
        head["unit"] = *scene.unit;
    }
    if (scene.sun) {
        head["sun"] = {{"direction", point(scene.sun->direction)}, {"irradiance", scene.sun->irradiance}};
        if (scene.sun->diameter > 0.0) {
            head["sun"]["diameter"] = scene.sun->diameter;
        }
    }
    if (scene.sky) {
        head["sky"] = {{"distribution", to_word(scene.sky->distribution)},
                       {"horizontal", scene.sky->horizontal},
                       {"ground", scene.sky->ground}};
    }
    if (!result.solution.direct.empty()) {
        head["direct"] = true;
    }
    if (scene.symmetry) {
        head["symmetry"] = symmetry_json(*scene.symmetry);
    }
    if (scene.up != UpAxis::z) {
        head["up"] = to_word(scene.up);
    }
    if (scene.camera) {
        const Camera& camera = *scene.camera;
        head["camera"] = {{"eye", point(camera.eye)},
                          {"target", point(camera.target)},
                          {"up", point(camera.up)},
                          {"fov", camera.fov},
                          {"orthographic", camera.orthographic}};
    }
    return head;
}

template <class Number>
void check_array(const std::vector<Number>& values, std::size_t size, const char* name) {
    if (values.size() != size) {
        throw InvalidArgument(
            fmt::format("{} values of {}; the solution needs {}", values.size(), name, size));
    }
    for (const Number value : values) {
        if (!std::isfinite(static_cast<double>(value))) {
            throw InvalidArgument(fmt::format("{}: a value of {}; must be finite", name, value));
        }
    }
}

std::vector<std::array<double, 2>> read_emissivity_table(const JsonNode& node) {
    std::vector<std::array<double, 2>> table;
    for (std::size_t k = 0; k < node.size(); ++k) {
        const std::vector<double> pair = node.element(k).numbers();
        const bool sound = pair.size() == 2 && pair[0] >= 0.0 && pair[1] >= 0.0 && pair[1] <= 1.0 &&
                           (table.empty() || pair[0] > table.back()[0]);
        if (!sound) {
            node.element(k).expect("a temperature, K, above those before, and an emissivity in [0, 1]");
        }
        table.push_back({pair[0], pair[1]});
    }
    return table;
}

std::vector<Material> read_materials(const JsonNode& all) {
    std::vector<Material> materials;
    for (std::size_t k = 0; k < all.size(); ++k) {
        const JsonNode node = all.element(k);
        materials.push_back({node.member("name").any_text(), node.member("reflectance").numbers(),
                             node.member("exitance").numbers()});
        if (node.has("emissivity_by_kelvin")) {
            materials.back().emissivity_table = read_emissivity_table(node.member("emissivity_by_kelvin"));
        }
    }
    return materials;
}

Camera read_camera(const JsonNode& node) {
    return {node.member("eye").point(), node.member("target").point(), node.member("up").point(),
            node.member("fov").number(), node.has("orthographic") && node.member("orthographic").boolean()};
}

PatchSizeError read_patch_size(const JsonNode& node) {
    const auto field = [](const JsonNode& of) {
        return FieldError{of.member("rms").number(), of.member("p95").number()};
    };
    PatchSizeError error;
    error.vertices = field(node.member("vertices"));
    error.field = field(node.member("field"));
    const JsonNode groups = node.member("groups");
    for (std::size_t g = 0; g < groups.size(); ++g) {
        const JsonNode group = groups.element(g);
        constexpr double none = std::numeric_limits<double>::quiet_NaN();
        error.groups.push_back(group.value().is_null()
                                   ? GroupError{none, none}
                                   : GroupError{group.element(0).number(), group.element(1).number()});
    }
    error.sampled = static_cast<std::uint32_t>(node.member("sampled").integer(most));
    return error;
}

/// Calls `fail` where errors from the patches' size do not fit the scene, or the errors of form factors.
template <class Fail>
void check_patch_size(const ResultFile& result, const Fail& fail) {
    const std::optional<PatchSizeError>& error = result.solution.patch_size_error;
    if (!error) {
        return;
    }
    if (!result.solution.error) {
        fail("errors from the patches' size without errors from the form factors");
    }
    if (!error->groups.empty() && error->groups.size() != result.scene.groups.size()) {
        fail(fmt::format("errors of {} groups; the scene has {}", error->groups.size(),
                         result.scene.groups.size()));
    }
    for (const FieldError& field : {error->vertices, error->field}) {
        if (!(field.rms >= 0.0) || !(field.percentile95 >= 0.0)) {
            fail(fmt::format("an error of {} and {}; must not be negative", field.rms, field.percentile95));
        }
    }
}

Sky read_sky(const JsonNode& node) {
    const JsonNode word = node.member("distribution");
    const std::optional<SkyDistribution> distribution = from_word<SkyDistribution>(word.any_text());
    if (!distribution) {
        word.expect(fmt::format("one of {}", fmt::join(words<SkyDistribution>(), ", ")));
    }
    return {*distribution, node.member("horizontal").numbers(), node.member("ground").numbers()};
}

/// What the header says of sizes.
struct Sizes {
    std::uint64_t surfaces = 0;
    std::uint64_t patches = 0;
    bool gathered = false;              ///< there is radiosity at vertices
    bool parts = false;                 ///< patches of some surfaces differ in size
    bool direct = false;                ///< there is irradiance of sun and sky
    bool heat = false;                  ///< there are temperatures and net fluxes
    std::uint64_t surfaces_as_read = 0; ///< 0: the surfaces are as they were read
    std::uint64_t patches_as_read = 0;
};

Sizes read_header(const JsonNode& head, ResultFile& result) {
    Scene& scene = result.scene;
    scene.name = head.member("name").any_text();
    scene.channels = head.member("channels").texts();
    scene.materials = read_materials(head.member("materials"));
    scene.groups = head.member("groups").texts();
    scene.enclosure = static_cast<Enclosure>(head.member("enclosure").integer(2));
    scene.environment = head.member("environment").numbers();
    if (head.has("up")) {
        const JsonNode up = head.member("up");
        const std::optional<UpAxis> axis = from_word<UpAxis>(up.any_text());
        if (!axis) {
            up.expect("y or z");
        }
        scene.up = *axis;
    }
    if (head.has("symmetry")) {
        scene.symmetry = read_symmetry(head.member("symmetry"));
    }
    if (head.has("camera")) {
        scene.camera = read_camera(head.member("camera"));
    }
    if (head.has("heat")) {
        const JsonNode heat = head.member("heat");
        const JsonNode limits = heat.member("band_limits");
        const std::vector<double> values = limits.numbers();
        if (!(values.empty() || values.size() + 1 == scene.channels.size()) ||
            !std::is_sorted(values.begin(), values.end(), std::less_equal<>()) ||
            (!values.empty() && !(values.front() > 0.0))) {
            limits.expect(fmt::format("none, or the {} limits between the channels, above 0 and ascending",
                                      scene.channels.size() - 1));
        }
        scene.thermal = Thermal{values, {}, std::nullopt};
    }
    scene.photometric = head.has("photometric") && head.member("photometric").boolean();
    if (head.has("unit")) {
        scene.unit = head.member("unit").positive();
    }
    if (head.has("sun")) {
        const JsonNode sun = head.member("sun");
        scene.sun = Sun{sun.member("direction").point(), sun.member("irradiance").numbers(),
                        sun.has("diameter") ? sun.member("diameter").number() : 0.0};
    }
    if (head.has("sky")) {
        scene.sky = read_sky(head.member("sky"));
    }
    result.solution.channels = static_cast<std::uint32_t>(scene.channels.size());
    const std::optional<SolverMethod> method = from_word<SolverMethod>(head.member("solver").any_text());
    if (!method) {
        head.member("solver").expect(fmt::format("one of {}", fmt::join(words<SolverMethod>(), ", ")));
    }
    result.solution.method = *method;
    result.solution.sweeps = static_cast<std::uint32_t>(head.member("sweeps").integer(most));
    result.solution.residual = head.member("residual").number();
    result.solution.renderer = head.member("renderer").any_text();
    result.solution.chosen_for = head.member("chosen_for").any_text();
    if (head.has("error")) {
        const JsonNode error = head.member("error");
        result.solution.factor_error =
            FactorErrorEstimate{static_cast<std::uint32_t>(error.member("sampled").integer(most)),
                                error.member("rms").number(),
                                error.member("max").number(),
                                error.member("row_rms").number(),
                                error.member("row_max").number(),
                                {}};
        result.solution.error = RadiosityErrorEstimate{error.member("radiosity_rms").number(), {}};
    }
    if (head.has("patch_size_error")) {
        result.solution.patch_size_error = read_patch_size(head.member("patch_size_error"));
        result.solution.dominance = head.member("dominance").number();
    }
    Sizes sizes{head.member("surfaces").integer(most),
                head.member("patches").integer(most),
                head.has("gathered") && head.member("gathered").boolean(),
                head.has("parts") && head.member("parts").boolean(),
                head.has("direct") && head.member("direct").boolean(),
                head.has("heat")};
    if (head.has("as_read")) {
        const JsonNode as_read = head.member("as_read");
        sizes.surfaces_as_read = as_read.member("surfaces").integer(most);
        sizes.patches_as_read = as_read.member("patches").integer(most);
    }
    return sizes;
}

std::vector<std::uint32_t> groups_of_patches(const PatchMesh& mesh) {
    std::vector<std::uint32_t> result;
    for (std::uint32_t i = 0; i < mesh.size(); ++i) {
        result.push_back(mesh.group(i));
    }
    return result;
}

/// Patches that a scene as it was read may have: memory goes with them, and what is left of them is in the
/// file.
std::uint64_t most_patches_as_read(std::uint64_t parts) {
    return (std::uint64_t{1} << 20) + 64 * parts;
}

/// @throws InvalidArgument where a part is of no patch
void check_patches_as_read(const PatchParts& parts) {
    for (const std::uint32_t patch : parts.patch_of) {
        if (patch >= parts.patches()) {
            throw InvalidArgument(fmt::format("a part of patch {} of {}", patch, parts.patches()));
        }
    }
}

/// @param unknown  values that are not a number are sound
template <class Number = double>
std::vector<Number> read_array(ChunkReader& reader, std::string_view tag, std::uint64_t size,
                               bool unknown = false) {
    Payload payload = reader.chunk(tag);
    std::vector<Number> values = payload.take_array<Number>(size);
    payload.expect_end();
    for (const Number value : values) {
        const auto number = static_cast<double>(value);
        if (!std::isfinite(number) && !(unknown && std::isnan(number))) {
            payload.fail("a value that is not finite");
        }
    }
    return values;
}

/// What heat is, where it is known: not a number elsewhere.
void check_heat(const Solution& solution, std::size_t patches, std::size_t channels) {
    constexpr double any = -std::numeric_limits<double>::infinity();
    const auto check = [](const std::vector<double>& values, const char* name, std::size_t size,
                          double least) {
        if (values.size() != size) {
            throw InvalidArgument(
                fmt::format("{} values of {}; the solution needs {}", values.size(), name, size));
        }
        for (const double value : values) {
            if (std::isinf(value) || value < least) {
                throw InvalidArgument(fmt::format("{}: a value of {}", name, value));
            }
        }
    };
    check(solution.temperature, "temperature", patches, 0.0);
    check(solution.net_flux, "net flux", patches, any);
    check(solution.radiosity, "radiosity", patches * channels, any);
    check(solution.irradiance, "irradiance", patches * channels, any);
    check(solution.exitance, "exitance", patches * channels, any);
}

} // namespace

Scene ResultFile::scene_as_read() const {
    Scene result = scene;
    result.surfaces = surfaces_as_read.empty() ? scene.surfaces : surfaces_as_read;
    return result;
}

PatchMesh ResultFile::patches_as_read() const {
    return surfaces_as_read.empty() ? PatchMesh(scene, subdivision)
                                    : PatchMesh(scene_as_read()).whole_faces().mesh;
}

void complete_solution(ResultFile& result, const PatchMesh& mesh) {
    if (result.solution.exitance.empty()) {
        result.solution.exitance = patch_values(mesh, result.scene.materials, &Material::exitance);
    }
}

void write_hres(const std::filesystem::path& path, const ResultFile& result) {
    const PatchMesh mesh(result.scene, result.subdivision);
    const bool heat = !result.solution.temperature.empty();
    std::optional<PatchMesh> as_read;
    if (!result.surfaces_as_read.empty()) {
        as_read.emplace(result.scene_as_read());
        check_array(result.parts.patch_of, mesh.size(), "the patches that parts are of");
        check_patches_as_read({result.parts.patch_of, groups_of_patches(as_read->whole_faces().mesh)});
        if (as_read->size() > most_patches_as_read(mesh.size())) {
            throw InvalidArgument(
                fmt::format("{} patches, of which {} parts are left; at most {} can be stored",
                            as_read->size(), mesh.size(), most_patches_as_read(mesh.size())));
        }
    }
    const std::size_t patches = mesh.size();
    const std::size_t values = patches * result.scene.channels.size();
    if (heat) {
        check_heat(result.solution, patches, result.scene.channels.size());
    } else {
        check_array(result.solution.radiosity, values, "radiosity");
        check_array(result.solution.irradiance, values, "irradiance");
    }
    check_array(result.solution.row_sum, patches, "row sum");
    check_array(result.solution.environment_share, patches, "environment share");
    check_array(result.solution.back_face_share, patches, "blocked share");
    check_array(std::vector{result.solution.residual}, 1, "residual");
    const bool estimated = result.solution.factor_error && result.solution.error;
    if (estimated) {
        check_array(result.solution.factor_error->rows, patches, "error of a row");
        check_array(result.solution.error->patches, values, "error of the radiosity");
    }

    check_patch_size(result, [](const std::string& what) { throw InvalidArgument(what); });
    if (result.solution.patch_size_error) {
        check_array(result.solution.patch_size_error->patches, values, "error from the patches' size");
    }
    if (!result.solution.vertex_radiosity.empty()) {
        check_array(result.solution.vertex_radiosity, values * 4, "radiosity at vertices");
    }
    if (!result.solution.direct.empty()) {
        check_array(result.solution.direct, values, "irradiance of sun and sky");
    }

    ChunkWriter writer(path, hres_format);
    writer.chunk("HEAD", {bytes_of(json_text(header(result, mesh, as_read)))});
    if (!mesh.parts().empty()) {
        writer.chunk("PART", {bytes_of(stored_parts(mesh.parts()))});
    }
    writer.chunk("SURF", {bytes_of(stored_surfaces(mesh))});
    if (as_read) {
        writer.chunk("READ", {bytes_of(stored_surfaces(*as_read))});
        writer.chunk("OFPA", {bytes_of(result.parts.patch_of)});
    }
    writer.chunk("RADI", {bytes_of(result.solution.radiosity)});
    writer.chunk("IRRA", {bytes_of(result.solution.irradiance)});
    writer.chunk("RSUM", {bytes_of(result.solution.row_sum)});
    writer.chunk("ENVI", {bytes_of(result.solution.environment_share)});
    writer.chunk("BLOC", {bytes_of(result.solution.back_face_share)});
    if (estimated) {
        writer.chunk("RERR", {bytes_of(result.solution.factor_error->rows)});
        writer.chunk("BERR", {bytes_of(result.solution.error->patches)});
    }
    if (result.solution.patch_size_error) {
        writer.chunk("PERR", {bytes_of(result.solution.patch_size_error->patches)});
    }
    if (!result.solution.vertex_radiosity.empty()) {
        writer.chunk("VERT", {bytes_of(result.solution.vertex_radiosity)});
    }
    if (!result.solution.direct.empty()) {
        writer.chunk("DIRE", {bytes_of(result.solution.direct)});
    }
    if (heat) {
        writer.chunk("EXIT", {bytes_of(result.solution.exitance)});
        writer.chunk("TEMP", {bytes_of(result.solution.temperature)});
        writer.chunk("FLUX", {bytes_of(result.solution.net_flux)});
    }
    writer.finish();
}

ResultFile read_hres(const std::filesystem::path& path) {
    ChunkReader reader(path, hres_format);
    ResultFile result;
    const Json document = parse_json(reader.chunk("HEAD").text(), reader.file());
    const Sizes sizes = read_header(JsonNode(document, reader.file()), result);
    check_patch_size(result, [&reader](const std::string& what) { reader.fail(what); });
    // Before meshes are made, for which a few surfaces can ask for much memory.
    constexpr std::uint64_t least_bytes = 5 * sizeof(double); // of a patch, in chunks that are always there
    if (sizes.patches > reader.file_size() / least_bytes ||
        sizes.patches_as_read > most_patches_as_read(sizes.patches)) {
        reader.fail(fmt::format("{} patches, {} as they were read, in a file of {} bytes; that cannot be",
                                sizes.patches, sizes.patches_as_read, reader.file_size()));
    }
    if (sizes.parts) {
        result.subdivision.parts = read_parts(reader.chunk("PART"), sizes.surfaces, sizes.patches);
    }
    result.scene.surfaces =
        read_surfaces(reader.chunk("SURF"), sizes.surfaces, sizes.patches, result.subdivision.parts);
    if (sizes.surfaces_as_read > 0) {
        result.surfaces_as_read =
            read_surfaces(reader.chunk("READ"), sizes.surfaces_as_read, sizes.patches_as_read, {});
        result.parts.patch_of = read_array<std::uint32_t>(reader, "OFPA", sizes.patches);
    }
    try {
        validate(result.scene);
        if (sizes.surfaces_as_read > 0) {
            const Scene as_read = result.scene_as_read();
            validate(as_read);
            result.parts.group_of = groups_of_patches(PatchMesh(as_read).whole_faces().mesh);
            check_patches_as_read(result.parts);
        }
        if (sizes.parts) {
            (void)PatchMesh(result.scene, result.subdivision); // whether parts fill their surfaces
        }
    } catch (const InputError& error) {
        reader.fail(error.what());
    } catch (const InvalidArgument& error) {
        reader.fail(error.what());
    }
    const std::uint64_t values = sizes.patches * result.scene.channels.size();
    result.solution.radiosity = read_array(reader, "RADI", values, sizes.heat);
    result.solution.irradiance = read_array(reader, "IRRA", values, sizes.heat);
    result.solution.row_sum = read_array(reader, "RSUM", sizes.patches);
    result.solution.environment_share = read_array(reader, "ENVI", sizes.patches);
    result.solution.back_face_share = read_array(reader, "BLOC", sizes.patches);
    if (result.solution.factor_error) {
        result.solution.factor_error->rows = read_array(reader, "RERR", sizes.patches);
        result.solution.error->patches = read_array(reader, "BERR", values);
    }
    if (result.solution.patch_size_error) {
        result.solution.patch_size_error->patches = read_array(reader, "PERR", values);
    }
    if (sizes.gathered) {
        result.solution.vertex_radiosity = read_array<float>(reader, "VERT", values * 4);
    }
    if (sizes.direct) {
        result.solution.direct = read_array(reader, "DIRE", values);
    }
    if (sizes.heat) {
        result.solution.exitance = read_array(reader, "EXIT", values, true);
        result.solution.temperature = read_array(reader, "TEMP", sizes.patches, true);
        result.solution.net_flux = read_array(reader, "FLUX", sizes.patches, true);
        try {
            check_heat(result.solution, sizes.patches, result.scene.channels.size());
        } catch (const InvalidArgument& error) {
            reader.fail(error.what());
        }
    }
    reader.finish();
    return result;
}

} // namespace hemi::io
