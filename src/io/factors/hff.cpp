#include "hemi/core/error.hpp"
#include "hemi/core/text.hpp"
#include "hemi/io/factor_file.hpp"
#include "hemi/io/factor_part_file.hpp"
#include "io/factors/clusters_chunk.hpp"
#include "io/factors/patch_parts_chunk.hpp"
#include "io/factors/provenance_json.hpp"
#include "io/factors/row_block_chunk.hpp"
#include "io/formats/chunk_file.hpp"
#include "io/formats/json_node.hpp"
#include "io/formats/patch_cuts_chunk.hpp"
#include "io/formats/text_scan.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace hemi::io {

namespace {

constexpr ChunkFormat hff_format{"HEMIFF\r\n", 4, "form factors (.hff)"};

/// Whether columns are those of clusters; there are none of no patches.
bool has_clusters(const FormFactors& file) {
    return file.matrix.clusters() != nullptr && file.matrix.size() > 0;
}

Json header(const FormFactors& file) {
    Json head{{"size", file.matrix.size()},
              {"block_rows", FormFactorMatrix::block_rows},
              {"groups", file.groups},
              {"geometry", fmt::format("{:016x}", file.geometry_hash)}};
    add_provenance(head, file.provenance);
    head["enclosure"] = to_word(file.enclosure);
    head["reference_blocks"] = known_blocks(file.reference);
    head["chosen_for"] = file.provenance.chosen_for;
    if (file.parts.any()) {
        head["patches"] = file.parts.patches();
    }
    if (file.cuts.any()) {
        head["cut_surfaces"] = file.cuts.grids.size();
        head["cut_into_parts"] = !file.cuts.parts.empty();
    }
    if (has_clusters(file)) {
        head["cluster_nodes"] = file.matrix.clusters()->nodes().size();
    }
    if (file.error) {
        const FactorErrorEstimate& error = *file.error;
        head["error"] = {{"sampled", error.sampled},
                         {"rms", error.rms},
                         {"max", error.max},
                         {"row_rms", error.row_rms},
                         {"row_max", error.row_max}};
    }
    return head;
}

void check(const FormFactors& file) {
    const std::size_t size = file.matrix.size();
    if (file.areas.size() != size || file.group_of.size() != size) {
        throw InvalidArgument(fmt::format("{} areas and {} groups for {} patches; must be one for each",
                                          file.areas.size(), file.group_of.size(), size));
    }
    if (std::any_of(file.group_of.begin(), file.group_of.end(),
                    [&](std::uint32_t group) { return group >= file.groups.size(); })) {
        throw InvalidArgument("a patch belongs to a group that has no name");
    }
    const PatchParts& parts = file.parts;
    const auto is_beyond = [](std::span<const std::uint32_t> indices, std::size_t count) {
        return std::any_of(indices.begin(), indices.end(), [&](std::uint32_t k) { return k >= count; });
    };
    if (parts.any() && (parts.patch_of.size() != size || is_beyond(parts.patch_of, parts.patches()) ||
                        is_beyond(parts.group_of, file.groups.size()))) {
        throw InvalidArgument(fmt::format("{} parts of {} patches for {} rows; must be one for each, and "
                                          "every patch must have a group",
                                          parts.patch_of.size(), parts.patches(), size));
    }
    if (!file.cuts.parts.empty() && file.cuts.parts.size() != file.cuts.grids.size()) {
        throw InvalidArgument(fmt::format("grids of {} surfaces, and parts of {}", file.cuts.grids.size(),
                                          file.cuts.parts.size()));
    }
    if (has_clusters(file) && file.matrix.clusters()->nodes().size() != cluster_nodes(file.matrix.size())) {
        throw InvalidArgument("clusters of which some are not part of the tree");
    }
    if (file.reference.clusters() != nullptr) {
        throw InvalidArgument("rows of reference with clusters; they must tell single patches apart");
    }
    const bool has_reference = !known_blocks(file.reference).empty();
    if ((has_reference && file.reference.size() != size) || (file.error && file.error->rows.size() != size)) {
        throw InvalidArgument(fmt::format("{} rows of reference and {} errors of rows for {} patches",
                                          file.reference.size(), file.error ? file.error->rows.size() : 0,
                                          size));
    }
}

std::uint64_t read_hash(const JsonNode& node) {
    const std::string text = node.any_text();
    std::uint64_t hash = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), hash, 16);
    if (text.size() != 16 || error != std::errc() || end != text.data() + text.size()) {
        node.expect("16 hexadecimal digits");
    }
    return hash;
}

