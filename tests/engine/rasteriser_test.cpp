#include "engine/hemicube/gl_rows.hpp"
#include "engine/rasteriser/cpu_rows.hpp"
#include "support/device.hpp"
#include "support/item_agreement.hpp"
#include "support/scenes.hpp"

#include "hemi/core/error.hpp"
#include "hemi/io/scene_reader.hpp"
#include "hemi/scene/imprint.hpp"

#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <memory>
#include <numeric>
#include <optional>
#include <random>

using namespace hemi;
using namespace hemi::test;

namespace {

/// Has the CPU rasteriser use an instruction set.
class WithSimd : WithVariable {
public:
    explicit WithSimd(const char* name) : WithVariable("HEMI_SIMD", name) {}
};

/// The CPU rasteriser on a mesh.
struct Drawn {
    Drawn(const PatchMesh& mesh, const HemicubeSettings& the_settings,
          RowQuantity quantity = RowQuantity::form_factors)
        : settings(the_settings), geometry(make_engine_geometry(mesh, settings)), scene(geometry.list),
          rows(geometry, scene, settings, quantity) {}

    HemicubeSettings settings;
    EngineGeometry geometry;
    RasterScene scene;
    CpuRows rows;
};

// What the rasteriser claims: texels' centres further than this from an edge are decided right.
constexpr double edge_margin = 1e-3;

// And llvmpipe, which snaps vertices.
constexpr double llvmpipe_margin = 1.0 / 256.0;

/// The rasteriser, and OpenGL that transforms polygons as on a GPU.
void check_against_rays(const PatchMesh& mesh, const HemicubeSettings& settings, std::uint32_t step) {
    Drawn drawn(mesh, settings);
    const auto gl_rows = [&](const char* where) {
        const WithTransform transform(where);
        return std::make_unique<GlRows>(drawn.geometry, settings, RowQuantity::form_factors, "osmesa");
    };
    const auto transformed = gl_rows("gpu");
    const auto clipped = gl_rows("cpu");
    for (std::uint32_t patch = 0; patch < mesh.size(); patch += step) {
        INFO("patch " << patch);
        CHECK(disagreements(mesh, settings, patch, edge_margin, drawn.rows) == 0);
        // Vertices that are snapped uncover what an edge hides in very few texels, whoever transformed them.
        if (const std::size_t wrong = disagreements(mesh, settings, patch, llvmpipe_margin, *transformed);
            wrong > 0) {
            CHECK(wrong <= disagreements(mesh, settings, patch, llvmpipe_margin, *clipped));
            CHECK(wrong <= 1);
        }
    }
}

/// A wavy sphere of triangles of which no two lie in one plane, 2n round and n high.
/// @param inward  whether it is seen from within
void add_wavy_ball(Scene& scene, const char* name, const Vec3& centre, double radius, std::uint32_t n,
                   bool inward) {
    const auto at = [&](std::uint32_t ring, std::uint32_t sector) {
        const double theta = M_PI * ring / n;
        const double phi = 2.0 * M_PI * (sector % (2 * n)) / (2 * n);
        const Vec3 d(std::sin(theta) * std::cos(phi), std::sin(theta) * std::sin(phi), std::cos(theta));
        return centre + d * radius *
                            (1.0 + 0.06 * std::sin(5.0 * d.x + 1.0) * std::sin(7.0 * d.y) +
                             0.04 * std::sin(9.0 * d.z + d.x));
    };
    const auto add = [&](const Vec3& a, const Vec3& b, const Vec3& c) {
        add_polygon(scene, name, inward ? std::vector{a, c, b} : std::vector{a, b, c});
    };
    for (std::uint32_t ring = 0; ring < n; ++ring) {
        for (std::uint32_t sector = 0; sector < 2 * n; ++sector) {
            const Vec3 a = at(ring, sector);
            const Vec3 b = at(ring + 1, sector);
            const Vec3 c = at(ring + 1, sector + 1);
            const Vec3 d = at(ring, sector + 1);
            if (ring + 1 < n) {
                add(a, b, c);
            }
            if (ring > 0) {
                add(a, c, d);
            }
        }
    }
}

/// A closed surface of triangles: a wavy sphere, seen from within, round a wavy body.
Scene bumpy_cave(std::uint32_t n) {
    Scene scene = empty_scene();
    add_wavy_ball(scene, "cave", Vec3(0.0), 1.0, n, true);
    add_wavy_ball(scene, "body", Vec3(0.0), 0.35, n, false);
    return scene;
}

/// Blocks of different heights in rows, from the floor to the ceiling some of them, and wavy balls where the
/// streets cross: most of it is hidden from most of it.
Scene streets() {
    constexpr int blocks = 6;
    Scene scene = empty_scene();
    add_room(scene, Vec3(0.0), Vec3(blocks, blocks, 1.0), 6);
    for (int x = 0; x < blocks; ++x) {
        for (int y = 0; y < blocks; ++y) {
            const Vec3 lower(x + 0.15, y + 0.15, 0.0);
            add_block(scene, "block", lower, lower + Vec3(0.7, 0.7, 0.4 + 0.1 * ((3 * x + 5 * y) % 7)), 3);
            if (x > 0 && y > 0) {
                add_wavy_ball(scene, "ball", Vec3(x, y, 0.3), 0.12, 5, false);
            }
        }
    }
    return scene;
}

/// Weights and numbers of the texels of every draw id.
std::vector<TexelTally> tally(std::span<const std::uint32_t> ids, const TileWeights& weights,
                              std::size_t draw_ids) {
    std::vector<TexelTally> sums(draw_ids, 0);
    for (std::size_t texel = 0; texel < ids.size(); ++texel) {
        sums[ids[texel]] += weights.texel[texel];
    }
    return sums;
}

/// Checks that shares of visibility agree up to what texels at edges make.
/// @param a,b  of all pairs of `patches`; below 0: not known
void check_alike(const std::vector<float>& a, const std::vector<float>& b, std::size_t patches) {
    double squares = 0.0;
    std::size_t both = 0;
    std::size_t one = 0; // a patch whose only texels lie at edges
    for (std::size_t k = 0; k < a.size(); ++k) {
        if (a[k] >= 0.0f && b[k] >= 0.0f) {
            squares += std::pow(static_cast<double>(a[k] - b[k]), 2.0);
            ++both;
        } else {
            one += (a[k] >= 0.0f) != (b[k] >= 0.0f) ? 1 : 0;
        }
    }
    CHECK(both > patches * 10);
    CHECK(std::sqrt(squares / static_cast<double>(both)) < 0.01);
    CHECK(one < both / 100);
}

/// A room with needles on its floor and under its ceiling.
Scene needle_room() {
    Scene scene = empty_scene();
    add_room(scene, Vec3(0.0), Vec3(2.0, 1.0, 1.0), 3);
    for (int k = 0; k < 6; ++k) {
        const double y = 0.1 + 0.15 * k;
        add_polygon(scene, "needle",
                    {Vec3(0.1, y, 0.3), Vec3(1.9, y + 0.02, 0.35), Vec3(1.9, y + 0.021, 0.35),
                     Vec3(0.1, y + 0.001, 0.3)});
        add_polygon(scene, "splinter",
                    {Vec3(0.1, y, 0.6), Vec3(1.9, y + 0.07, 0.7), Vec3(1.0, y + 0.0355, 0.6505)});
    }
    return scene;
}

/// Two sheets that intersect and one that touches the floor, all seen from both sides.
Scene sheets() {
    Scene scene = empty_scene();
    add_room(scene, Vec3(0.0), Vec3(1.0), 3);
    const auto add = [&](const char* name, std::vector<Vec3> polygon) {
        add_polygon(scene, name, std::move(polygon), {3, 2});
        scene.surfaces.back().two_sided = true;
    };
    add("upright", {Vec3(0.5, 0.2, 0.0), Vec3(0.5, 0.8, 0.0), Vec3(0.5, 0.8, 0.6), Vec3(0.5, 0.2, 0.6)});
    add("slanted", {Vec3(0.2, 0.3, 0.2), Vec3(0.8, 0.3, 0.5), Vec3(0.8, 0.7, 0.5), Vec3(0.2, 0.7, 0.2)});
    return scene;
}

/// A room with turned blocks on its floor, whose faces are cut where these stand: what is left has corners of
/// its neighbours all along its sides.
/// @param grain  coordinates are multiples of it, as in a text file; 0: they are as they come out
Scene cut_room(double grain) {
    Scene scene = empty_scene();
    add_room(scene, Vec3(0.0), Vec3(1.2, 1.0, 0.8), 10);
    for (const double x : {0.35, 0.85}) {
        const std::size_t before = scene.surfaces.size();
        add_block(scene, "block", Vec3(-0.15, -0.2, 0.0), Vec3(0.15, 0.2, 0.3 + 0.3 * x), 5);
        for (std::size_t s = before; s < scene.surfaces.size(); ++s) {
            for (Vec3& vertex : scene.surfaces[s].vertices) {
                vertex = Vec3(x + std::cos(x) * vertex.x - std::sin(x) * vertex.y,
                              0.5 + std::sin(x) * vertex.x + std::cos(x) * vertex.y, vertex.z);
            }
        }
    }
    scene = imprint(scene).value().scene;
    for (Surface& surface : scene.surfaces) {
        for (Vec3& vertex : surface.vertices) {
            vertex = grain > 0.0 ? grain * glm::round(vertex / grain) : vertex;
        }
    }
    return scene;
}

} // namespace

