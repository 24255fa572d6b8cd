#include "hemi/io/factor_file.hpp"

#include "io_fixtures.hpp"
#include "support/places.hpp"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <cstdlib>
#include <utility>

namespace hemi::io_test {

namespace {

using Json = nlohmann::json;

/// Three patches: 0 and 2 of the group "walls", 1 of "Lamp 1"; row 1 is empty.
FormFactors small_file() {
    FormFactors file;
    file.matrix = FormFactorMatrix(3);
    file.matrix.set_block(
        {0, {0, 2, 2, 3}, {1, 2, 1}, {1.0f / 3.0f, 0.5f, 1.0f}, {}, {0.25, 1.0, 0.0}, {0, 0, 0}, {1, 1, 1}});
    file.areas = {1.0, 2.0, 3.0};
    file.groups = {"walls", "Lamp 1", "unused"};
    file.group_of = {0, 1, 0};
    return file;
}

void run_h5py(const std::filesystem::path& h5, const std::filesystem::path& expected) {
    const std::string command = "/usr/bin/python3 '" + std::string(HEMI_TEST_DATA) + "/io/compare_h5.py' '" +
                                h5.string() + "' '" + expected.string() + "'";
    REQUIRE(std::system(command.c_str()) == 0);
}

Json entries_of(const FormFactorMatrix& factors) {
    Json entries = Json::array();
    for (std::uint32_t i = 0; i < factors.size(); ++i) {
        const RowView row = factors.row(i);
        for (std::size_t k = 0; k < row.columns.size(); ++k) {
            entries.push_back({i, row.columns[k], row.values[k]});
        }
    }
    return entries;
}

} // namespace

TEST_CASE("Elmer: rows with their counts, from 1, empty rows included", "[io]") {
    const Folder folder;
    io::write_elmer(folder / "ViewFactors.dat", small_file().matrix, io::ElmerFormat::text);
    REQUIRE(io::read_file(folder / "ViewFactors.dat") == "2\n1 2 0.333333343\n1 3 0.5\n0\n1\n3 2 1\n");
}

TEST_CASE("Elmer: the binary file is 32-bit counts and columns and 64-bit factors", "[io]") {
    const Folder folder;
    io::write_elmer(folder / "a.bin", small_file().matrix, io::ElmerFormat::binary);
    std::string expected;
    const auto put = [&expected](auto number) {
        expected.append(reinterpret_cast<const char*>(&number), sizeof number);
    };
    put(std::int32_t{3});
    put(std::int32_t{2});
    put(std::int32_t{2});
    put(static_cast<double>(1.0f / 3.0f));
    put(std::int32_t{3});
    put(0.5);
    put(std::int32_t{0});
    put(std::int32_t{1});
    put(std::int32_t{2});
    put(1.0);
    const bool same = io::read_file(folder / "a.bin") == expected;
    REQUIRE(same);
}

TEST_CASE("Elmer: every factor reads back from both kinds of file", "[io]") {
    const Folder folder;
    const FormFactorMatrix matrix = random_matrix(150, true);
    for (const io::ElmerFormat format : {io::ElmerFormat::text, io::ElmerFormat::binary}) {
        io::write_elmer(folder / "a.dat", matrix, format);
        require_same_entries(matrix, io::read_elmer(folder / "a.dat", format));
        REQUIRE_THROWS_AS(io::write_elmer("/dev/full", matrix, format), IoError);
        require_parts(message_of<InvalidArgument>(
                          [&] { io::write_elmer(folder / "x.dat", random_matrix(9, false), format); }),
                      {"not computed", "use .hff"});
    }
    REQUIRE(folder.files() == 1);
}

TEST_CASE("Elmer: what is wrong is named with its place, its value and what would be right", "[io]") {
    const Folder folder;
    const std::vector<std::pair<std::string, std::string>> texts{
        {"", "a.dat: no rows"},
        {"x\n", ":1: \"x\"; must be the number of entries of row 1"},
        {"1\n", ":1: cut short in row 1"},
        {"1\n2 1 0.5\n", ":2: row \"2\"; must be 1, the row of its place"},
        {"1\n1 0 0.5\n", ":2: column \"0\"; must be a whole number from 1"},
        {"1\n1 1 -0.5\n", ":2: value \"-0.5\"; a form factor must be"},
        {"1\n1 1 nan\n", ":2: value \"nan\""},
        {"1\n1 1 0.5 1\n", ":2: \"1\" after the factor"},
        {"1\n1 2 0.5\n", "a.dat: column 2; there are 1 rows"},
        {"2\n1 1 0.5\n1 1 0.5\n", ":3: the entry of line 2 again"},
        {"18446744073709551615\n1 1 0.5\n", ":2: cut short in row 1"},
    };
    for (const auto& [text, part] : texts) {
        INFO(text);
        const auto path = folder.write("a.dat", text);
        require_parts(message_of<InputError>([&] { (void)io::read_elmer(path, io::ElmerFormat::text); }),
                      {part});
    }
    const auto words = [](const std::vector<std::int32_t>& numbers, const std::vector<double>& doubles = {}) {
        std::string bytes(reinterpret_cast<const char*>(numbers.data()), 4 * numbers.size());
        return bytes + std::string(reinterpret_cast<const char*>(doubles.data()), 8 * doubles.size());
    };
    const std::vector<std::pair<std::string, std::string>> binaries{
        {"", "a.bin: byte 0: cut short"},
        {words({0}), "0 rows in a file of 4 bytes; that cannot be"},
        {words({-1}), "-1 rows in a file"},
        {words({2147483647}), "2147483647 rows in a file of 4 bytes; that cannot be"},
        {words({1, 2}), "row 1 of 2 entries; must be 0 to 1"},
        {words({1, -1}), "row 1 of -1 entries"},
        {words({1, 1, 2}, {0.5}), "row 1: column 2; must be from 1 to 1"},
        {words({1, 1, 1}, {-0.5}), "F(1, 1) = -0.5; must be finite and not negative"},
        {words({1, 1, 1}, {0.5, 0.5}), "8 bytes after the last row"},
        {words({1, 1, 1}), "byte 12: cut short"},
        {words({2, 2, 1}, {0.5}) + words({1}, {0.5}) + words({0}), "row 1: column 1 is there twice"},
    };
    for (const auto& [bytes, part] : binaries) {
        INFO(part);
        const auto path = folder.write("a.bin", bytes);
        require_parts(message_of<InputError>([&] { (void)io::read_elmer(path, io::ElmerFormat::binary); }),
                      {part});
    }
}

TEST_CASE("View3D factors: text and binary read back, with areas and enclosure", "[io]") {
    const Folder folder;
    FormFactors file;
    file.matrix = random_matrix(150, true);
    for (int i = 0; i < 150; ++i) {
        file.areas.push_back(0.125 * (i + 1));
    }
    file.enclosure = Enclosure::closed;
    for (const io::View3dFormat format : {io::View3dFormat::text, io::View3dFormat::binary}) {
        io::write_view3d(folder / "a", file, format);
        const FormFactors back = io::read_view3d(folder / "a", format);
        require_same_entries(file.matrix, back.matrix);
        REQUIRE(back.areas == file.areas);
        REQUIRE(back.enclosure == Enclosure::closed);
    }
}

TEST_CASE("View3D factors: areas that 32 bits cannot hold are refused", "[io]") {
    const Folder folder;
    for (const double area : {1e39, 1e-50}) {
        FormFactors file = small_file();
        file.areas[1] = area;
        require_parts(message_of<InvalidArgument>(
                          [&] { io::write_view3d(folder / "a.vf", file, io::View3dFormat::binary); }),
                      {"patch 1: an area of ", "write .txt"});
    }
    REQUIRE(folder.files() == 0);
}

TEST_CASE("View3D factors: what is wrong is named with its place, its value and what would be right",
          "[io]") {
    const Folder folder;
    const std::string head = "View3D 3.3 0 0 0 2\n";
    REQUIRE(
        io::read_view3d(folder.write("a.txt", head + "1 2\n0 0.5\n0.25 0\n0.9 0.9\n"), io::View3dFormat::text)
            .matrix.entries() == 2);
    const std::vector<std::pair<std::string, std::string>> texts{
        {"", ":1: \"\"; must be program, version, format"},
        {"View3D 3.3 0 0 2\n", ":1: \"View3D 3.3 0 0 2\"; must be program"},
        {"View3D 3.3 1 0 0 2\n", ":1: format 1; must be 0, as the name's extension says"},
        {"View3D 3.3 0 0 1 2\n", ":1: the factors include reflection"},
        {"View3D 3.3 0 0 0 4000000000\n", ":1: 4000000000 surfaces in a file of 28 bytes; that cannot be"},
        {"View3D 3.3 0 0 0 18446744073709551615\n", "surfaces in a file of"},
        {head + "1 0\n0 0.5\n0.25 0\n0.9 0.9\n", ":2: area 0; must be positive"},
        {head + "1 2\n0 -0.5\n0.25 0\n0.9 0.9\n", ":3: factor -0.5; must be finite and not negative"},
        {head + "1 2\n0 x\n0.25 0\n0.9 0.9\n", ":3: factor \"x\"; must be a number"},
        {head + "1 2\n0 0.5\n0.25 0\n0.9\n", ":5: cut short: emissivity is missing"},
        {head + "1 2\n0 0.5\n0.25 0\n0.9 0.9 1\n", ":5: \"1\" after the emissivities"},
    };
    for (const auto& [text, part] : texts) {
        INFO(text);
        const auto path = folder.write("a.txt", text);
        require_parts(message_of<InputError>([&] { (void)io::read_view3d(path, io::View3dFormat::text); }),
                      {part});
    }
    const std::string binary_head = "View3D 3.3 1 0 0 1            \r\n";
    const std::vector<std::pair<std::string, std::string>> binaries{
        {"", "a.vf: 0 bytes; View3D's binary files begin"},
        {binary_head, ":1: 1 surfaces in a file of 32 bytes; that cannot be"},
        {binary_head + std::string(12, '\0'), "a.vf: byte 36: area 0; must be positive"},
        {binary_head + std::string("\0\0\x80?\0\0\xc0\x7f\0\0\0\0", 12),
         "byte 40: factor nan; must be finite"},
        {std::string(binary_head).replace(11, 1, "0") + std::string(12, '\0'), ":1: format 0; must be 1"},
        {binary_head + std::string("\0\0\x80?\0\0\0\0\0\0\x80?abc", 15),
         "byte 44: 3 bytes after the emissivities"},
        {std::string(40, 'x'), "a.vf: 40 bytes; View3D's binary files begin with a line of 32"},
    };
    for (const auto& [bytes, part] : binaries) {
        INFO(part);
        const auto path = folder.write("a.vf", bytes);
        require_parts(message_of<InputError>([&] { (void)io::read_view3d(path, io::View3dFormat::binary); }),
                      {part});
    }
}

TEST_CASE("EnergyPlus: a triple for every pair of groups, by name, area-weighted", "[io]") {
    const Folder folder;
    Diagnostics diagnostics;
    io::write_energyplus(folder / "attic zone.idf", small_file(), diagnostics);
    const std::string text = io::read_file(folder / "attic zone.idf");
    REQUIRE(text.starts_with("! View factors by hemi "));
    // From the walls, area 4: to the lamp (1/3 + 3 * 1) / 4, to the walls 0.5 / 4.
    REQUIRE(
        text.substr(text.find('\n')) ==
        "\nZoneProperty:UserViewFactors:BySurfaceName,\n  attic zone,  !- Zone Name\n  walls,walls,0.125,\n"
        "  walls,Lamp 1,0.833333336,\n  Lamp 1,walls,0,\n  Lamp 1,Lamp 1,0;\n");
    REQUIRE(diagnostics.warnings().size() == 1);
    require_parts(diagnostics.warnings()[0],
                  {"EnergyPlus takes a zone for closed", "2 groups do not, \"Lamp 1\" loses 1"});
}

TEST_CASE("EnergyPlus: names that it cannot hold are refused, and nothing is written", "[io]") {
    const Folder folder;
    const auto refusal = [&](const std::vector<std::string>& groups, const std::string& name = "zone.idf") {
        FormFactors file = small_file();
        file.groups = groups;
        Diagnostics diagnostics;
        return message_of<InvalidArgument>([&] { io::write_energyplus(folder / name, file, diagnostics); });
    };
    for (const std::string name : {"a,b", "a;b", "a!b", "a\nb", "", " a", "a\t"}) {
        require_parts(refusal({"walls", name}), {"group \"", "EnergyPlus' names have 1 to 100 characters"});
    }
    require_parts(refusal({std::string(101, 'x'), "b"}), {"group \"xxx", "1 to 100 characters"});
    require_parts(refusal({"Wall", "wALL"}), {"groups \"Wall\" and \"wALL\" are one name to EnergyPlus"});
    require_parts(refusal({"a", "b"}, "a,b.idf"), {"zone \"a,b\""});
    FormFactors unknown = small_file();
    unknown.matrix = FormFactorMatrix(3);
    Diagnostics diagnostics;
    REQUIRE_THROWS_AS(io::write_energyplus(folder / "a.idf", unknown, diagnostics), InvalidArgument);
    REQUIRE_THROWS_AS(io::write_energyplus("/dev/full", small_file(), diagnostics), IoError);
    REQUIRE(folder.files() == 0);
}

TEST_CASE("HDF5: h5py reads rows, patches, groups and what made them", "[io]") {
    const Folder folder;
    FormFactors file;
    file.matrix = random_matrix(150, false);
    std::vector<double> sums;
    std::vector<double> environment;
    std::vector<double> blocked;
    std::vector<int> known;
    for (std::uint32_t i = 0; i < 150; ++i) {
        file.areas.push_back(1.0 / (1.0 + i));
        file.group_of.push_back(i % 2);
        const RowView row = file.matrix.row(i);
        sums.push_back(row.sum());
        environment.push_back(row.environment);
        blocked.push_back(row.blocked);
        known.push_back(file.matrix.known(i) ? 1 : 0);
    }
    file.groups = {"wände \"x\"", "floor"};
    file.provenance.renderer = "llvmpipe";
    file.provenance.preset = Preset::exact;
    file.provenance.resolution = 64;
    file.provenance.eye_points = 4;
    file.provenance.seed = 18446744073709551615u;
    file.enclosure = Enclosure::closed;
    file.geometry_hash = 0x0123456789abcdefu;
    file.error = FactorErrorEstimate{};
    file.error->rows.assign(150, 1e-4);
    file.repair.emplace().repair = Repair::closure;
    io::write_h5(folder / "a.h5", file);

    Json expected{{"size", 150},
                  {"entries", entries_of(file.matrix)},
                  {"groups", file.groups},
                  {"attributes",
                   {{"schema", "hemi/factors-hdf5/1"},
                    {"repair", "closure"},
                    {"preset", "exact"},
                    {"method", "hemicube"},
                    {"renderer", "llvmpipe"},
                    {"enclosure", "closed"},
                    {"geometry_hash", "0123456789abcdef"},
                    {"resolution", 64},
                    {"eye_points", 4},
                    {"seed", file.provenance.seed}}},
                  {"patches",
                   {{"area", file.areas},
                    {"group", file.group_of},
                    {"row_sum", sums},
                    {"environment", environment},
                    {"blocked", blocked},
                    {"known", known},
                    {"row_error", file.error->rows}}}};
    run_h5py(folder / "a.h5", folder.write("expected.json", expected.dump()));
}

TEST_CASE("HDF5: arrays of many chunks, and rows of which nothing else is known", "[io]") {
    const Folder folder;
    FormFactors file;
    file.matrix = random_matrix(7000, true); // 140,000 entries: two whole chunks and a part
    REQUIRE(file.matrix.entries() > 2 * 65536);
    io::write_h5(folder / "a.h5", file);
    run_h5py(folder / "a.h5",
             folder.write("expected.json",
                          Json{{"size", 7000},
                               {"entries", entries_of(file.matrix)},
                               {"attributes", {{"schema", "hemi/factors-hdf5/1"}, {"repair", "none"}}}}
                              .dump()));
}

TEST_CASE("HDF5: what cannot be written leaves no file", "[io]") {
    const Folder folder;
    FormFactors file = small_file();
    require_parts(message_of<IoError>([&] { io::write_h5("/dev/full", file); }),
                  {"/dev/full: cannot be written: No space left"});
    require_parts(message_of<IoError>([&] { io::write_h5(folder / "no/a.h5", file); }), {"No such file"});
    file.areas.pop_back();
    REQUIRE_THROWS_AS(io::write_h5(folder / "a.h5", file), InvalidArgument);
    REQUIRE(folder.files() == 0);
}

} // namespace hemi::io_test