double magnitude(const JsonNode& node) {
    const double value = node.number();
    if (!(value >= 0.0) || !std::isfinite(value)) {
        node.expect("a finite number that is not negative");
    }
    return value;
}

FactorErrorEstimate read_error(const JsonNode& node) {
    FactorErrorEstimate error;
    error.sampled = integer32(node.member("sampled"));
    error.rms = magnitude(node.member("rms"));
    error.max = magnitude(node.member("max"));
    error.row_rms = magnitude(node.member("row_rms"));
    error.row_max = magnitude(node.member("row_max"));
    return error;
}

/// What the rows need beside what is in the file's own description.
struct Layout {
    std::vector<std::uint32_t> reference_blocks; ///< their first rows
    std::optional<std::uint32_t> patches;        ///< that rows are parts of
    std::uint64_t cut_surfaces = 0;              ///< of a refined mesh
    bool cut_into_parts = false;                 ///< whether patches of these differ in size
    bool clusters = false;                       ///< whether columns from N on are those of clusters
};

/// Everything but the rows. The matrix is made only after the file proved long enough for that many.
Layout read_header(ChunkReader& reader, FormFactors& file) {
    const Json document = parse_json(reader.chunk("HEAD").text(), reader.file());
    const JsonNode head(document, reader.file());
    if (integer32(head.member("block_rows")) != FormFactorMatrix::block_rows) {
        head.member("block_rows").expect(fmt::format("{}", FormFactorMatrix::block_rows));
    }
    const std::uint32_t size = integer32(head.member("size"));
    file.groups = head.member("groups").texts();
    file.geometry_hash = read_hash(head.member("geometry"));
    file.provenance = read_provenance(head);
    file.enclosure = read_word<Enclosure>(head.member("enclosure"));
    file.provenance.chosen_for = head.member("chosen_for").any_text();
    if (head.has("error")) {
        file.error = read_error(head.member("error"));
    }
    Layout layout;
    if (head.has("patches")) {
        layout.patches = integer32(head.member("patches"));
    }
    if (head.has("cut_surfaces")) {
        layout.cut_surfaces = integer32(head.member("cut_surfaces"));
        layout.cut_into_parts = head.member("cut_into_parts").boolean();
    }
    if (head.has("cluster_nodes")) {
        const JsonNode nodes = head.member("cluster_nodes");
        if (size == 0 || integer32(nodes) != cluster_nodes(size)) {
            nodes.expect(
                fmt::format("{}, as {} have", cluster_nodes(size), plural(size, "patch", "patches")));
        }
        layout.clusters = true;
    }
    layout.reference_blocks = read_first_rows(head.member("reference_blocks"), size);

    file.areas = read_areas(reader.chunk("AREA"), size);
    file.matrix = FormFactorMatrix(size);
    file.reference = FormFactorMatrix(layout.reference_blocks.empty() ? 0 : size);
    return layout;
}

void read_groups(ChunkReader& reader, FormFactors& file) {
    Payload groups = reader.chunk("GRUP");
    file.group_of = groups.take_array<std::uint32_t>(file.matrix.size());
    groups.expect_end();
    for (const std::uint32_t group : file.group_of) {
        if (group >= file.groups.size()) {
            groups.fail(fmt::format("group {}; there are {}", group, file.groups.size()));
        }
    }
}

/// How the patches of a refined mesh are cut; whether it fits a scene is seen with the scene.
void read_cuts(ChunkReader& reader, const Layout& layout, FormFactors& file) {
    Payload grids = reader.chunk("GRID");
    file.cuts.grids = grids.take_array<Grid>(layout.cut_surfaces);
    grids.expect_end();
    std::uint64_t cells = 0; // what a mesh of them needs must not exceed what the file shows
    for (const Grid& grid : file.cuts.grids) {
        cells += std::min(std::uint64_t{grid.u} * grid.v, std::uint64_t{file.matrix.size()} + 1);
    }
    if (cells > file.matrix.size()) {
        grids.fail(fmt::format("more cells than the {} patches", file.matrix.size()));
    }
    if (layout.cut_into_parts) {
        file.cuts.parts = read_parts(reader.chunk("CUTS"), layout.cut_surfaces, file.matrix.size());
    }
}

