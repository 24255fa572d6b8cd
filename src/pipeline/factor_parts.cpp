#include "hemi/pipeline/factor_parts.hpp"

#include "engine/raw_row.hpp"
#include "hemi/core/error.hpp"
#include "hemi/core/text.hpp"
#include "hemi/engine/reference_rows.hpp"
#include "pipeline/row_computation.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <numeric>
#include <type_traits>

namespace hemi {

namespace {

using Paths = std::span<const std::filesystem::path>;

/// Rows of a provider as they are stored, whatever they mean.
template <class Row>
class RawRows : public RowProvider {
public:
    explicit RawRows(BasicRowProvider<Row>& provider) : provider_(provider) {}

    [[nodiscard]] std::uint32_t size() const override { return provider_.size(); }
    [[nodiscard]] std::string renderer() const override { return provider_.renderer(); }
    void rows(std::span<const std::uint32_t> patches, const Sink& sink) override {
        provider_.rows(patches, [&sink](std::uint32_t patch, const Row& row) { sink(patch, raw_row(row)); });
    }

private:
    BasicRowProvider<Row>& provider_;
};

/// Entries that may become factors.
std::uint64_t shown_entries(const FormFactorMatrix& rows) {
    std::uint64_t shown = 0;
    for (const RowBlock& block : rows.blocks()) {
        shown += static_cast<std::uint64_t>(std::count_if(block.values.begin(), block.values.end(),
                                                          [](float value) { return value > 0.0f; }));
    }
    return shown;
}

/// Rows of the engine, of both kinds.
template <class Row>
FormFactorMatrix compute_rows(FormFactors& factors, BasicRowProvider<Row>& engine, RowRange rows,
                              const FactorSettings& settings, Observer& observer, RowCheckpoint* checkpoint) {
    std::vector<std::uint32_t> patches(rows.end - rows.first);
    std::iota(patches.begin(), patches.end(), rows.first);
    if (settings.method == Method::hemicube) {
        RawRows<Row> sampled(engine);
        check_memory(sampled, patches, settings, observer,
                     "Fewer rows in a part, larger patches or a higher limit");
        stop_if_interrupted();
    }
    io::CheckpointKey key = raw_row_key(factors, settings);
    key["rows"] = fmt::format("{}:{}", rows.first, rows.end);
    Computation<Row> computation(factors, engine, observer, checkpoint, std::move(key));
    RawRows<Row> raw(computation.rows());
    constexpr Phase phase = std::is_same_v<Row, RowView> ? Phase::form_factors : Phase::visibility;
    FormFactorMatrix result = compute_matrix(raw, patches, computation.timed_progress(phase));
    computation.finish(patches.size());
    return result;
}

/// Rows of visibility of those patches of the part that errors are estimated by.
/// @return what makes all better rows, for FactorPart::key
std::string add_reference(io::FactorPart& part, const PatchMesh& mesh, const FactorSettings& settings,
                          Observer& observer) {
    const auto [hemicube, all] = plan_reference(all_patches(mesh.size()), settings, mesh.size());
    std::vector<std::uint32_t> patches;
    std::copy_if(all.begin(), all.end(), std::back_inserter(patches),
                 [&part](std::uint32_t patch) { return patch >= part.first && patch < part.end; });
    const auto engine = make_visibility_provider(mesh, hemicube, settings);
    RawRows<VisibilityRow> raw(*engine);
    part.estimated = true;
    part.reference = compute_matrix(raw, patches, [&](std::size_t done, std::size_t total) {
        return observer.progress(Phase::error_estimate, done, total);
    });
    return fmt::format("by {} rows of {}", all.size(), renderer_of_rows(engine->renderer()));
}

/// A part without its rows and its mesh, which is that of all.
struct KnownPart {
    std::filesystem::path file;
    io::FactorPart part;
    std::uint64_t bytes; ///< of the file, no less than it takes in memory
};

/// Parts of one scene.
struct KnownParts {
    io::FactorPart mesh;          ///< of all of them: what one of them holds besides rows
    std::vector<KnownPart> parts; ///< by their first rows
};

std::vector<std::uint32_t> surface_groups(const io::FactorPart& part) {
    std::vector<std::uint32_t> groups;
    groups.reserve(part.surfaces.size());
    for (const Surface& surface : part.surfaces) {
        groups.push_back(surface.group);
    }
    return groups;
}

/// @throws InputError if two parts are not of one scene by one renderer with one group of settings
void check_same_run(const std::filesystem::path& a_file, const io::FactorPart& a,
                    const std::filesystem::path& b_file, const io::FactorPart& b) {
    const std::string files =
        fmt::format("{}: a part of another run than {}", b_file.string(), a_file.string());
    if (const auto found = io::difference(b.key, a.key)) {
        throw InputError(fmt::format("{}: {} {}, there {}", files, found->name, found->here, found->there));
    }
    if (a.size != b.size || a.groups != b.groups || surface_groups(a) != surface_groups(b) ||
        a.parts != b.parts) {
        throw InputError(fmt::format("{}: its patches are in other groups", files));
    }
    if (a.visibility != b.visibility || a.estimated != b.estimated) {
        throw InputError(fmt::format("{}: its rows are of another kind", files));
    }
}

/// "rows 4 to 7", "row 4"
std::string rows_text(std::uint32_t first, std::uint32_t end) {
    return end - first == 1 ? fmt::format("row {}", first) : fmt::format("rows {} to {}", first, end - 1);
}

/// @param parts  by their first rows
/// @throws InputError where rows are in two parts, or in none
void check_all_rows(std::span<const KnownPart> parts) {
    std::vector<std::string> missing;
    std::uint32_t next = 0;
    for (std::size_t k = 0; k < parts.size(); ++k) {
        const io::FactorPart& part = parts[k].part;
        if (part.first < next) {
            throw InputError(fmt::format("{} and {}: both have {}", parts[k - 1].file.string(),
                                         parts[k].file.string(),
                                         rows_text(part.first, std::min(next, part.end))));
        }
        if (part.first > next) {
            missing.push_back(rows_text(next, part.first));
        }
        next = part.end;
    }
    if (next < parts.front().part.size) {
        missing.push_back(rows_text(next, parts.front().part.size));
    }
    if (!missing.empty()) {
        throw InputError(fmt::format("{} of {} are in no part", fmt::join(missing, ", "),
                                     count_text(parts.front().part.size)));
    }
}

KnownParts describe_parts(Paths files) {
    if (files.empty()) {
        throw InvalidArgument("no parts to merge");
    }
    KnownParts known;
    for (const std::filesystem::path& file : files) {
        io::FactorPart part = io::read_factor_part(file, io::FactorPartContent::description);
        if (known.parts.empty()) {
            known.mesh = part;
        } else {
            check_same_run(files.front(), known.mesh, file, part);
        }
        part.groups = {}; // once is enough of what takes as much as the scene
        part.surfaces = {};
        part.parts = {};
        known.parts.push_back({file, std::move(part), std::filesystem::file_size(file)});
    }
    std::stable_sort(known.parts.begin(), known.parts.end(),
                     [](const KnownPart& a, const KnownPart& b) { return a.part.first < b.part.first; });
    check_all_rows(known.parts);
    return known;
}

/// The scene, as far as form factors depend on it.
Scene scene_of(const io::FactorPart& part) {
    Scene scene;
    scene.materials.emplace_back();
    scene.materials.front().reflectance.assign(scene.channels.size(), 0.0);
    scene.materials.front().exitance.assign(scene.channels.size(), 0.0);
    scene.groups = part.groups;
    scene.surfaces = part.surfaces;
    scene.enclosure = part.enclosure;
    return scene;
}

PatchMesh mesh_of(const std::filesystem::path& file, const io::FactorPart& part) {
    try {
        PatchMesh mesh(scene_of(part));
        const auto stored = part.key.find("geometry");
        if (stored == part.key.end() || stored->second != fmt::format("{:016x}", mesh.geometry_hash())) {
            throw InputError("its patches are not those that its rows are of");
        }
        return mesh;
    } catch (const InputError& error) {
        throw InputError(fmt::format("{}: {}", file.string(), error.what()));
    }
}

/// A row by itself.
struct KeptRow {
    std::uint32_t patch;
    std::vector<std::uint32_t> columns;
    std::vector<float> values;
    std::vector<std::uint8_t> visibility;
    double environment;
    double blocked;

