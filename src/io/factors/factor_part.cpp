#include "hemi/core/error.hpp"
#include "hemi/io/factor_part_file.hpp"
#include "io/factors/patch_parts_chunk.hpp"
#include "io/factors/provenance_json.hpp"
#include "io/factors/row_block_chunk.hpp"
#include "io/formats/chunk_file.hpp"
#include "io/formats/json_node.hpp"
#include "io/formats/surface_chunk.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <fstream>
#include <optional>
#include <utility>

namespace hemi::io {

namespace {

constexpr ChunkFormat part_format{"HEMIPT\r\n", 1, "a part of form factors (.hff of --rows)"};

Json header(const FactorPart& part, const PatchMesh& mesh) {
    Json head{{"rows", {part.first, part.end}},
              {"size", part.size},
              {"block_rows", FormFactorMatrix::block_rows},
              {"key", part.key},
              {"visibility", part.visibility},
              {"estimated", part.estimated},
              {"enclosure", to_word(part.enclosure)}};
    add_provenance(head, part.provenance);
    head["groups"] = mesh.groups();
    head["surfaces"] = mesh.surfaces().size();
    head["entries"] = part.entries;
    head["blocks"] = known_blocks(part.rows);
    head["reference_blocks"] = known_blocks(part.reference);
    if (part.parts.any()) {
        head["patches"] = part.parts.patches();
    }
    return head;
}

/// What the chunks need beside what is in the part itself.
struct PartLayout {
    std::uint32_t surfaces = 0;
    std::vector<std::uint32_t> blocks; ///< their first rows
    std::vector<std::uint32_t> reference_blocks;
    std::optional<std::uint32_t> patches; ///< that rows are parts of
};

PartLayout read_header(const JsonNode& head, FactorPart& part) {
    if (integer32(head.member("block_rows")) != FormFactorMatrix::block_rows) {
        head.member("block_rows").expect(fmt::format("{}", FormFactorMatrix::block_rows));
    }
    part.size = integer32(head.member("size"));
    const JsonNode rows = head.member("rows");
    if (rows.size() != 2) {
        rows.expect("the first row, and one past the last");
    }
    part.first = integer32(rows.element(0));
    part.end = integer32(rows.element(1));
    if (part.first >= part.end || part.end > part.size) {
        rows.expect(fmt::format("rows that ascend, of {}", part.size));
    }
    const JsonNode key = head.member("key");
    for (const auto& [name, value] : key.value().items()) {
        part.key[name] = key.member(name).any_text();
    }
    part.visibility = head.member("visibility").boolean();
    part.estimated = head.member("estimated").boolean();
    part.enclosure = read_word<Enclosure>(head.member("enclosure"));
    part.provenance = read_provenance(head);
    part.groups = head.member("groups").texts();
    part.entries = head.member("entries").integer(std::uint64_t{part.end - part.first} * part.size);
    PartLayout layout;
    layout.surfaces = integer32(head.member("surfaces"));
    layout.blocks = read_first_rows(head.member("blocks"), part.size);
    layout.reference_blocks = read_first_rows(head.member("reference_blocks"), part.size);
    if (head.has("patches")) {
        layout.patches = integer32(head.member("patches"));
    }
    return layout;
}

/// Whether no row beyond those of the part is known, and all of them are where `all` says so.
bool fits(const FactorPart& part, const FormFactorMatrix& rows, bool all) {
    for (std::uint32_t i = 0; i < rows.size(); ++i) {
        const bool within = i >= part.first && i < part.end;
        if (rows.known(i) ? !within : within && all) {
            return false;
        }
    }
    return true;
}

/// @throws InputError unless visible shares are at most 1
void check_shares(const ChunkReader& reader, const FormFactorMatrix& rows) {
    for (const RowBlock& block : rows.blocks()) {
        const auto above =
            std::find_if(block.values.begin(), block.values.end(), [](float share) { return share > 1.0f; });
        if (above != block.values.end()) {
            const auto entry = static_cast<std::uint64_t>(above - block.values.begin());
            const auto next = std::upper_bound(block.begin.begin(), block.begin.end(), entry);
            reader.fail(fmt::format("row {}: a visible share of {}; must be at most 1",
                                    block.first_row + (next - block.begin.begin()) - 1, *above));
        }
    }
}

/// Whether every entry has what a row of its kind needs.
bool has_kind(const FormFactorMatrix& rows, bool visibility) {
    return rows.entries() == 0 || rows.has_visibility() == visibility;
}

void read_rows(ChunkReader& reader, const PartLayout& layout, FactorPart& part) {
    part.rows = FormFactorMatrix(part.size);
    for (const std::uint32_t first_row : layout.blocks) {
        set_row_block(reader.chunk("ROWS"), part.rows, first_row);
    }
    part.reference = FormFactorMatrix(layout.reference_blocks.empty() ? 0 : part.size);
    for (const std::uint32_t first_row : layout.reference_blocks) {
        set_row_block(reader.chunk("REFR"), part.reference, first_row);
    }
    reader.finish();
    if (!fits(part, part.rows, true) || !fits(part, part.reference, false)) {
        reader.fail(fmt::format("its rows are not {} to {}", part.first, part.end - 1));
    }
    if (!has_kind(part.rows, part.visibility) || !has_kind(part.reference, true)) {
        reader.fail("its rows are of another kind than it says");
    }
    if (part.visibility) {
        check_shares(reader, part.rows);
    }
    check_shares(reader, part.reference);
}

} // namespace

void write_factor_part(const std::filesystem::path& path, const PatchMesh& mesh, const FactorPart& part) {
    if (!mesh.parts().empty()) {
        throw InvalidArgument("rows of patches that were cut further cannot be computed in parts");
    }
    ChunkWriter writer(path, part_format);
    writer.chunk("HEAD", {bytes_of(json_text(header(part, mesh)))});
    writer.chunk("AREA", {std::as_bytes(mesh.areas())});
    writer.chunk("SURF", {bytes_of(stored_surfaces(mesh))});
    if (part.parts.any()) {
        writer.chunk("PART", {bytes_of(part.parts.patch_of), bytes_of(part.parts.group_of)});
    }
    for (const std::uint32_t first_row : known_blocks(part.rows)) {
        write_row_block(writer.sink(), "ROWS", part.rows.blocks()[first_row / FormFactorMatrix::block_rows]);
    }
    for (const std::uint32_t first_row : known_blocks(part.reference)) {
        write_row_block(writer.sink(), "REFR",
                        part.reference.blocks()[first_row / FormFactorMatrix::block_rows]);
    }
    writer.finish();
}

FactorPart read_factor_part(const std::filesystem::path& path, FactorPartContent content) {
    ChunkReader reader(path, part_format);
    FactorPart part;
    const Json document = parse_json(reader.chunk("HEAD").text(), reader.file());
    const PartLayout layout = read_header(JsonNode(document, reader.file()), part);
    (void)read_areas(reader.chunk("AREA"), part.size); // so many patches as the file is long enough for
    part.surfaces = read_surfaces(reader.chunk("SURF"), layout.surfaces, part.size, {});
    for (Surface& surface : part.surfaces) {
        surface.material = 0;
    }
    if (layout.patches) {
        part.parts = read_patch_parts(reader.chunk("PART"), part.size, *layout.patches, part.groups.size());
    }
    if (content == FactorPartContent::all) {
        read_rows(reader, layout, part);
    }
    return part;
}

void refuse_factor_part(const std::filesystem::path& path) {
    std::array<char, part_format.magic.size()> start{};
    std::ifstream(path, std::ios::binary).read(start.data(), static_cast<std::streamsize>(start.size()));
    if (std::string_view(start.data(), start.size()) == part_format.magic) {
        const FactorPart part = read_factor_part(path, FactorPartContent::description);
        throw InputError(fmt::format("{}: a part with rows {} to {} of {}; `hemi merge` makes form factors "
                                     "of all parts",
                                     path.string(), part.first, part.end - 1, part.size));
    }
}

} // namespace hemi::io
