#include "hemi/io/factor_part_file.hpp"

#include "chunk_surgery.hpp"
#include "io_fixtures.hpp"
#include "support/scenes.hpp"

#include <cmath>

namespace hemi::io_test {

using io::FactorPart;
using io::FactorPartContent;
using io::read_factor_part;
using io::write_factor_part;

namespace {

/// A box of 180 patches.
Scene box() {
    return test::tapered_box(5);
}

/// Rows of visibility 70 to 129, and a better one of row 100.
FactorPart sample(const PatchMesh& mesh) {
    FactorPart part;
    part.first = 70;
    part.end = 130;
    part.size = mesh.size();
    part.key = {{"geometry", "0123456789abcdef"}, {"seed", "7"}};
    part.visibility = true;
    part.estimated = true;
    part.enclosure = Enclosure::closed;
    part.provenance.renderer = "Some Renderer (line, 4.5)";
    part.entries = 123;
    const FormFactorMatrix all = random_matrix(mesh.size(), true, true);
    const auto some = [&](std::uint32_t first, std::uint32_t end) {
        FormFactorMatrix rows(mesh.size());
        for (const RowBlock& block : all.blocks()) {
            RowBlock kept;
            kept.first_row = block.first_row;
            kept.begin = {0};
            for (std::uint32_t r = 0; r < block.rows(); ++r) {
                const std::uint32_t row = block.first_row + r;
                const bool known = row >= first && row < end;
                for (std::uint64_t k = block.begin[r]; known && k < block.begin[r + 1]; ++k) {
                    kept.columns.push_back(block.columns[k]);
                    kept.values.push_back(block.values[k]);
                    kept.visibility.push_back(block.visibility[k]);
                }
                kept.begin.push_back(kept.columns.size());
                kept.known.push_back(known ? 1 : 0);
                kept.environment.push_back(known ? block.environment[r] : 0.0);
                kept.blocked.push_back(known ? block.blocked[r] : 0.0);
            }
            rows.set_block(std::move(kept));
        }
        return rows;
    };
    part.rows = some(70, 130);
    part.reference = some(100, 101);
    return part;
}

std::string message(const std::filesystem::path& path) {
    return message_of<InputError>([&] { (void)read_factor_part(path); });
}

} // namespace

TEST_CASE("Parts: what is written is read back bit for bit, with the mesh it is of", "[io]") {
    const Folder folder;
    const PatchMesh mesh(box());
    const FactorPart part = sample(mesh);
    const auto path = folder / "a.hff";
    write_factor_part(path, mesh, part);
    REQUIRE(folder.files() == 1);
    const FactorPart read = read_factor_part(path);
    CHECK(read.first == 70);
    CHECK(read.end == 130);
    CHECK(read.size == mesh.size());
    CHECK(read.key == part.key);
    CHECK(read.visibility);
    CHECK(read.estimated);
    CHECK(read.enclosure == Enclosure::closed);
    CHECK(read.provenance.renderer == part.provenance.renderer);
    CHECK(read.groups == mesh.groups());
    CHECK(read.entries == 123);
    require_same_entries(read.rows, part.rows);
    require_same_entries(read.reference, part.reference);
    for (std::uint32_t i = 0; i < mesh.size(); ++i) {
        REQUIRE(read.rows.known(i) == (i >= 70 && i < 130));
        REQUIRE(read.reference.known(i) == (i == 100));
    }
    Scene scene = box();
    scene.surfaces = read.surfaces;
    CHECK(PatchMesh(scene).geometry_hash() == mesh.geometry_hash());

    const FactorPart description = read_factor_part(path, FactorPartContent::description);
    CHECK(description.surfaces.size() == 6);
    CHECK(description.rows.size() == 0);
}

TEST_CASE("Parts: rows that are not those of the part, or not of its kind, are refused", "[io]") {
    const Folder folder;
    const PatchMesh mesh(box());
    const auto path = folder / "a.hff";
    FactorPart part = sample(mesh);
    SECTION("a row is missing") {
        part.end = 131;
        write_factor_part(path, mesh, part);
        require_parts(message(path), {"a.hff", "its rows are not 70 to 130"});
    }
    SECTION("a row too many") {
        part.first = 71;
        write_factor_part(path, mesh, part);
        require_parts(message(path), {"its rows are not 71 to 129"});
    }
    SECTION("a better row of another part") {
        part.reference = sample(mesh).rows;
        part.first = 70;
        part.end = 129;
        write_factor_part(path, mesh, part);
        require_parts(message(path), {"its rows are not 70 to 128"});
    }
    SECTION("rows of visibility where factors must be") {
        part.visibility = false;
        write_factor_part(path, mesh, part);
        require_parts(message(path), {"its rows are of another kind than it says"});
    }
    SECTION("more entries than there can be") {
        part.entries = std::uint64_t{60} * mesh.size() + 1; // 180 patches;
        write_factor_part(path, mesh, part);
        require_parts(message(path), {"entries: 10801", "10800"});
    }
}

TEST_CASE("Parts: shares above 1 behind a right checksum are refused, with their row", "[io]") {
    const Folder folder;
    const PatchMesh mesh(box());
    FactorPart part = sample(mesh);
    write_factor_part(folder / "sound.hff", mesh, part);
    std::ifstream file(folder / "sound.hff", std::ios::binary);
    const std::string bytes((std::istreambuf_iterator<char>(file)), std::istreambuf_iterator<char>());
    // HEAD, AREA, SURF, then blocks of 64 rows from row 64: six rows before the part's first are empty.
    const RowBlock& block = part.rows.blocks()[1];
    const std::size_t rows = block.rows();
    const std::size_t entries = block.columns.size();
    const std::size_t values =
        4 + 4 + 8 + 8 + 8 * (rows + 1) + 2 * 8 * rows + sizeof(std::uint32_t) * entries;
    const std::size_t second = block.begin[7] - block.begin[6]; // the first of row 71
    for (const float share : {2.0f, 1e30f, std::nextafter(1.0f, 2.0f)}) {
        const auto liar =
            folder.write("liar.hff", with_payload(bytes, 3, values + sizeof(float) * second, raw(share)));
        require_parts(message(liar), {"liar.hff", "row 71: a visible share of", "must be at most 1"});
    }
    const auto sound =
        folder.write("one.hff", with_payload(bytes, 3, values + sizeof(float) * second, raw(1.0f)));
    CHECK(read_factor_part(sound).rows.row(71).values[0] == 1.0f);
}

TEST_CASE("Parts: a part cut short anywhere is refused", "[io]") {
    const Folder folder;
    const PatchMesh mesh(box());
    write_factor_part(folder / "whole.hff", mesh, sample(mesh));
    std::ifstream file(folder / "whole.hff", std::ios::binary);
    const std::string bytes((std::istreambuf_iterator<char>(file)), std::istreambuf_iterator<char>());
    for (std::size_t length = 0; length < bytes.size(); length += 1 + length / 7) {
        const auto part = folder.write("part.hff", bytes.substr(0, length));
        CHECK(!message(part).empty());
    }
}

} // namespace hemi::io_test