    KeptRow(std::uint32_t i, const RawRow& row)
        : patch(i), columns(row.columns.begin(), row.columns.end()),
          values(row.values.begin(), row.values.end()),
          visibility(row.visibility.begin(), row.visibility.end()), environment(row.environment),
          blocked(row.blocked) {}
    [[nodiscard]] RowView view() const { return {columns, values, visibility, environment, blocked}; }
};

/// The rows of all parts, one part in memory at a time; collects their better rows on the way.
template <class Row>
class PartRows : public BasicRowProvider<Row> {
public:
    using Sink = typename BasicRowProvider<Row>::Sink;

    PartRows(std::span<const KnownPart> parts, std::vector<KeptRow>& reference)
        : parts_(parts), reference_(reference) {}

    [[nodiscard]] std::uint32_t size() const override { return parts_.front().part.size; }
    [[nodiscard]] std::string renderer() const override { return parts_.front().part.provenance.renderer; }
    void rows(std::span<const std::uint32_t> patches, const Sink& sink) override {
        std::size_t next = 0;
        for (const KnownPart& known : parts_) {
            const io::FactorPart part = io::read_factor_part(known.file);
            if (part.key != known.part.key || part.first != known.part.first || part.end != known.part.end ||
                part.visibility != known.part.visibility) {
                throw InputError(fmt::format("{}: has changed meanwhile", known.file.string()));
            }
            for (; next < patches.size() && patches[next] < part.end; ++next) {
                stop_if_interrupted();
                sink(patches[next], row_from_raw<Row>(part.rows.row(patches[next])));
            }
            for (std::uint32_t i = 0; i < part.reference.size(); ++i) {
                if (part.reference.known(i)) {
                    reference_.emplace_back(i, part.reference.row(i));
                }
            }
        }
    }

private:
    std::span<const KnownPart> parts_;
    std::vector<KeptRow>& reference_;
};

/// The better rows of all parts.
class KeptRows : public VisibilityProvider {
public:
    KeptRows(std::span<const KeptRow> rows, std::uint32_t size) : rows_(rows), size_(size) {}

