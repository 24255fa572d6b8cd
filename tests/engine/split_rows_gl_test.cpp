#include "support/device.hpp"
#include "support/item_agreement.hpp"
#include "support/scenes.hpp"

#include "engine/hemicube/gl_rows.hpp"
#include "engine/rasteriser/cpu_rows.hpp"
#include "hemi/engine/engine.hpp"
#include "hemi/engine/row_provider.hpp"
#include "hemi/engine/visibility_weighted.hpp"
#include "hemi/pipeline/form_factors.hpp"

#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>
#include <vector>

using namespace hemi;
using namespace hemi::test;

namespace {

/// A mesh split twice here and there, so that three sizes of patches meet, and where its patches come from.
struct Mixed {
    PatchMesh mesh;
    std::vector<std::uint32_t> parents;
};
Mixed mixed(const PatchMesh& coarse) {
    std::vector<std::uint32_t> some;
    for (std::uint32_t i = 0; i < coarse.size(); i += 1 + i % 5) {
        some.push_back(i);
    }
    auto [fine, parents] = coarse.split(some);
    std::vector<std::uint32_t> again;
    for (std::uint32_t k = 2; k < fine.size(); k += 2 + k % 7) {
        again.push_back(k);
    }
    auto [finer, between] = fine.split(again);
    for (std::uint32_t& parent : between) {
        parent = parents[parent];
    }
    return {std::move(finer), std::move(between)};
}

std::vector<Scene> scenes() {
    Scene sheets = lattice_room();
    add_polygon(sheets, "sheet",
                {Vec3(0.2, 0.3, 0.2), Vec3(0.7, 0.3, 0.2), Vec3(0.7, 0.5, 0.6), Vec3(0.2, 0.5, 0.6)}, {3, 2});
    sheets.surfaces.back().two_sided = true;
    return {room_with_blocks(4), tapered_box(3), sheets, t_junction_room()};
}

} // namespace

TEST_CASE("split patches: no texel is lost between pieces", "[engine][every-device]") {
    for (const Scene& scene : scenes()) {
        const Mixed fine = mixed(PatchMesh(scene));
        HemicubeSettings settings;
        settings.resolution = 64;
        EngineSettings engine;
        engine.device = test_device();
        engine.jobs = 1;
        const FormFactorMatrix rows = compute_matrix(*make_hemicube_engine(fine.mesh, settings, engine));
        for (std::uint32_t k = 0; k < fine.mesh.size(); ++k) {
            const RowView row = rows.row(k);
            REQUIRE(std::abs(1.0 - row.sum() - row.environment - row.blocked) < 1e-6);
            // All these rooms are closed; a block's foot sees nothing at all.
            REQUIRE((row.environment < 1e-4 || row.environment == 1.0));
        }
    }
}

TEST_CASE("split patches: item buffers show what rays meet", "[engine][slow]") {
    for (const Scene& scene : scenes()) {
        const Mixed fine = mixed(PatchMesh(scene));
        HemicubeSettings settings;
        settings.resolution = 32;
        const EngineGeometry geometry = make_engine_geometry(fine.mesh, settings);
        const RasterScene raster(geometry.list);
        CpuRows cpu(geometry, raster, settings, RowQuantity::form_factors);
        GlRows clipped(geometry, settings, RowQuantity::form_factors, "osmesa");
        const WithTransform transform("gpu");
        GlRows on_gpu(geometry, settings, RowQuantity::form_factors, "osmesa");
        for (std::uint32_t patch = 0; patch < fine.mesh.size(); patch += 11) {
            INFO("patch " << patch);
            CHECK(disagreements(fine.mesh, settings, patch, 1e-3, cpu) == 0);
            // Vertices that are snapped uncover what an edge hides in very few texels.
            CHECK(disagreements(fine.mesh, settings, patch, 1.0 / 256.0, clipped) <= 1);
            CHECK(disagreements(fine.mesh, settings, patch, 1.0 / 256.0, on_gpu) <= 1);
        }
        for (std::uint32_t s = 0; s < fine.mesh.surfaces().size(); ++s) {
            const std::uint32_t pieces = geometry.list.polygons_of_surface[s].count;
            CHECK((fine.mesh.parts(s).empty() ? pieces == 1 : pieces > 1));
        }
    }
}

TEST_CASE("split patches: factors are those of a mesh that is as fine everywhere", "[engine][every-device]") {
    // Of a room with blocks: every fourth patch is split; its parts have the factors of the finer mesh.
    Scene scene = room_with_blocks(4);
    const PatchMesh coarse(scene);
    std::vector<std::uint32_t> some;
    for (std::uint32_t i = 0; i < coarse.size(); i += 4) {
        some.push_back(i);
    }
    const auto [mixed_mesh, parents] = coarse.split(some, Cut::in_four);
    const auto [fine, fine_parents] = coarse.split(all_patches(coarse.size()), Cut::in_four);
    FactorSettings settings;
    settings.engine.device = test_device();
    settings.engine.jobs = 2;
    settings.estimate_error = false;
    const FormFactors here = compute_form_factors(scene, mixed_mesh, settings);
    const FormFactors there = compute_form_factors(scene, fine, settings);
    std::vector<std::uint32_t> same(mixed_mesh.size(), fine.size()); // the patch of the finer mesh
    for (std::uint32_t k = 0; k < mixed_mesh.size(); ++k) {
        for (std::uint32_t f = 0; f < fine.size(); ++f) {
            if (mixed_mesh.surface_of()[k] == fine.surface_of()[f] &&
                mixed_mesh.is_back(k) == fine.is_back(f) &&
                glm::distance(mixed_mesh.centres()[k], fine.centres()[f]) < 1e-12) {
                same[k] = f;
            }
        }
    }
    double squares = 0.0;
    double sum = 0.0;
    for (std::uint32_t k = 0; k < mixed_mesh.size(); ++k) {
        if (same[k] == fine.size()) {
            continue;
        }
        const RowView row = here.matrix.row(k);
        const RowView right = there.matrix.row(same[k]);
        std::vector<double> expected(coarse.size(), 0.0);
        for (std::size_t e = 0; e < right.columns.size(); ++e) {
            expected[fine_parents[right.columns[e]]] += static_cast<double>(right.values[e]);
        }
        for (std::size_t e = 0; e < row.columns.size(); ++e) {
            expected[parents[row.columns[e]]] -= static_cast<double>(row.values[e]);
        }
        for (const double difference : expected) {
            squares += difference * difference;
        }
        sum += 1.0;
    }
    CHECK(sum > 50.0);
    CHECK(std::sqrt(squares / sum) < 0.006); // of a row, 2-norm
}
