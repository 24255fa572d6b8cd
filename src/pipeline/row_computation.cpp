#include "pipeline/row_computation.hpp"

#include "core/fnv1a.hpp"
#include "hemi/core/error.hpp"
#include "hemi/core/text.hpp"
#include "hemi/engine/reference_rows.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace hemi {

namespace {

// Of the time that the rows took, spent on reference rows.
constexpr double reference_share = 0.08;

} // namespace

std::vector<std::uint8_t> emitting_patches(const Scene& scene, const PatchMesh& mesh) {
    return emitting_patches(mesh.size(), patch_values(mesh, scene.materials, &Material::exitance));
}

std::vector<std::uint8_t> emitting_patches(std::uint32_t patches, std::span<const double> exitance) {
    const std::size_t channels = patches > 0 ? exitance.size() / patches : 0;
    std::vector<std::uint8_t> emits(patches, 0);
    for (std::size_t k = 0; k < exitance.size(); ++k) {
        if (exitance[k] > 0.0) {
            emits[k / channels] = 1;
        }
    }
    return emits;
}

FormFactors describe_form_factors(const Scene& scene, const PatchMesh& mesh, const FactorSettings& settings) {
    FormFactors factors;
    factors.areas.assign(mesh.areas().begin(), mesh.areas().end());
    factors.groups = mesh.groups();
    factors.group_of.reserve(mesh.size());
    for (std::uint32_t i = 0; i < mesh.size(); ++i) {
        factors.group_of.push_back(mesh.group(i));
    }
    factors.geometry_hash = mesh.geometry_hash();
    factors.enclosure = scene.enclosure;
    factors.provenance = provenance_of(settings, mesh.size());
    factors.matrix = FormFactorMatrix(mesh.size());
    return factors;
}

io::CheckpointKey raw_row_key(const FormFactors& factors, const FactorSettings& settings) {
    const bool hemicubes = settings.method == Method::hemicube;
    const RowPlan plan = hemicubes ? plan_rows(settings, factors.matrix.size()) : RowPlan();
    io::CheckpointKey key{{"hemi", HEMI_VERSION},
                          {"geometry", fmt::format("{:016x}", factors.geometry_hash)},
                          {"method", std::string(to_word(factors.provenance.method))},
                          {io::kind_of_rows, plan.weighted ? "visibility" : "form factors"},
                          {"resolution", std::to_string(factors.provenance.resolution)},
                          {"seed", std::to_string(factors.provenance.seed)},
                          {"eye points", std::to_string(plan.hemicube.eye_points)},
                          {"eye points near surfaces", std::to_string(plan.hemicube.near_eye_points)},
                          {"merging", plan.hemicube.merge_lattices ? "on" : "off"}};
    if (!hemicubes) {
        key["rays"] = std::to_string(plan_baseline(settings).rays);
    }
    return key;
}

io::CheckpointKey clustered_row_key(const FormFactors& factors, const FactorSettings& settings,
                                    const ClusterSettings& clusters) {
    Fnv1a apart;
    for (std::uint32_t patch = 0; patch < clusters.apart.size(); ++patch) {
        if (clusters.apart[patch] != 0) {
            apart.add(patch);
        }
    }
    io::CheckpointKey key = raw_row_key(factors, settings);
    key[io::kind_of_rows] = "clusters";
    key["cluster error"] = fmt::format("{}", settings.cluster_error);
    key["exchange rule"] = clusters.rule == ExchangeRule::exact ? "exact" : "standard";
    key["eye points"] = std::to_string(factors.provenance.eye_points);
    key["lamps"] = fmt::format("{:016x}", apart.value());
    return key;
}

std::string memory_limit_text(const FactorSettings& settings) {
    return memory_text(memory_limit(settings)) +
           (settings.max_memory ? "" : ", 80 % of the memory that is free");
}

void note_unoccluded(Method method, Observer& observer) {
    if (method == Method::direct || method == Method::contour) {
        observer.note(fmt::format("method {} finds unoccluded factors", to_word(method)));
    }
}

void check_estimate(const MatrixEstimate& estimate, std::size_t rows, const FactorSettings& settings,
                    Observer& observer, std::string_view advice) {
    observer.detail(fmt::format("{} rows will need about {} and {}", count_text(rows),
                                memory_text(estimate.memory_bytes), seconds_text(estimate.seconds)));
    if (estimate.memory_bytes > memory_limit(settings)) {
        throw OutOfMemory(
            fmt::format("{} rows of about {:.0f} entries would need {}; the limit is {}. {} would help",
                        count_text(rows), estimate.entries_per_row, memory_text(estimate.memory_bytes),
                        memory_limit_text(settings), advice),
            {"patch-size", "resolution", "max-memory", "scratch"});
    }
}

void check_memory(RowProvider& engine, std::span<const std::uint32_t> patches, const FactorSettings& settings,
                  Observer& observer, std::string_view advice) {
    if (patches.size() > unsampled_rows) {
        check_estimate(estimate_matrix(engine, patches, sampled_rows), patches.size(), settings, observer,
                       advice);
    }
}

VisibilityWeightedEstimate estimate_pairs(VisibilityProvider& visibility, const PatchMesh& mesh,
                                          std::span<const std::uint32_t> patches, std::uint32_t samples) {
    VisibilityWeightedEstimate estimate = estimate_visibility_weighted(visibility, patches, samples);
    if (mesh.symmetry()) { // of which it counted every image; a row has no more entries than patches
        estimate.entries_per_row = std::min<double>(estimate.entries_per_row, mesh.size());
        estimate.memory_bytes =
            visibility_weighted_memory(estimate.entries_per_row, patches.size(), visibility.size());
    }
    return estimate;
}

ReferencePlan plan_reference(std::span<const std::uint32_t> known, const FactorSettings& settings,
                             std::uint32_t size, std::uint32_t most) {
    FactorSettings hemicubes = settings;
    hemicubes.method = Method::hemicube;
    const HemicubeSettings hemicube = plan_rows(hemicubes, size).hemicube;
    return {reference_settings(hemicube),
            reference_patches(known, reference_count(hemicube, known.size(), reference_share, most))};
}

} // namespace hemi
