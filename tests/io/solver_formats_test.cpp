#include "hemi/io/factor_file.hpp"

#include "io_fixtures.hpp"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <cstdlib>
#include <cstring>
#include <sstream>

namespace hemi::io_test {

namespace {

using Json = nlohmann::json;

/// Three patches: 0 and 2 of the group "walls", 1 of "Lamp 1"; row 1 is empty.
io::FactorFile small_file() {
    io::FactorFile file;
    file.factors = FormFactorMatrix(3);
    file.factors.set_block(
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

/// A reader of Elmer's binary files, written after the format's description.
FormFactorMatrix read_elmer_binary(const std::string& bytes) {
    std::size_t at = 0;
    const auto take = [&](auto number) {
        REQUIRE(at + sizeof number <= bytes.size());
        std::memcpy(&number, bytes.data() + at, sizeof number);
        at += sizeof number;
        return number;
    };
    const auto size = static_cast<std::uint32_t>(take(std::int32_t{}));
    FormFactorMatrix matrix(size);
    for (std::uint32_t first = 0; first < size; first += FormFactorMatrix::block_rows) {
        RowBlock block;
        block.first_row = first;
        block.begin = {0};
        for (std::uint32_t i = first; i < std::min(size, first + FormFactorMatrix::block_rows); ++i) {
            for (std::int32_t k = take(std::int32_t{}); k > 0; --k) {
                block.columns.push_back(static_cast<std::uint32_t>(take(std::int32_t{}) - 1));
                block.values.push_back(static_cast<float>(take(double{})));
            }
            block.begin.push_back(block.columns.size());
            block.known.push_back(1);
            block.environment.push_back(0.0);
            block.blocked.push_back(0.0);
        }
        matrix.set_block(std::move(block));
    }
    REQUIRE(at == bytes.size());
    return matrix;
}

} // namespace

TEST_CASE("Elmer: rows with their counts, from 1, empty rows included", "[io]") {
    const Folder folder;
    io::write_elmer(folder / "ViewFactors.dat", small_file().factors, io::ElmerFormat::text);
    REQUIRE(io::read_file(folder / "ViewFactors.dat") == "2\n1 2 0.333333343\n1 3 0.5\n0\n1\n3 2 1\n");
}

TEST_CASE("Elmer: every factor reads back from both kinds of file", "[io]") {
    const Folder folder;
    const FormFactorMatrix matrix = random_matrix(150, true);
    io::write_elmer(folder / "a.bin", matrix, io::ElmerFormat::binary);
    require_same_entries(matrix, read_elmer_binary(io::read_file(folder / "a.bin")));

    io::write_elmer(folder / "a.dat", matrix, io::ElmerFormat::text);
    std::istringstream stream(io::read_file(folder / "a.dat"));
    for (std::uint32_t i = 0; i < 150; ++i) {
        const RowView row = matrix.row(i);
        std::size_t count = 0;
        REQUIRE((stream >> count && count == row.columns.size()));
        for (std::size_t k = 0; k < count; ++k) {
            std::uint32_t from = 0;
            std::uint32_t to = 0;
            float value = 0.0f;
            stream >> from >> to >> value;
            REQUIRE((from == i + 1 && to == row.columns[k] + 1 && value == row.values[k]));
        }
    }
    for (const io::ElmerFormat format : {io::ElmerFormat::text, io::ElmerFormat::binary}) {
        REQUIRE_THROWS_AS(io::write_elmer("/dev/full", matrix, format), IoError);
        require_parts(message_of<InvalidArgument>(
                          [&] { io::write_elmer(folder / "x.dat", random_matrix(9, false), format); }),
                      {"not computed", "use .hff"});
    }
    REQUIRE(folder.files() == 2);
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
        io::FactorFile file = small_file();
        file.groups = groups;
        Diagnostics diagnostics;
        return message_of<InvalidArgument>([&] { io::write_energyplus(folder / name, file, diagnostics); });
    };
    for (const std::string name : {"a,b", "a;b", "a!b", "a\nb", ""}) {
        require_parts(refusal({"walls", name}), {"group \"", "EnergyPlus' names have 1 to 100 characters"});
    }
    require_parts(refusal({std::string(101, 'x'), "b"}), {"group \"xxx", "1 to 100 characters"});
    require_parts(refusal({"Wall", "wALL"}), {"groups \"Wall\" and \"wALL\" are one name to EnergyPlus"});
    require_parts(refusal({"a", "b"}, "a,b.idf"), {"zone \"a,b\""});
    io::FactorFile unknown = small_file();
    unknown.factors = FormFactorMatrix(3);
    Diagnostics diagnostics;
    REQUIRE_THROWS_AS(io::write_energyplus(folder / "a.idf", unknown, diagnostics), InvalidArgument);
    REQUIRE_THROWS_AS(io::write_energyplus("/dev/full", small_file(), diagnostics), IoError);
    REQUIRE(folder.files() == 0);
}

TEST_CASE("HDF5: h5py reads rows, patches, groups and what made them", "[io]") {
    const Folder folder;
    io::FactorFile file;
    file.factors = random_matrix(150, false);
    std::vector<double> sums;
    std::vector<double> environment;
    std::vector<double> blocked;
    std::vector<int> known;
    for (std::uint32_t i = 0; i < 150; ++i) {
        file.areas.push_back(1.0 / (1.0 + i));
        file.group_of.push_back(i % 2);
        const RowView row = file.factors.row(i);
        sums.push_back(row.sum());
        environment.push_back(row.environment);
        blocked.push_back(row.blocked);
        known.push_back(file.factors.known(i) ? 1 : 0);
    }
    file.groups = {"wände \"x\"", "floor"};
    file.renderer = "llvmpipe";
    file.preset = "exact";
    file.resolution = 64;
    file.eye_points = 4;
    file.seed = 18446744073709551615u;
    file.enclosure = "closed";
    file.geometry_hash = 0x0123456789abcdefu;
    file.error = FactorError{};
    file.error->rows.assign(150, 1e-4);
    io::write_h5(folder / "a.h5", file, "closure");

    Json expected{{"size", 150},
                  {"entries", entries_of(file.factors)},
                  {"groups", file.groups},
                  {"attributes",
                   {{"schema", "hemi/factors/1"},
                    {"repair", "closure"},
                    {"preset", "exact"},
                    {"method", "hemicube"},
                    {"renderer", "llvmpipe"},
                    {"enclosure", "closed"},
                    {"geometry_hash", "0123456789abcdef"},
                    {"resolution", 64},
                    {"eye_points", 4},
                    {"seed", file.seed}}},
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
    io::FactorFile file;
    file.factors = random_matrix(7000, true); // 140,000 entries: two whole chunks and a part
    REQUIRE(file.factors.entries() > 2 * 65536);
    io::write_h5(folder / "a.h5", file, "none");
    run_h5py(
        folder / "a.h5",
        folder.write("expected.json", Json{{"size", 7000},
                                           {"entries", entries_of(file.factors)},
                                           {"attributes", {{"schema", "hemi/factors/1"}, {"repair", "none"}}}}
                                          .dump()));
}

TEST_CASE("HDF5: what cannot be written leaves no file", "[io]") {
    const Folder folder;
    io::FactorFile file = small_file();
    require_parts(message_of<IoError>([&] { io::write_h5("/dev/full", file, "none"); }),
                  {"regular files only"});
    require_parts(message_of<IoError>([&] { io::write_h5(folder / "no/a.h5", file, "none"); }),
                  {"No such file"});
    file.areas.pop_back();
    REQUIRE_THROWS_AS(io::write_h5(folder / "a.h5", file, "none"), InvalidArgument);
    REQUIRE(folder.files() == 0);
}

} // namespace hemi::io_test