TEST_CASE("Rasteriser and OpenGL: item buffers equal rays through the texel centres", "[engine][gl][slow]") {
    const HemicubeSettings settings{.resolution = 64};
    SECTION("a room with blocks") {
        check_against_rays(PatchMesh(room_with_blocks(6)), settings, 17);
    }
    SECTION("other turns of the hemicubes") {
        check_against_rays(PatchMesh(room_with_blocks(4)), {.resolution = 64, .seed = 77}, 29);
    }
    SECTION("general quadrilaterals") {
        check_against_rays(PatchMesh(tapered_box(5)), settings, 13);
    }
    SECTION("T-junctions") {
        check_against_rays(PatchMesh(t_junction_room()), settings, 7);
    }
    SECTION("a lattice, merged") {
        check_against_rays(PatchMesh(lattice_room()), settings, 37);
    }
    SECTION("a lattice, face by face") {
        check_against_rays(PatchMesh(lattice_room()), {.resolution = 64, .merge_lattices = false}, 37);
    }
    SECTION("two rooms on either side of two sheets") {
        check_against_rays(PatchMesh(two_rooms()), settings, 5);
    }
    SECTION("an open corner") {
        check_against_rays(PatchMesh(open_corner()), settings, 11);
    }
    SECTION("triangles cut n² ways") {
        check_against_rays(
            PatchMesh(read_case("14_sphere_interior.obj"), {.patch_size = {}, .patches_per_face = 9}),
            {.resolution = 48}, 611);
    }
    SECTION("a bumpy cave") {
        check_against_rays(PatchMesh(bumpy_cave(16)), settings, 101);
    }
    SECTION("what is hidden as a whole") {
        check_against_rays(PatchMesh(streets()), settings, 97);
    }
    SECTION("what is hidden as a whole, face by face") {
        check_against_rays(PatchMesh(streets()), {.resolution = 50, .merge_lattices = false}, 193);
    }
    SECTION("needles") {
        check_against_rays(PatchMesh(needle_room()), settings, 5);
    }
    SECTION("faces that are cut where others stand on them") {
        check_against_rays(PatchMesh(cut_room(0.0)), settings, 31);
    }
    SECTION("a corner of a neighbour just inside a triangle") {
        // It touches the triangle's edge by the tolerance for rounding of files, and bends it inwards.
        Scene scene = empty_scene();
        add_polygon(scene, "cut", {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {4, 4});
        add_polygon(scene, "beside", {{0, 0, 0}, {0.5, -1, 0}, {0.99999, 1e-6, 0}});
        add_polygon(scene, "above", {{0, 0, 2}, {0, 3, 2}, {3, 0, 2}});
        check_against_rays(PatchMesh(scene), settings, 1);
    }
    SECTION("two-sided sheets that intersect") {
        check_against_rays(PatchMesh(sheets()), settings, 7);
    }
    SECTION("quadrilaterals that are planar but for rounding of files") {
        // Corners 1e-6 off the plane of the others: the eye lies off the plane of its own polygon.
        Scene scene = empty_scene();
        add_room(scene, Vec3(0.0), Vec3(1.0), 1);
        for (Surface& surface : scene.surfaces) {
            for (std::size_t k = 0; k < 4; ++k) {
                surface.vertices[k] += (k % 2 == 0 ? 4e-6 : -4e-6) * Vec3(1.0, 1.0, 1.0);
            }
        }
        const PatchMesh mesh(scene);
        Drawn drawn(mesh, settings);
        for (std::uint32_t patch = 0; patch < mesh.size(); ++patch) {
            CHECK(drawn.rows.row(patch).blocked < 1e-3);
        }
    }
    SECTION("a resolution that is no multiple of 8") {
        check_against_rays(PatchMesh(room_with_blocks(4)), {.resolution = 50}, 41);
    }
    SECTION("a thousand times larger and far from the origin") {
        check_against_rays(PatchMesh(moved(scaled(room_with_blocks(4), 1e3), Vec3(1e5, -1e5, 1e5))), settings,
                           41);
    }
}

TEST_CASE("Rasteriser: a merged lattice shows the same items as its faces", "[engine]") {
    const PatchMesh mesh(lattice_room());
    Drawn merged(mesh, {.resolution = 64});
    Drawn plain(mesh, {.resolution = 64, .merge_lattices = false});
    CHECK(merged.geometry.list.polygons.size() * 8 < plain.geometry.list.polygons.size());
    for (std::uint32_t patch = 0; patch < mesh.size(); patch += 37) {
        CHECK(merged.rows.items(patch) == plain.rows.items(patch));
    }
}

TEST_CASE("Rasteriser: every instruction set draws the same items", "[engine]") {
    for (const Scene& scene :
         {room_with_blocks(5), tapered_box(4), bumpy_cave(12), sheets(), needle_room(), cut_room(0.0)}) {
        const PatchMesh mesh(scene);
        std::vector<std::vector<std::uint32_t>> expected;
        for (const char* simd : {"scalar", "sse4", "avx2", "avx512"}) {
            INFO(simd);
            const WithSimd forced(simd);
            std::optional<Drawn> drawn;
            try {
                drawn.emplace(mesh, HemicubeSettings{.resolution = 56});
            } catch (const InvalidArgument&) { // not on this processor
                CHECK(std::string(simd) != "scalar");
                continue;
            }
            std::size_t k = 0;
            for (std::uint32_t patch = 0; patch < mesh.size(); patch += 1 + mesh.size() / 12, ++k) {
                const auto items = drawn->rows.items(patch);
                if (k == expected.size()) {
                    expected.push_back(items);
                }
                CHECK(items == expected[k]);
            }
        }
    }
}

TEST_CASE("Rasteriser: a polygon's coverage is what it shows where it is drawn alone", "[engine]") {
    for (const Scene& scene :
         {room_with_blocks(4), tapered_box(3), sheets(), needle_room(), bumpy_cave(5), cut_room(0.0)}) {
        const PatchMesh mesh(scene);
        const HemicubeSettings settings{.resolution = 44};
        const EngineGeometry geometry = make_engine_geometry(mesh, settings);
        const DrawList& list = geometry.list;
        const TexelTiles tiles(settings.resolution);
        const TileWeights weights(tiles, DeltaFormFactors(settings.resolution));
        const RasterScene all(list);
        const auto rasteriser = make_rasteriser(all, tiles);
        // Every polygon among the same vertices, so that all positions are the same bits.
        std::vector<DrawList> single_lists(list.polygons.size(), list);
        for (std::size_t p = 0; p < list.polygons.size(); ++p) {
            single_lists[p].polygons = {list.polygons[p]};
            single_lists[p].polygons_of_surface.assign(list.polygons_of_surface.size(), {1, 1}); // none
        }
        for (std::uint32_t patch = 0; patch < mesh.size(); patch += 1 + mesh.size() / 6) {
            const EyePoint& eye = geometry.eyes.of(patch)[0];
            const EyeFrame frame(eye.normal, patch, 0, settings.seed);
            Coverage coverage(list.item_of_id.size());
            rasteriser->draw(eye, frame, &weights, &coverage);
            const std::vector<TexelTally> seen = tally(rasteriser->ids(), weights, list.item_of_id.size());
            for (std::uint32_t p = 0; p < list.polygons.size(); ++p) {
                const DrawPolygon& polygon = list.polygons[p];
                if (list.polygons_of_surface[eye.surface].holds(p)) {
                    continue;
                }
                const RasterScene scene_of_one(single_lists[p]);
                const auto alone = make_rasteriser(scene_of_one, tiles);
                alone->draw(eye, frame, nullptr, nullptr);
                const std::vector<TexelTally> covered = tally(alone->ids(), weights, list.item_of_id.size());
                const bool cells = polygon.grid.u * polygon.grid.v > 1 || polygon.split != 0;
                const std::uint32_t cell_ids = polygon.grid.u * polygon.grid.v << polygon.split;
                for (const std::uint32_t first : {polygon.front_id, polygon.back_id}) {
                    for (std::uint32_t id = first; id != item_blocked && id < first + cell_ids; ++id) {
                        INFO("patch " << patch << ", polygon " << p << ", draw id " << id);
                        CHECK(coverage.of_id[id] + (cells ? seen[id] : 0) == covered[id]);
                    }
                }
            }
        }
    }
}

TEST_CASE("Rasteriser: leaving out what is hidden as a whole changes no texel", "[engine]") {
    const PatchMesh mesh(streets());
    for (const bool merged : {true, false}) {
        const HemicubeSettings settings{.resolution = 56, .merge_lattices = merged}; // without padding
        const EngineGeometry geometry = make_engine_geometry(mesh, settings);
        const RasterScene scene(geometry.list);
        const TexelTiles tiles(settings.resolution);
        const TileWeights weights(tiles, DeltaFormFactors(settings.resolution));
        const auto rasteriser = make_rasteriser(scene, tiles);
        const auto all = make_rasteriser(scene, tiles); // where coverage is wanted, everything is drawn
        for (std::uint32_t patch = 0; patch < mesh.size(); patch += 7) {
            const EyePoint& eye = geometry.eyes.of(patch)[0];
            const EyeFrame frame(eye.normal, patch, 0, settings.seed);
            Coverage coverage(geometry.list.item_of_id.size());
            rasteriser->draw(eye, frame, nullptr, nullptr);
            all->draw(eye, frame, &weights, &coverage);
            INFO("patch " << patch);
            CHECK(std::ranges::equal(rasteriser->ids(), all->ids()));
        }
    }
}

TEST_CASE("Rasteriser: an unknown instruction set is refused with those that are there", "[engine]") {
    const WithSimd forced("mmx");
    CHECK_THROWS_WITH(cpu_renderer(), Catch::Contains("HEMI_SIMD=mmx") && Catch::Contains("scalar"));
}

TEST_CASE("Rasteriser: no texel is lost in closed scenes", "[engine][slow]") {
    // Sums are integers: a row of a closed scene that sees no back face sums to exactly 1.
    for (const Scene& scene :
         {bumpy_cave(40), lattice_room(), room_with_blocks(12), cut_room(0.0), cut_room(1e-6)}) {
        const PatchMesh mesh(scene);
        std::uint32_t eyes = 0;
        for (std::uint64_t seed = 0; eyes < 35000; ++seed) {
            Drawn drawn(mesh, {.resolution = 32, .seed = seed});
            for (std::uint32_t patch = 0; patch < mesh.size(); ++patch, ++eyes) {
                const RawRow row = drawn.rows.row(patch);
                if (row.environment != 0.0) {
                    // Bottoms of blocks that stand on the floor look out of the room.
                    INFO("patch " << patch << ", seed " << seed);
                    REQUIRE(row.environment == 1.0);
                }
            }
        }
    }
}

TEST_CASE("GlRows: no texel is lost in closed scenes where polygons are transformed as on a GPU",
          "[engine][gl][slow]") {
    const WithTransform transform("gpu");
    for (const Scene& scene : {bumpy_cave(20), lattice_room(), room_with_blocks(12)}) {
        const PatchMesh mesh(scene);
        std::vector<std::uint32_t> all(mesh.size());
        std::iota(all.begin(), all.end(), 0u);
        std::uint32_t eyes = 0;
        for (std::uint64_t seed = 0; eyes < 6000; ++seed) {
            const HemicubeSettings settings{.resolution = 32, .seed = seed};
            const EngineGeometry geometry = make_engine_geometry(mesh, settings);
            GlRows rows(geometry, settings, RowQuantity::form_factors, "osmesa");
            rows.rows(all, [&](std::uint32_t patch, const RawRow& row) {
                ++eyes;
                if (row.environment != 0.0) {
                    // Bottoms of blocks that stand on the floor look out of the room.
                    INFO("patch " << patch << ", seed " << seed);
                    REQUIRE(row.environment == 1.0);
                }
            });
        }
    }
}

TEST_CASE(
    "GlRows: visibility is the same by outlines on the CPU and by counting on the GPU, up to texels at edges",
    "[engine][gl]") {
    for (const Scene& scene : {room_with_blocks(5), sheets(), tapered_box(4), bumpy_cave(8)}) {
        const PatchMesh mesh(scene);
        const HemicubeSettings settings{.resolution = 64, .eye_points = 4};
        const EngineGeometry geometry = make_engine_geometry(mesh, settings);
        std::vector<std::uint32_t> all(mesh.size());
        std::iota(all.begin(), all.end(), 0u);
        const auto shares = [&](const char* where) {
            const WithTransform transform(where);
            GlRows rows(geometry, settings, RowQuantity::visibility, "osmesa");
            std::vector<float> dense(std::size_t{mesh.size()} * mesh.size(), -1.0f);
            rows.rows(all, [&](std::uint32_t patch, const RawRow& row) {
                for (std::size_t k = 0; k < row.columns.size(); ++k) {
                    dense[std::size_t{patch} * mesh.size() + row.columns[k]] = row.values[k];
                }
            });
            return dense;
        };
        const auto outlines = shares("cpu");
        const auto counted = shares("gpu");
        check_alike(outlines, counted, mesh.size());
    }
}

TEST_CASE("CPU engine: the same rows from any number of threads, in order", "[engine]") {
    const PatchMesh mesh(room_with_blocks(6));
    for (const bool visibility : {false, true}) {
        const auto rows_of = [&](std::uint32_t threads) {
            std::vector<std::uint32_t> patches;
            std::vector<std::uint32_t> columns;
            std::vector<float> values;
            const HemicubeSettings settings{.resolution = 32};
            const auto engine = make_cpu_engine(
                std::make_unique<const EngineGeometry>(make_engine_geometry(mesh, settings)), settings,
                visibility ? RowQuantity::visibility : RowQuantity::form_factors, threads);
            std::vector<std::uint32_t> all(mesh.size());
            for (std::uint32_t i = 0; i < mesh.size(); ++i) {
                all[i] = i;
            }
            engine->rows(all, [&](std::uint32_t patch, const RawRow& row) {
                patches.push_back(patch);
                columns.insert(columns.end(), row.columns.begin(), row.columns.end());
                values.insert(values.end(), row.values.begin(), row.values.end());
            });
            CHECK(patches == all);
            return std::pair(columns, values);
        };
        const auto one = rows_of(1);
        CHECK(rows_of(3) == one);
        CHECK(rows_of(8) == one);
    }
}

TEST_CASE("CPU engine: what a sink throws ends the threads and is passed on", "[engine]") {
    const PatchMesh mesh(room_with_blocks(6));
    const auto engine = make_hemicube_engine(mesh, {.resolution = 32}, {"cpu", 3, {}});
    std::uint32_t rows = 0;
    std::vector<std::uint32_t> all(mesh.size());
    for (std::uint32_t i = 0; i < mesh.size(); ++i) {
        all[i] = i;
    }
    CHECK_THROWS_AS(engine->rows(all,
                                 [&](std::uint32_t, const RowView&) {
                                     if (++rows == 100) {
                                         throw Cancelled();
                                     }
                                 }),
                    Cancelled);
    CHECK(rows == 100);
    // It is of use afterwards.
    rows = 1000000;
    engine->rows(all, [&](std::uint32_t, const RowView& row) {
        ++rows;
        CHECK(row.sum() + row.environment + row.blocked == Approx(1.0).margin(1e-9).epsilon(0));
    });
    CHECK(rows == 1000000 + mesh.size());
}

TEST_CASE("CPU engine: visibility is that of OpenGL up to texels at edges", "[engine][gl]") {
    struct Named {
        Scene scene;
        std::uint32_t resolution;
    };
    for (const auto& [scene, resolution] : {Named{room_with_blocks(5), 64}, Named{room_with_blocks(5), 50},
                                            Named{sheets(), 64}, Named{tapered_box(4), 62}}) {
        const PatchMesh mesh(scene);
        const HemicubeSettings settings{.resolution = resolution, .eye_points = 4};
        std::vector<std::uint32_t> all(mesh.size());
        for (std::uint32_t i = 0; i < mesh.size(); ++i) {
            all[i] = i;
        }
        const auto shares = [&](const char* device) {
            std::vector<float> dense(std::size_t{mesh.size()} * mesh.size(), -1.0f);
            make_visibility_engine(mesh, settings, {device, 2, find_worker_program()})
                ->rows(all, [&](std::uint32_t patch, const VisibilityRow& row) {
                    for (std::size_t k = 0; k < row.columns.size(); ++k) {
                        dense[std::size_t{patch} * mesh.size() + row.columns[k]] = row.shares[k];
                    }
                });
            return dense;
        };
        const auto gl = shares("osmesa");
        const auto cpu = shares("cpu");
        check_alike(gl, cpu, mesh.size());
    }
}