    [[nodiscard]] std::vector<std::uint32_t> patches() const {
        std::vector<std::uint32_t> result;
        for (const KeptRow& row : rows_) {
            result.push_back(row.patch);
        }
        return result;
    }
    [[nodiscard]] std::uint32_t size() const override { return size_; }
    [[nodiscard]] std::string renderer() const override { return "parts"; }
    void rows(std::span<const std::uint32_t> patches, const VisibilitySink& sink) override {
        for (const KeptRow& row : rows_) {
            if (std::binary_search(patches.begin(), patches.end(), row.patch)) {
                sink(row.patch, row_from_raw<VisibilityRow>(row.view()));
            }
        }
    }

private:
    std::span<const KeptRow> rows_;
    std::uint32_t size_;
};

/// @throws OutOfMemory if what the merge needs is more than it may have
void check_merge_memory(std::span<const KnownPart> parts, const FactorSettings& settings) {
    const io::FactorPart& first = parts.front().part;
    std::uint64_t entries = 0;
    std::uint64_t largest = 0;
    for (const KnownPart& known : parts) {
        entries += known.part.entries;
        largest = std::max(largest, known.bytes);
    }
    const double a_row = static_cast<double>(entries) / first.size;
    const std::uint64_t needed =
        largest + (first.visibility ? visibility_weighted_memory(a_row, first.size, first.size)
                                    : matrix_memory(a_row, first.size, first.size));
    if (needed > memory_limit(settings)) {
        throw OutOfMemory(fmt::format("{} of {} and the largest part would need {}; the limit is {}. {} "
                                      "would help",
                                      first.visibility ? "the pairs" : "the rows",
                                      plural(first.size, "patch", "patches"), memory_text(needed),
                                      memory_limit_text(settings),
                                      first.visibility ? "A machine with more memory, or parts of --preset "
                                                         "plain,"
                                                       : "A machine with more memory"),
                          {"max-memory"});
    }
}

} // namespace

io::FactorPart compute_factor_part(const Scene& scene, const PatchMesh& mesh, RowRange rows,
                                   const FactorSettings& settings, Observer& observer,
                                   RowCheckpoint* checkpoint) {
    if (rows.first >= rows.end || rows.end > mesh.size()) {
        throw InvalidArgument(fmt::format("rows {}:{}; must ascend, and there are {}", rows.first, rows.end,
                                          count_text(mesh.size())),
                              {"rows"});
    }
    if (!mesh.parts().empty()) {
        throw InvalidArgument("rows of patches that were cut further cannot be computed in parts");
    }
    if (mesh.symmetry()) {
        throw InvalidArgument(
            "rows of a scene with symmetry cannot be computed in parts; it has fewer rows as it "
            "is");
    }
    FormFactors factors = describe_form_factors(scene, mesh, settings);
    note_unoccluded(settings.method, observer);
    io::FactorPart part;
    part.first = rows.first;
    part.end = rows.end;
    part.size = mesh.size();
    part.enclosure = scene.enclosure;
    const bool hemicubes = settings.method == Method::hemicube;
    const RowPlan plan = hemicubes ? plan_rows(settings, mesh.size()) : RowPlan();
    part.visibility = plan.weighted.has_value();
    if (part.visibility) {
        const std::uint64_t pairs = visibility_weighted_memory(0.0, mesh.size(), mesh.size());
        if (pairs > memory_limit(settings)) {
            observer.warning(
                fmt::format("merging all parts will need more than {} for the pairs of {}; the limit here is "
                            "{}. Parts of --preset plain need less",
                            memory_text(pairs), plural(mesh.size(), "patch", "patches"),
                            memory_limit_text(settings)),
                "max-memory");
        }
        const auto engine = make_visibility_provider(mesh, plan.hemicube, settings);
        part.rows = compute_rows(factors, *engine, rows, settings, observer, checkpoint);
    } else {
        const auto engine = make_row_provider(mesh, settings);
        part.rows = compute_rows(factors, *engine, rows, settings, observer, checkpoint);
    }
    part.entries = shown_entries(part.rows);
    part.provenance = factors.provenance;
    part.key = raw_row_key(factors, settings);
    part.key["preset"] = part.provenance.preset ? to_word(*part.provenance.preset) : "none";
    part.key["shadow rays"] = std::to_string(part.provenance.shadow_rays);
    part.key["rule"] = to_word(part.provenance.exchange_rule);
    part.key["enclosure"] = to_word(part.enclosure);
    part.key["renderer"] = renderer_of_rows(part.provenance.renderer);
    part.key["error estimate"] =
        settings.estimate_error ? add_reference(part, mesh, settings, observer) : "none";
    return part;
}

FormFactors merge_factor_parts(Paths files, const FactorSettings& settings, Observer& observer) {
    KnownParts known = describe_parts(files);
    const std::vector<KnownPart>& parts = known.parts;
    check_merge_memory(parts, settings);
    const io::FactorPart& first = parts.front().part;
    const PatchMesh mesh = mesh_of(files.front(), known.mesh);
    FormFactors factors = describe_form_factors(scene_of(known.mesh), mesh, {});
    factors.provenance = first.provenance;
    factors.parts = std::move(known.mesh.parts);
    note_unoccluded(first.provenance.method, observer);
    factors.work.from_file = true;
    const auto progress = [&observer](Phase phase) {
        return [&observer, phase](std::size_t done, std::size_t total) {
            return observer.progress(phase, done, total);
        };
    };
    const std::vector<std::uint32_t> patches = all_patches(mesh.size());
    std::vector<KeptRow> better;
    if (first.visibility) {
        PartRows<VisibilityRow> rows(parts, better);
        factors.matrix = compute_visibility_weighted(
            rows, mesh, patches, {first.provenance.exchange_rule, first.provenance.shadow_rays},
            first.enclosure, progress(Phase::visibility), progress(Phase::pairs),
            progress(Phase::form_factors));
    } else {
        PartRows<RowView> rows(parts, better);
        factors.matrix = compute_matrix(rows, patches, progress(Phase::form_factors));
    }
    factors.touching = find_touching_faces(factors.matrix, mesh);
    if (first.estimated) {
        KeptRows rows(better, mesh.size());
        const std::vector<std::uint32_t> sampled = rows.patches();
        factors.reference = compute_reference(rows, mesh, sampled, progress(Phase::error_estimate));
    }
    return factors;
}

} // namespace hemi
