#include "hemi/io/factor_file.hpp"

#include "chunk_surgery.hpp"
#include "hemi/matrix/source_clusters.hpp"
#include "io_fixtures.hpp"

#include <cmath>
#include <limits>
#include <memory>

namespace hemi::io_test {

namespace {

FormFactors sample(std::uint32_t size, bool with_visibility = true) {
    FormFactors file;
    file.matrix = random_matrix(size, false, with_visibility);
    for (std::uint32_t i = 0; i < size; ++i) {
        file.areas.push_back(1.0 / (i + 3.0));
        file.group_of.push_back(i % 3);
        if (i % 9 == 4) {
            file.touching.push_back(i);
        }
    }
    file.groups = {"floor", "Decke ä \"1\"", ""};
    file.geometry_hash = 0xFEDCBA9876543210u;
    file.provenance.preset = Preset::exact;
    file.provenance.exchange_rule = ExchangeRule::exact;
    file.provenance.method = Method::montecarlo;
    file.provenance.resolution = 512;
    file.provenance.eye_points = 9;
    file.provenance.shadow_rays = 16;
    file.provenance.seed = std::numeric_limits<std::uint64_t>::max();
    file.provenance.renderer = "Some Renderer (line, 4.5)";
    file.enclosure = Enclosure::closed;
    return file;
}

/// With the last block of other rows as reference, and an estimate.
FormFactors judged_sample(std::uint32_t size) {
    FormFactors file = sample(size);
    file.reference = FormFactorMatrix(size);
    if (size > 0) {
        const FormFactorMatrix better = random_matrix(size, true, true);
        file.reference.set_block(better.blocks().back());
    }
    file.error = FactorErrorEstimate{7, 1e-5, 1.0 / 3.0, 2e-4, 0.5, std::vector<double>(size, 0.1)};
    file.provenance.chosen_for = "--error-target 1e-3";
    return file;
}

void require_equal(const FormFactors& a, const FormFactors& b) {
    require_same_entries(a.matrix, b.matrix);
    for (std::size_t k = 0; k < a.matrix.blocks().size(); ++k) {
        REQUIRE(a.matrix.blocks()[k].environment == b.matrix.blocks()[k].environment);
        REQUIRE(a.matrix.blocks()[k].blocked == b.matrix.blocks()[k].blocked);
        REQUIRE(a.matrix.blocks()[k].known == b.matrix.blocks()[k].known);
    }
    REQUIRE(a.areas == b.areas);
    REQUIRE(a.groups == b.groups);
    REQUIRE(a.group_of == b.group_of);
    REQUIRE(a.touching == b.touching);
    REQUIRE(a.parts == b.parts);
    REQUIRE(a.cuts == b.cuts);
    REQUIRE(a.geometry_hash == b.geometry_hash);
    REQUIRE(a.provenance.preset == b.provenance.preset);
    REQUIRE(a.provenance.exchange_rule == b.provenance.exchange_rule);
    REQUIRE(a.provenance.method == b.provenance.method);
    REQUIRE(a.provenance.resolution == b.provenance.resolution);
    REQUIRE(a.provenance.eye_points == b.provenance.eye_points);
    REQUIRE(a.provenance.shadow_rays == b.provenance.shadow_rays);
    REQUIRE(a.provenance.seed == b.provenance.seed);
    REQUIRE(a.provenance.renderer == b.provenance.renderer);
    REQUIRE(a.enclosure == b.enclosure);
    REQUIRE(a.provenance.chosen_for == b.provenance.chosen_for);
    REQUIRE(a.reference.entries() == b.reference.entries());
    if (a.reference.entries() > 0) {
        require_same_entries(a.reference, b.reference);
    }
    REQUIRE(a.error.has_value() == b.error.has_value());
    if (a.error) {
        REQUIRE(a.error->sampled == b.error->sampled);
        REQUIRE(a.error->rms == b.error->rms);
        REQUIRE(a.error->max == b.error->max);
        REQUIRE(a.error->row_rms == b.error->row_rms);
        REQUIRE(a.error->row_max == b.error->row_max);
        REQUIRE(a.error->rows == b.error->rows);
    }
}

} // namespace

TEST_CASE("HFF: what is written is read back bit for bit", "[io]") {
    const Folder folder;
    for (const bool with_visibility : {true, false}) {
        for (const std::uint32_t size : {0u, 1u, 63u, 64u, 65u, 200u}) {
            const FormFactors file = sample(size, with_visibility);
            io::write_hff(folder / "a.hff", file);
            const FormFactors read = io::read_hff(folder / "a.hff");
            require_equal(file, read);
            REQUIRE(read.matrix.has_visibility() == (with_visibility && file.matrix.entries() > 0));
        }
    }
    REQUIRE(folder.files() == 1);
}

TEST_CASE("HFF: the reference and the estimate that it gave are kept", "[io]") {
    const Folder folder;
    for (const std::uint32_t size : {0u, 1u, 64u, 65u, 200u}) {
        const FormFactors file = judged_sample(size);
        io::write_hff(folder / "a.hff", file);
        require_equal(file, io::read_hff(folder / "a.hff"));
    }
    FormFactors file = judged_sample(70);
    file.error->rows.pop_back();
    REQUIRE_THROWS_AS(io::write_hff(folder / "b.hff", file), InvalidArgument);
    file = judged_sample(70);
    file.reference = judged_sample(71).reference;
    REQUIRE_THROWS_AS(io::write_hff(folder / "b.hff", file), InvalidArgument);
}

TEST_CASE("HFF: which patches rows are parts of is kept, and must fit", "[io]") {
    const Folder folder;
    FormFactors file = sample(4);
    file.parts = {{0, 0, 5, 2}, {0, 1, 2, 0, 0, 1}};
    io::write_hff(folder / "a.hff", file);
    require_equal(file, io::read_hff(folder / "a.hff"));
    const std::string bytes = io::read_file(folder / "a.hff");
    const auto refusal = [&](std::size_t offset, std::uint32_t value) {
        const auto path = folder.write("bad.hff", with_payload(bytes, 4, offset, raw(value)));
        return message_of<InputError>([&] { (void)io::read_hff(path); });
    };
    require_parts(refusal(8, 6), {"chunk PART: patch 6; there are 6"});
    require_parts(refusal(16, 3), {"chunk PART: group 3; there are 3"});
    for (const PatchParts& bad : {PatchParts{{0, 0, 6, 2}, {0, 1, 2, 0, 0, 1}}, PatchParts{{0, 0, 1}, {0, 1}},
                                  PatchParts{{0, 0, 0, 0}, {3}}}) {
        file.parts = bad;
        REQUIRE_THROWS_AS(io::write_hff(folder / "b.hff", file), InvalidArgument);
    }
}

TEST_CASE("HFF: how patches of a refined mesh are cut is kept, and must fit", "[io]") {
    const Folder folder;
    FormFactors file = sample(5);
    for (const PatchCuts& cuts :
         {PatchCuts{{{2, 1}, {1, 3}}, {}},
          PatchCuts{{{1, 1}, {1, 1}}, {{{1, 0, 0}, {1, 1, 1}, {1, 1, 3}, {0, 1, 7}}, {}}}}) {
        file.cuts = cuts;
        io::write_hff(folder / "a.hff", file);
        require_equal(file, io::read_hff(folder / "a.hff"));
        const io::RowsGeometry geometry = io::read_hff_geometry(folder / "a.hff");
        CHECK(geometry.patches == 5);
        CHECK(geometry.geometry_hash == file.geometry_hash);
        CHECK(geometry.cuts == cuts);
    }
    const std::string bytes = io::read_file(folder / "a.hff");
    const auto refusal = [&](int chunk, std::size_t offset, std::uint32_t value) {
        const auto path = folder.write("bad.hff", with_payload(bytes, chunk, offset, raw(value)));
        (void)message_of<InputError>([&] { (void)io::read_hff_geometry(path); });
        return message_of<InputError>([&] { (void)io::read_hff(path); });
    };
    require_parts(refusal(4, 8, 6), {"chunk GRID: more cells than the 5 patches"});
    require_parts(refusal(5, 0, 6), {"chunk CUTS: more parts than the 5 patches"});
    file.cuts.parts.pop_back();
    REQUIRE_THROWS_AS(io::write_hff(folder / "b.hff", file), InvalidArgument);
}

TEST_CASE("HFF: clusters are kept bit for bit, and must be a tree of all patches", "[io]") {
    const Folder folder;
    FormFactors file = judged_sample(4);
    const auto clusters = std::make_shared<const SourceClusters>(
        std::vector<std::uint32_t>{2, 0, 1, 3},
        std::vector<SourceClusters::Node>{
            {0, 4, 1}, {0, 2, 3}, {2, 4, 5}, {0, 1, 0}, {1, 2, 0}, {2, 3, 0}, {3, 4, 0}},
        std::vector<double>{1.0, 2.0, 0.1, 6.0});
    file.matrix = FormFactorMatrix(4, clusters);
    RowBlock block;
    block.begin = {0, 2, 3, 3, 3};
    block.columns = {1, 6, 5};
    block.values = {0.25F, 0.5F, 0.7F}; // the last one takes more than 24 bits
    block.visibility = {255, 7, 130};
    block.environment = {0.25, 0.25, 1.0, 1.0};
    block.blocked.assign(4, 0.0);
    block.known.assign(4, 1);
    file.matrix.set_block(std::move(block));
    io::write_hff(folder / "a.hff", file);
    const std::string bytes = io::read_file(folder / "a.hff");
    const FormFactors read = io::read_hff(folder / "a.hff");
    require_equal(file, read);
    REQUIRE(read.matrix.clusters() != nullptr);
    CHECK(read.matrix.columns() == 11);
    CHECK(read.matrix.clusters()->share(3, 2) == clusters->share(3, 2));
    CHECK(read.matrix.clusters()->weight(1) == clusters->weight(1));
    io::write_hff(folder / "b.hff", read);
    CHECK(io::read_file(folder / "b.hff") == bytes);

    const auto refuse = [&](const std::string& changed, const std::string& part) {
        INFO(part);
        const auto path = folder.write("bad.hff", changed);
        require_parts(message_of<InputError>([&] { (void)io::read_hff(path); }), {"bad.hff:", part});
    };
    const auto tree = [&](std::size_t offset, const auto& value, const std::string& part) {
        refuse(with_payload(bytes, 4, offset, raw(value)), "chunk TREE: " + part);
    };
    tree(0, 0u, "clusters of sources: patch 0 of 4 comes twice, or is none");
    tree(0, 4u, "clusters of sources: patch 4 of 4 comes twice, or is none");
    tree(16, 1u, "clusters of sources: node 0 is not what its children make up");
    tree(16 + 12 + 8, 6u, "clusters of sources: node 1 is not what its children make up");
    tree(16 + 12 + 8, 0u, "clusters of sources: node 1 is not what its children make up");
    tree(16 + 84, -1.0, "the weight of patch 0 is -1; must be finite and not negative");
    tree(16 + 84 + 8, std::nan(""), "the weight of patch 1 is nan");
    const std::size_t count = bytes.find("\"cluster_nodes\":7") + 16 - chunk_start(bytes, 0) - 16;
    refuse(with_payload(bytes, 0, count, "9"), "must be 7, as 4 patches have");
    refuse(with_payload(bytes, 0, count - 16, "\"cluster_xxxxx"), "chunk");
    refuse(with_payload(bytes, 5, 24 + 5 * 8 + 2 * 32 + 4, raw(11u)), "chunk ROWS: ");

    file.reference = FormFactorMatrix(4, clusters);
    REQUIRE_THROWS_AS(io::write_hff(folder / "c.hff", file), InvalidArgument);
    Diagnostics diagnostics;
    for (const char* const name : {"a.mtx", "a.csv", "a.npz", "a.npy", "a.txt", "a.vf", "a.dat", "a.bin"}) {
        require_parts(
            message_of<InvalidArgument>([&] { io::write_factors(folder / name, file, {}, diagnostics); }),
            {name, "far patches stand in clusters"});
        CHECK_FALSE(std::filesystem::exists(folder / name));
    }
}

TEST_CASE("HFF: equal content gives equal bytes", "[io]") {
    const Folder folder;
    io::write_hff(folder / "a.hff", sample(100));
    io::write_hff(folder / "b.hff", sample(100));
    REQUIRE(io::read_file(folder / "a.hff") == io::read_file(folder / "b.hff"));
}

TEST_CASE("HFF: a file cut short anywhere is refused", "[io]") {
    const Folder folder;
    io::write_hff(folder / "a.hff", judged_sample(70));
    const std::string bytes = io::read_file(folder / "a.hff");
    for (std::size_t length = 0; length < bytes.size(); length += length < 600 ? 1 : 37) {
        const auto path = folder.write("cut.hff", bytes.substr(0, length));
        require_parts(message_of<InputError>([&] { (void)io::read_hff(path); }), {"cut.hff: "});
    }
    const auto longer = folder.write("long.hff", bytes + std::string(8, '\0'));
    require_parts(message_of<InputError>([&] { (void)io::read_hff(longer); }), {"8 bytes after the end"});
}

TEST_CASE("HFF: any flipped bit is noticed", "[io]") {
    const Folder folder;
    io::write_hff(folder / "a.hff", sample(70));
    const std::string bytes = io::read_file(folder / "a.hff");
    for (std::size_t position = 0; position < bytes.size(); position += position < 700 ? 1 : 23) {
        std::string flipped = bytes;
        flipped[position] = static_cast<char>(flipped[position] ^ (1 << position % 8));
        const auto path = folder.write("flipped.hff", flipped);
        INFO("byte " << position);
        require_parts(message_of<InputError>([&] { (void)io::read_hff(path); }), {"flipped.hff: "});
    }
}

TEST_CASE("HFF: a file of before, which does not say the rule of unoccluded factors, has its preset's",
          "[io]") {
    const Folder folder;
    for (const Preset preset : {Preset::standard, Preset::exact}) {
        FormFactors file = sample(10);
        file.provenance.preset = preset;
        file.provenance.exchange_rule = ExchangeRule::exact;
        file.provenance.near_eye_points = 64;
        io::write_hff(folder / "a.hff", file);
        CHECK(io::read_hff(folder / "a.hff").provenance.exchange_rule == ExchangeRule::exact);
        CHECK(io::read_hff(folder / "a.hff").provenance.near_eye_points == 64);
        const std::string bytes = io::read_file(folder / "a.hff");
        const std::string key = "exchange_rule";
        const std::size_t offset = bytes.find(key) - chunk_start(bytes, 0) - 16;
        const auto old = folder.write("old.hff", with_payload(bytes, 0, offset, "unknown_words"));
        const Provenance read = io::read_hff(old).provenance;
        CHECK(read.preset == preset);
        CHECK(read.exchange_rule == (preset == Preset::exact ? ExchangeRule::exact : ExchangeRule::standard));
    }
}

TEST_CASE("HFF: lies with a right checksum are noticed, and cost no memory", "[io]") {
    const Folder folder;
    io::write_hff(folder / "a.hff", judged_sample(70));
    const std::string bytes = io::read_file(folder / "a.hff");
    struct Bad {
        int chunk;
        std::size_t offset;
        std::string change;
        std::string part;
    };
    const std::size_t environment = 24 + 65 * 8;
    const std::vector<Bad> table{
        {0, 0, "[", "a.hff:1:"},
        {0, 2, "syze", "\"size\" is missing"},
        {0, 8, "71", "chunk AREA: shorter"},
        {0, 8, "69", "chunk AREA: 8 bytes too many"},
        {1, 0, raw(-1.0), "chunk AREA: an area of -1"},
        {1, 0, raw(std::nan("")), "chunk AREA: an area of nan"},
        {2, 0, raw(3u), "chunk GRUP: group 3; there are 3"},
        {3, 0, raw(9u), "chunk CONT: shorter than its own counts say"},
        {3, 4, raw(70u), "chunk CONT: touching patch 70"},
        {4, 0, raw(64u), "starts at row 64, where row 0 must come"},
        {4, 4, raw(63u), "chunk ROWS: "},
        {4, 4, raw(0xFFFFFFFFu), "chunk ROWS: shorter than its own counts say"},
        {4, 8, raw(std::uint64_t{1} << 60), "chunk ROWS: shorter than its own counts say"},
        {4, 8, raw(~std::uint64_t{0}), "chunk ROWS: shorter than its own counts say"},
        {4, 16, raw(std::uint64_t{1} << 60), "chunk ROWS: shorter than its own counts say"},
        {4, 16, raw(std::uint64_t{0}), "bytes too many"},
        {4, 24, raw(std::uint64_t{1}), "offsets must ascend"},
        {4, 32, raw(std::uint64_t{1} << 40), "offsets must ascend"},
        {4, environment, raw(-0.5), "environment share -0.5"},
        {4, environment, raw(std::nan("")), "environment share nan"},
        {4, environment + 64 * 16, raw(70u), "column"},
        {6, 0, raw(0u), "chunk REFR: starts at row 0, where row 64 must come"},
        {7, 0, raw(-1.0), "chunk RERR: the error of a row is -1"},
        {7, 8, raw(std::nan("")), "chunk RERR: the error of a row is nan"},
    };
    for (const Bad& bad : table) {
        INFO(bad.part);
        const auto path = folder.write("a.hff", with_payload(bytes, bad.chunk, bad.offset, bad.change));
        require_parts(message_of<InputError>([&] { (void)io::read_hff(path); }), {"a.hff:", bad.part});
    }
}

TEST_CASE("HFF: other files, other versions and directories are told apart", "[io]") {
    const Folder folder;
    const auto refusal = [&](const std::string& bytes) {
        return message_of<InputError>([&] { (void)io::read_hff(folder.write("a.hff", bytes)); });
    };
    require_parts(refusal(""), {"a.hff: 0 bytes; too short"});
    require_parts(refusal("v 0 0 0\nv 1 0 0\nv 1 1 0\n"), {"does not hold form factors (.hff)", "v 0 0 0"});
    require_parts(refusal("HEMIFF\n" + std::string(20, '\0')), {"does not hold form factors"});
    require_parts(refusal("HEMIFF\r\n\1" + std::string(20, '\0')), {"version 1", "reads version 4"});
    require_parts(message_of<InputError>([&] { (void)io::read_hff(folder / ""); }), {"cannot be read"});
    require_parts(message_of<InputError>([&] { (void)io::read_hff(folder / "no.hff"); }), {"No such file"});
}

TEST_CASE("HFF: arrays that do not fit the matrix are refused, and nothing is written", "[io]") {
    const Folder folder;
    FormFactors file = sample(10);
    file.areas.pop_back();
    REQUIRE_THROWS_AS(io::write_hff(folder / "a.hff", file), InvalidArgument);
    file = sample(10);
    file.group_of[3] = 3;
    REQUIRE_THROWS_AS(io::write_hff(folder / "a.hff", file), InvalidArgument);
    REQUIRE_THROWS_AS(io::write_hff("/dev/full", sample(10)), IoError);
    REQUIRE_THROWS_AS(io::write_hff(folder / "no/a.hff", sample(10)), IoError);
    REQUIRE(folder.files() == 0);
}

} // namespace hemi::io_test