void read_touching(ChunkReader& reader, FormFactors& file) {
    Payload touching = reader.chunk("CONT");
    const auto count = touching.take<std::uint32_t>();
    file.touching = touching.take_array<std::uint32_t>(count);
    touching.expect_end();
    for (std::size_t k = 0; k < file.touching.size(); ++k) {
        if (file.touching[k] >= file.matrix.size() || (k > 0 && file.touching[k] <= file.touching[k - 1])) {
            touching.fail(fmt::format("touching patch {}; patches must ascend and be below {}",
                                      file.touching[k], file.matrix.size()));
        }
    }
}

/// All that comes before the rows.
Layout read_beginning(ChunkReader& reader, FormFactors& file) {
    const Layout layout = read_header(reader, file);
    read_groups(reader, file);
    read_touching(reader, file);
    if (layout.patches) {
        file.parts =
            read_patch_parts(reader.chunk("PART"), file.matrix.size(), *layout.patches, file.groups.size());
    }
    if (layout.cut_surfaces > 0) {
        read_cuts(reader, layout, file);
    }
    if (layout.clusters) {
        const std::uint32_t size = file.matrix.size();
        file.matrix = FormFactorMatrix(size, read_clusters(reader.chunk("TREE"), size));
    }
    return layout;
}

void read_row_errors(ChunkReader& reader, FormFactors& file) {
    Payload payload = reader.chunk("RERR");
    file.error->rows = payload.take_array<double>(file.matrix.size());
    payload.expect_end();
    for (const double error : file.error->rows) {
        if (!(error >= 0.0) || !std::isfinite(error)) {
            payload.fail(fmt::format("the error of a row is {}; must be finite and not negative", error));
        }
    }
}

} // namespace

void write_hff(const std::filesystem::path& path, const FormFactors& file) {
    check(file);
    ChunkWriter writer(path, hff_format);
    writer.chunk("HEAD", {bytes_of(json_text(header(file)))});
    writer.chunk("AREA", {bytes_of(file.areas)});
    writer.chunk("GRUP", {bytes_of(file.group_of)});
    const auto touching = static_cast<std::uint32_t>(file.touching.size());
    writer.chunk("CONT", {bytes_of(touching), bytes_of(file.touching)});
    if (file.parts.any()) {
        writer.chunk("PART", {bytes_of(file.parts.patch_of), bytes_of(file.parts.group_of)});
    }
    if (file.cuts.any()) {
        writer.chunk("GRID", {bytes_of(file.cuts.grids)});
    }
    if (!file.cuts.parts.empty()) {
        writer.chunk("CUTS", {bytes_of(stored_parts(file.cuts.parts))});
    }
    if (has_clusters(file)) {
        write_clusters(writer, *file.matrix.clusters());
    }
    for (std::size_t b = 0; b < file.matrix.blocks().size(); ++b) {
        if (has_clusters(file)) {
            write_row_block(writer.sink(), "ROWS", file.matrix.block(b));
        } else {
            write_row_block(writer.sink(), "ROWS", file.matrix.blocks()[b]);
        }
    }
    for (const std::uint32_t first_row : known_blocks(file.reference)) {
        write_row_block(writer.sink(), "REFR",
                        file.reference.blocks()[first_row / FormFactorMatrix::block_rows]);
    }
    if (file.error) {
        writer.chunk("RERR", {bytes_of(file.error->rows)});
    }
    writer.finish();
}

FormFactors read_hff(const std::filesystem::path& path) {
    refuse_factor_part(path);
    ChunkReader reader(path, hff_format);
    FormFactors file;
    const Layout layout = read_beginning(reader, file);
    for (std::uint32_t row = 0; row < file.matrix.size();) {
        set_row_block(reader.chunk("ROWS"), file.matrix, row);
        row += std::min(FormFactorMatrix::block_rows, file.matrix.size() - row);
    }
    for (const std::uint32_t first_row : layout.reference_blocks) {
        set_row_block(reader.chunk("REFR"), file.reference, first_row);
    }
    if (file.error) {
        read_row_errors(reader, file);
    }
    reader.finish();
    return file;
}

RowsGeometry read_hff_geometry(const std::filesystem::path& path) {
    refuse_factor_part(path);
    ChunkReader reader(path, hff_format);
    FormFactors file;
    (void)read_beginning(reader, file);
    return {file.matrix.size(), file.geometry_hash, std::move(file.cuts)};
}

} // namespace hemi::io
