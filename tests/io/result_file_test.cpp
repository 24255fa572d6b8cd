#include "hemi/io/result_file.hpp"

#include "chunk_surgery.hpp"
#include "io_fixtures.hpp"

namespace hemi::io_test {

namespace {

io::ResultFile sample() {
    io::ResultFile result;
    Scene& scene = result.scene;
    scene.name = "room \"1\"";
    scene.channels = {"short", "long, far"};
    scene.materials = {{"white", {0.7, 0.1}, {0.0, 0.0}}, {"lamp", {0.0, 0.3}, {1.0 / 3.0, 8.0}}};
    scene.groups = {"floor", "lid, \"top\""};
    Surface floor;
    floor.vertices = {Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(1, 1, 0), Vec3(0, 1, 0)};
    floor.patches = Grid{3, 2};
    Surface lid;
    lid.vertices = {Vec3(0, 0, 1), Vec3(0, 1, 1), Vec3(1.0 / 3.0, 0, 1), Vec3(0)};
    lid.vertex_count = 3;
    lid.material = 1;
    lid.group = 1;
    lid.two_sided = true;
    scene.surfaces = {floor, lid};
    scene.patch_size = 0.4;
    scene.enclosure = Enclosure::open;
    scene.environment = {0.1, 0.2};
    scene.up = UpAxis::y;
    scene.unit = 1e-3;
    scene.sun = Sun{{0.0, 0.6, 0.8}, {700.0, 90.0}, 0.53};
    scene.camera = Camera{{0, -3, 1}, {0, 0, 0.1}, {0, 0.1, 1}, 33.3};
    const std::size_t patches = PatchMesh(scene).size();
    for (std::size_t i = 0; i < patches * 2; ++i) {
        result.solution.radiosity.push_back(1.0 / static_cast<double>(i + 1));
        result.solution.irradiance.push_back(std::sqrt(static_cast<double>(i)));
    }
    for (std::size_t i = 0; i < patches; ++i) {
        result.solution.row_sum.push_back(0.9 + 1e-9 * static_cast<double>(i));
        result.solution.environment_share.push_back(0.01);
        result.solution.back_face_share.push_back(0.0);
    }
    result.solution.method = SolverMethod::gauss_seidel;
    result.solution.sweeps = 17;
    result.solution.residual = 1.23456789e-7;
    result.solution.renderer = "Some Renderer";
    result.solution.chosen_for = "--error-target 1e-3";
    result.solution.factor_error =
        FactorErrorEstimate{5, 1e-5, 0.25, 2e-4, 0.5, std::vector<double>(patches, 1e-3)};
    result.solution.error = RadiosityErrorEstimate{1.0 / 3.0, std::vector<double>(patches * 2, 0.125)};
    result.solution.dominance = 0.7;
    result.solution.patch_size_error =
        PatchSizeError{{0.1, 1.0 / 7.0}, {0.2, 0.3}, {{0.01, 0.02}, {NAN, NAN}}, {}, 64, 0.0};
    result.solution.patch_size_error->patches.assign(patches * 2, 1.0 / 9.0);
    for (std::size_t k = 0; k < patches * 8; ++k) {
        result.solution.vertex_radiosity.push_back(1.0F / static_cast<float>(k + 3));
    }
    return result;
}

/// As many values as another number of patches needs.
void fit(Solution& solution, std::size_t patches) {
    solution.radiosity.resize(patches * 2);
    solution.irradiance.resize(patches * 2);
    solution.row_sum.resize(patches);
    solution.environment_share.resize(patches);
    solution.back_face_share.resize(patches);
    solution.factor_error->rows.resize(patches);
    solution.error->patches.resize(patches * 2);
    solution.patch_size_error->patches.resize(patches * 2);
    solution.vertex_radiosity.resize(patches * 8);
}

} // namespace

TEST_CASE("HRES: what is written is read back bit for bit", "[io]") {
    const Folder folder;
    const io::ResultFile a = sample();
    io::write_hres(folder / "a.hres", a);
    const io::ResultFile b = io::read_hres(folder / "a.hres");
    REQUIRE(a.scene.name == b.scene.name);
    REQUIRE(a.scene.channels == b.scene.channels);
    REQUIRE(a.solution.vertex_radiosity == b.solution.vertex_radiosity);
    REQUIRE(a.scene.materials == b.scene.materials);
    REQUIRE(a.scene.groups == b.scene.groups);
    REQUIRE(a.scene.enclosure == b.scene.enclosure);
    REQUIRE(a.scene.environment == b.scene.environment);
    REQUIRE(b.scene.up == UpAxis::y);
    REQUIRE(b.scene.unit == 1e-3);
    REQUIRE(a.scene.sun == b.scene.sun);
    REQUIRE(a.scene.camera->eye == b.scene.camera->eye);
    REQUIRE(a.scene.camera->target == b.scene.camera->target);
    REQUIRE(a.scene.camera->up == b.scene.camera->up);
    REQUIRE(a.scene.camera->fov == b.scene.camera->fov);
    REQUIRE(b.scene.surfaces.size() == 2);
    for (std::size_t s = 0; s < 2; ++s) {
        REQUIRE(a.scene.surfaces[s].vertices == b.scene.surfaces[s].vertices);
        REQUIRE(a.scene.surfaces[s].vertex_count == b.scene.surfaces[s].vertex_count);
        REQUIRE(a.scene.surfaces[s].material == b.scene.surfaces[s].material);
        REQUIRE(a.scene.surfaces[s].group == b.scene.surfaces[s].group);
        REQUIRE(a.scene.surfaces[s].two_sided == b.scene.surfaces[s].two_sided);
    }
    REQUIRE(a.solution.radiosity == b.solution.radiosity);
    REQUIRE(a.solution.irradiance == b.solution.irradiance);
    REQUIRE(a.solution.chosen_for == b.solution.chosen_for);
    REQUIRE(b.solution.factor_error.has_value());
    REQUIRE(a.solution.factor_error->sampled == b.solution.factor_error->sampled);
    REQUIRE(a.solution.factor_error->rms == b.solution.factor_error->rms);
    REQUIRE(a.solution.factor_error->max == b.solution.factor_error->max);
    REQUIRE(a.solution.factor_error->row_rms == b.solution.factor_error->row_rms);
    REQUIRE(a.solution.factor_error->row_max == b.solution.factor_error->row_max);
    REQUIRE(a.solution.factor_error->rows == b.solution.factor_error->rows);
    REQUIRE(a.solution.error->rms == b.solution.error->rms);
    REQUIRE(a.solution.dominance == b.solution.dominance);
    REQUIRE(b.solution.patch_size_error.has_value());
    const PatchSizeError& is = *b.solution.patch_size_error;
    const PatchSizeError& was = *a.solution.patch_size_error;
    REQUIRE(is.vertices.rms == was.vertices.rms);
    REQUIRE(is.vertices.percentile95 == was.vertices.percentile95);
    REQUIRE(is.field.rms == was.field.rms);
    REQUIRE(is.field.percentile95 == was.field.percentile95);
    REQUIRE(is.sampled == was.sampled);
    REQUIRE(is.patches == was.patches);
    REQUIRE(is.groups.size() == was.groups.size());
    REQUIRE(is.groups[0].patch_size == was.groups[0].patch_size);
    REQUIRE(is.groups[0].factors == was.groups[0].factors);
    REQUIRE(std::isnan(is.groups[1].patch_size));
    REQUIRE(a.solution.error->patches == b.solution.error->patches);
    REQUIRE(a.solution.row_sum == b.solution.row_sum);
    REQUIRE(a.solution.environment_share == b.solution.environment_share);
    REQUIRE(a.solution.back_face_share == b.solution.back_face_share);
    REQUIRE(a.solution.method == b.solution.method);
    REQUIRE(a.solution.sweeps == b.solution.sweeps);
    REQUIRE(a.solution.residual == b.solution.residual);
    REQUIRE(a.solution.renderer == b.solution.renderer);
}

TEST_CASE("HRES: the patches are those that were solved, however they were asked for", "[io]") {
    const Folder folder;
    for (const Subdivision& subdivision : {Subdivision{}, Subdivision{0.3, {}}, Subdivision{{}, 5}}) {
        io::ResultFile a = sample();
        a.subdivision = subdivision;
        const PatchMesh mesh(a.scene, a.subdivision);
        fit(a.solution, mesh.size());
        io::write_hres(folder / "a.hres", a);
        const io::ResultFile b = io::read_hres(folder / "a.hres");
        const PatchMesh again(b.scene, b.subdivision);
        REQUIRE(again.size() == mesh.size());
        REQUIRE(again.geometry_hash() == mesh.geometry_hash());
    }
}

TEST_CASE("HRES: heat has temperatures, net fluxes and its own exitance, unknown where patches are buried",
          "[io]") {
    const Folder folder;
    io::ResultFile a = sample();
    io::write_hres(folder / "light.hres", a);
    CHECK(io::read_hres(folder / "light.hres").solution.temperature.empty());
    Solution& heat = a.solution;
    heat.temperature.assign(heat.row_sum.size(), 300.0);
    heat.net_flux.assign(heat.row_sum.size(), -1.0 / 3.0);
    heat.exitance.assign(heat.radiosity.size(), 1.0 / 7.0);
    heat.temperature[1] = heat.net_flux[1] = heat.radiosity[2] = heat.irradiance[3] = NAN;
    a.scene.thermal = Thermal{{4.0}, {}, 280.0};
    a.scene.materials[0].reflectance[1] = 1.0; // adiabatic
    a.scene.materials[0].emissivity_table = {{250.0, 0.1}, {350.0, 0.3}};
    io::write_hres(folder / "a.hres", a);
    io::ResultFile b = io::read_hres(folder / "a.hres");
    REQUIRE(b.solution.temperature.size() == heat.temperature.size());
    CHECK(b.solution.temperature[0] == 300.0);
    CHECK(std::isnan(b.solution.temperature[1]));
    CHECK(b.solution.net_flux[0] == heat.net_flux[0]);
    CHECK(std::isnan(b.solution.net_flux[1]));
    CHECK(std::isnan(b.solution.radiosity[2]));
    CHECK(b.solution.radiosity[3] == heat.radiosity[3]);
    CHECK(std::isnan(b.solution.irradiance[3]));
    CHECK(b.scene.thermal == Thermal{{4.0}, {}, std::nullopt});
    CHECK(b.scene.materials == a.scene.materials);
    const std::vector<double> exitance = heat.exitance;
    io::complete_solution(b, PatchMesh(b.scene, b.subdivision));
    CHECK(b.solution.exitance == exitance);

    for (const std::vector<double>& limits : {std::vector{4.0, 5.0}, std::vector{-1.0}}) {
        io::ResultFile bad = a;
        bad.scene.thermal = Thermal{limits, {}, std::nullopt};
        io::write_hres(folder / "limits.hres", bad);
        require_parts(message_of<InputError>([&] { (void)io::read_hres(folder / "limits.hres"); }),
                      {"limits.hres", "band_limits", "above 0 and ascending"});
    }

    const auto refusal = [&](double temperature, double flux) {
        io::ResultFile bad = a;
        bad.solution.temperature[0] = temperature;
        bad.solution.net_flux[0] = flux;
        return message_of<InvalidArgument>([&] { io::write_hres(folder / "bad.hres", bad); });
    };
    require_parts(refusal(-1.0, 0.0), {"temperature: a value of -1"});
    require_parts(refusal(INFINITY, 0.0), {"temperature: a value of inf"});
    require_parts(refusal(1.0, -INFINITY), {"net flux: a value of -inf"});
    const std::string bytes = io::read_file(folder / "a.hres");
    const std::vector<std::pair<std::string, double>> lies{{"TEMP", -1.0}, {"FLUX", INFINITY}};
    for (const auto& [tag, value] : lies) {
        int chunk = 0;
        while (bytes.substr(chunk_start(bytes, chunk), 4) != tag) {
            ++chunk;
        }
        (void)message_of<InputError>([&] {
            (void)io::read_hres(folder.write("lie.hres", with_payload(bytes, chunk, 0, raw(value))));
        });
    }
}

TEST_CASE("HRES: a scene without a camera stays without one", "[io]") {
    const Folder folder;
    io::ResultFile a = sample();
    a.scene.camera.reset();
    io::write_hres(folder / "a.hres", a);
    REQUIRE_FALSE(io::read_hres(folder / "a.hres").scene.camera.has_value());
}

TEST_CASE("HRES: files cut short and flipped bits are refused", "[io]") {
    const Folder folder;
    io::write_hres(folder / "a.hres", sample());
    const std::string bytes = io::read_file(folder / "a.hres");
    for (std::size_t position = 0; position < bytes.size(); position += position < 900 ? 1 : 11) {
        INFO("byte " << position);
        const auto cut = folder.write("cut.hres", bytes.substr(0, position));
        require_parts(message_of<InputError>([&] { (void)io::read_hres(cut); }), {"cut.hres: "});
        std::string flipped = bytes;
        flipped[position] = static_cast<char>(flipped[position] ^ (1 << position % 8));
        const auto path = folder.write("flipped.hres", flipped);
        require_parts(message_of<InputError>([&] { (void)io::read_hres(path); }), {"flipped.hres: "});
    }
    const auto hff = folder.write("x.hres", "HEMIFF\r\n" + std::string(20, '\0'));
    require_parts(message_of<InputError>([&] { (void)io::read_hres(hff); }),
                  {"does not hold a solution (.hres)"});
}

TEST_CASE("HRES: lies with a right checksum are noticed, and cost no memory", "[io]") {
    const Folder folder;
    io::write_hres(folder / "a.hres", sample());
    const std::string bytes = io::read_file(folder / "a.hres");
    const std::size_t counts = 12 * 8; // of the first surface
    const auto head = [&bytes](const std::string& text) {
        const std::size_t at = bytes.find(text);
        REQUIRE(at != std::string::npos);
        return at - chunk_start(bytes, 0) - 16;
    };
    struct Bad {
        int chunk;
        std::size_t offset;
        std::string change;
        std::string part;
    };
    const std::vector<Bad> table{
        {0, 2, "nome", "\"name\" is missing"},
        {0, head("\"groups\":[[0.01") + 21, std::string(5, ' '), "errors of 1 groups; the scene has 2"},
        {0, head("\"p95\":0.3}") + 6, "-3 ", "must not be negative"},
        {0, head("\"error\":{") + 1, "erroR", "without errors from the form factors"},
        {1, 0, raw(std::nan("")), "vertex 0 is not finite"},
        {1, 0, raw(3.0), "surface 0 (group \"floor\"): not convex"},
        {1, counts, raw(5u), "chunk SURF: a surface of 5 vertices"},
        {1, counts + 4, raw(2u), "material"},
        {1, counts + 8, raw(2u), "group"},
        {1, counts + 12, raw(8u), "sides 8"},
        {1, counts + 16, raw(4u), "chunk SURF: the surfaces have not the"},
        {1, counts + 16, raw(0xFFFFFFFFFFFFFFFFu), "chunk SURF: the surfaces have not the"},
        {1, counts + 16, raw(0u), "chunk SURF: the surfaces have not the"},
        {2, 0, raw(std::nan("")), "chunk RADI: a value that is not finite"},
    };
    for (const Bad& bad : table) {
        INFO(bad.part << " at " << bad.offset);
        const auto path = folder.write("a.hres", with_payload(bytes, bad.chunk, bad.offset, bad.change));
        require_parts(message_of<InputError>([&] { (void)io::read_hres(path); }), {"a.hres:", bad.part});
    }

    // A few surfaces that say they have many patches, of which hardly any are in the file.
    io::ResultFile cut = sample();
    cut.surfaces_as_read = cut.scene.surfaces;
    const PatchMesh mesh(cut.scene);
    cut.parts.patch_of.assign(mesh.size(), 0);
    cut.surfaces_as_read[0].patches = Grid{2000, 1000};
    require_parts(message_of<InvalidArgument>([&] { io::write_hres(folder / "b.hres", cut); }),
                  {"parts are left; at most"});
    cut.surfaces_as_read[0].patches = Grid{1000, 1000};
    io::write_hres(folder / "b.hres", cut);
    std::string lie = io::read_file(folder / "b.hres");
    const std::string count = "\"patches\":";
    const std::size_t at =
        lie.find(count, lie.find("\"as_read\":")) + count.size() - chunk_start(lie, 0) - 16;
    lie = with_payload(lie, 0, at, "9");
    require_parts(message_of<InputError>([&] { (void)io::read_hres(folder.write("b.hres", lie)); }),
                  {"b.hres:", "that cannot be"});
}

TEST_CASE("HRES: a file that claims more patches than it has bytes for costs no memory", "[io]") {
    const Folder folder;
    io::write_hres(folder / "a.hres", sample());
    const std::string bytes = io::read_file(folder / "a.hres");
    const std::size_t begin = bytes.find("\"patches\":");
    std::string head = bytes.substr(begin, bytes.find("\"renderer\"") - begin);
    head.insert(head.find(','), "99999");
    head.erase(head.find(".23456"), 5); // of the residual: the length stays
    const std::string lie = with_payload(bytes, 0, begin - chunk_start(bytes, 0) - 16, head);
    require_parts(message_of<InputError>([&] { (void)io::read_hres(folder.write("a.hres", lie)); }),
                  {"a.hres:", "patches, 0 as they were read", "that cannot be"});
}

TEST_CASE("HRES: arrays that do not fit and values that are not finite are refused, and nothing is written",
          "[io]") {
    const Folder folder;
    io::ResultFile result = sample();
    result.solution.patch_size_error->groups.pop_back();
    require_parts(message_of<InvalidArgument>([&] { io::write_hres(folder / "a.hres", result); }),
                  {"errors of 1 groups; the scene has 2"});
    result = sample();
    result.solution.radiosity.pop_back();
    require_parts(message_of<InvalidArgument>([&] { io::write_hres(folder / "a.hres", result); }),
                  {"radiosity"});
    result = sample();
    result.solution.row_sum[1] = std::nan("");
    require_parts(message_of<InvalidArgument>([&] { io::write_hres(folder / "a.hres", result); }),
                  {"row sum: a value of nan; must be finite"});
    REQUIRE_THROWS_AS(io::write_hres("/dev/full", sample()), IoError);
    REQUIRE(folder.files() == 0);
}

TEST_CASE("Patch tables: one line a patch, names in quotes where needed, numbers that read back equal",
          "[io]") {
    const Folder folder;
    const io::ResultFile result = sample();
    const PatchMesh mesh(result.scene);
    io::write_patches_csv(folder / "p.csv", mesh);
    const std::string text = io::read_file(folder / "p.csv");
    REQUIRE(text.starts_with("index,group,area,cx,cy,cz,nx,ny,nz\n0,floor,0.166666"));
    REQUIRE(std::count(text.begin(), text.end(), '\n') == static_cast<int>(mesh.size()) + 1);
    REQUIRE(text.find("\n6,\"lid, \"\"top\"\"\",") != std::string::npos);
    const std::string area = text.substr(text.find("0,floor,") + 8);
    REQUIRE(std::stod(area) == mesh.areas()[0]);

    io::write_radiosity_csv(folder / "r.csv", result);
    const std::string table = io::read_file(folder / "r.csv");
    REQUIRE(table.starts_with("index,group,area,cx,cy,cz,nx,ny,nz,exitance_short,\"exitance_long, far\","));
    REQUIRE(table.find(",radiosity_short,\"radiosity_long, far\",") != std::string::npos);
    REQUIRE(std::count(table.begin(), table.end(), '\n') == static_cast<int>(mesh.size()) + 1);
    REQUIRE(folder.files() == 2);
}

TEST_CASE("Patch tables: of patches of which a part is left, its area and centre", "[io]") {
    const Folder folder;
    const PatchMesh mesh(sample().scene);
    io::PatchPlaces left{std::vector<double>(mesh.size(), 0.125),
                         std::vector<Vec3>(mesh.size(), Vec3(1.0, 2.0, 4.0))};
    io::write_patches_csv(folder / "p.csv", mesh, left);
    REQUIRE(io::read_file(folder / "p.csv").find("\n0,floor,0.125,1,2,4,") != std::string::npos);
    left.areas.pop_back();
    REQUIRE_THROWS_AS(io::write_patches_csv(folder / "p.csv", mesh, left), InvalidArgument);
}

TEST_CASE("HRES: patches of different sizes are stored, and refused where they do not fill a surface",
          "[io]") {
    const Folder folder;
    io::ResultFile a = sample();
    const PatchMesh coarse(a.scene);
    const PatchMesh once = coarse.split(std::vector<std::uint32_t>{0, 4, 7}).mesh;
    const PatchMesh mesh = once.split(std::vector<std::uint32_t>{1, once.size() - 1}).mesh;
    adopt_mesh(a.scene, a.subdivision, mesh);
    REQUIRE_FALSE(mesh.parts().empty());
    fit(a.solution, mesh.size());
    io::write_hres(folder / "a.hres", a);
    const io::ResultFile b = io::read_hres(folder / "a.hres");
    CHECK(b.subdivision.parts == mesh.parts());
    CHECK(PatchMesh(b.scene, b.subdivision).geometry_hash() == mesh.geometry_hash());
    // One part twice, another one missing: the numbers are those of before.
    std::size_t surface = 0;
    while (mesh.parts()[surface].empty()) {
        ++surface;
    }
    std::ifstream file(folder / "a.hres", std::ios::binary);
    const std::string bytes{std::istreambuf_iterator<char>(file), {}};
    const GridPart& last = mesh.parts()[surface].back();
    const std::size_t first = 4 * mesh.parts().size();
    const auto twice = folder.write(
        "b.hres", with_payload(bytes, 1, first, raw(last.level_u) + raw(last.level_v) + raw(last.cell)));
    require_parts(message_of<InputError>([&] { (void)io::read_hres(twice); }), {"b.hres:", "do not fill"});
    const auto many = folder.write("c.hres", with_payload(bytes, 1, 0, raw(1000000u)));
    require_parts(message_of<InputError>([&] { (void)io::read_hres(many); }), {"c.hres:", "more parts than"});
}

TEST_CASE("HRES: surfaces as they were read, and what is left of them", "[io]") {
    const Folder folder;
    io::ResultFile a = sample();
    // The scene has what is left: half of the floor's first patch, and the lid but for its back.
    a.surfaces_as_read = a.scene.surfaces;
    const PatchMesh as_read(a.scene_as_read());
    for (std::uint32_t s = 0; s < 2; ++s) {
        a.surfaces_as_read[s].patches = as_read.grid(s);
    }
    Surface& half = a.scene.surfaces[0];
    half.vertices = {Vec3(0, 0, 0), Vec3(1.0 / 6.0, 0, 0), Vec3(1.0 / 6.0, 0.5, 0), Vec3(0, 0.5, 0)};
    half.patches = Grid{1, 1};
    a.scene.surfaces[1].patches = as_read.grid(1);
    a.scene.surfaces[1].two_sided = false;
    const PatchMesh mesh(a.scene);
    const std::uint32_t lid = as_read.first_patch(1);
    a.parts.patch_of = {0};
    for (std::uint32_t k = 1; k < mesh.size(); ++k) {
        a.parts.patch_of.push_back(lid + k - 1);
    }
    for (std::uint32_t i = 0; i < as_read.size(); ++i) {
        a.parts.group_of.push_back(as_read.group(i));
    }
    fit(a.solution, mesh.size());
    io::write_hres(folder / "a.hres", a);
    const io::ResultFile b = io::read_hres(folder / "a.hres");
    CHECK(b.parts == a.parts);
    CHECK(PatchMesh(b.scene_as_read()).geometry_hash() == as_read.geometry_hash());

    io::write_radiosity_csv(folder / "a.csv", b);
    const std::string lines = io::read_file(folder / "a.csv");
    CHECK(std::count(lines.begin(), lines.end(), '\n') == 1 + as_read.size());
    const auto begins = [&](const std::string& line) { return lines.find("\n" + line) != std::string::npos; };
    CHECK(begins("0,floor,0.08333333333333333,0.08333333333333333,0.25,0,0,0,1,"));
    CHECK(begins("1,floor,0,0.5,0.25,0,0,0,1,0,0,0,0,0,0,"));

    std::ifstream file(folder / "a.hres", std::ios::binary);
    const std::string bytes{std::istreambuf_iterator<char>(file), {}};
    constexpr int patches_chunk = 3; // HEAD, SURF, READ, OFPA
    const auto of_none = folder.write("b.hres", with_payload(bytes, patches_chunk, 4, raw(as_read.size())));
    require_parts(message_of<InputError>([&] { (void)io::read_hres(of_none); }),
                  {"b.hres:", "a part of patch"});
    io::ResultFile few = a;
    few.parts.patch_of.pop_back();
    require_parts(message_of<InvalidArgument>([&] { io::write_hres(folder / "c.hres", few); }),
                  {"the patches that parts are of"});
}

} // namespace hemi::io_test
