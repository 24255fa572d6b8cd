#include "support/device.hpp"
#include "support/scenes.hpp"

#include "hemi/engine/exchange_area.hpp"
#include "hemi/io/scene_reader.hpp"
#include "hemi/pipeline/form_factors.hpp"

#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

using namespace hemi;
using namespace hemi::test;

namespace {

GroupTable groups_by(Preset preset, const Scene& scene) {
    const PatchMesh mesh(scene);
    FactorSettings settings;
    settings.preset = preset;
    settings.estimate_error = false;
    settings.engine.device = test_device();
    const FormFactors factors = compute_form_factors(scene, mesh, settings);
    return by_group(mesh, factors.matrix);
}

/// A duct 2 wide and 1 high along x.
Scene duct(double length, bool closed) {
    Scene scene = empty_scene();
    add_room(scene, Vec3(0.0), Vec3(length, 2.0, 1.0), 1);
    std::erase_if(scene.surfaces, [&](const Surface& surface) {
        return !closed && scene.groups[surface.group].front() == 'x';
    });
    return scene;
}

/// Share of what leaves a wall of a duct that leaves by its ends.
double through_ends(double length, const std::string& wall) {
    const PatchMesh mesh(duct(length, true));
    const ExchangeAreas exchange(mesh, ExchangeRule::exact);
    double area = 0.0;
    double ends = 0.0;
    for (std::uint32_t i = 0; i < mesh.size(); ++i) {
        for (std::uint32_t j = 0; j < mesh.size() && mesh.groups()[mesh.group(i)] == wall; ++j) {
            area = mesh.areas()[i];
            ends += mesh.groups()[mesh.group(j)].front() == 'x' ? exchange(i, j) : 0.0;
        }
    }
    return ends / area;
}

/// A tube of radius 0.30 seen from within and 0.32 seen from outside, 0.6 long, in a tube of radius 0.40 that
/// is 0.1 longer at either end: from the inner tube the outer one is seen through the open ends only.
Scene tube_in_tube(int sides) {
    Scene scene = empty_scene();
    const auto add_tube = [&](const char* name, double radius, double from, double to, bool inward) {
        const auto at = [&](double x, int side) {
            const double angle = 2.0 * std::numbers::pi * (side + 0.5) / sides;
            return Vec3(x, radius * std::cos(angle), radius * std::sin(angle));
        };
        for (int side = 0; side < sides; ++side) {
            std::vector<Vec3> strip{at(from, side), at(to, side), at(to, side + 1), at(from, side + 1)};
            if (!inward) {
                std::reverse(strip.begin(), strip.end());
            }
            add_polygon(scene, name, strip);
        }
    };
    add_tube("in", 0.30, 0.2, 0.8, true);
    add_tube("out", 0.32, 0.2, 0.8, false);
    add_tube("shield", 0.40, 0.1, 0.9, true);
    return scene;
}

} // namespace

TEST_CASE("long patches: a tube seen through the open ends of another",
          "[pipeline][gl][every-device][long-patches]") {
    // Right: 4e6 rays, to 2e-5.
    const Scene scene = tube_in_tube(16);
    CHECK(groups_by(Preset::standard, scene).factor("in", "shield") ==
          Approx(0.055673).margin(3e-4).epsilon(0));
    CHECK(groups_by(Preset::exact, scene).factor("in", "shield") == Approx(0.055673).margin(1e-4).epsilon(0));
}

TEST_CASE("long patches: a needle of 100 : 1 that looks past an edge at a grazing angle",
          "[pipeline][gl][every-device][long-patches]") {
    // Right: 2e7 rays, to 1e-5. The facade's own few points are what is left of the error.
    const Scene scene = io::read_scene(data_path("needle-past-an-edge.vs3"));
    CHECK(groups_by(Preset::standard, scene).factor("needle", "facade") ==
          Approx(0.74170).margin(2.5e-3).epsilon(0));
    CHECK(groups_by(Preset::exact, scene).factor("needle", "facade") ==
          Approx(0.74170).margin(5e-4).epsilon(0));
}

TEST_CASE("long patches: the open ends of long ducts are what the walls' factors leave, though no eye meets "
          "them",
          "[pipeline][gl][long-patches]") {
    CHECK(through_ends(1000.0, "z0") == Approx(0.000648).margin(1e-6).epsilon(0));
    for (const double length : {1000.0, 3000.0}) {
        Scene scene = duct(length, false);
        const PatchMesh mesh(scene);
        for (const Enclosure enclosure : {Enclosure::automatic, Enclosure::open}) {
            scene.enclosure = enclosure;
            for (const Clusters clusters : {Clusters::off, Clusters::on}) {
                FactorSettings settings;
                settings.preset = length < 2000.0 ? Preset::standard : Preset::exact;
                settings.clusters = clusters;
                settings.estimate_error = false;
                settings.engine.device = test_device();
                const FormFactors factors = compute_form_factors(scene, mesh, settings);
                for (std::uint32_t i = 0; i < mesh.size(); ++i) {
                    INFO(length << " long, " << to_word(enclosure) << ", clusters " << to_word(clusters)
                                << ": " << mesh.groups()[mesh.group(i)]);
                    const double right = through_ends(length, mesh.groups()[mesh.group(i)]);
                    CHECK(factors.matrix.row(i).environment == Approx(right).margin(3e-5).epsilon(0));
                    CHECK(factors.matrix.row(i).sum() == Approx(1.0 - right).margin(3e-5).epsilon(0));
                }
            }
        }
    }
}

TEST_CASE("long patches: a long room is closed by its walls, or but for a hair by their factors",
          "[pipeline][gl][long-patches]") {
    for (const double gap : {0.0, 1e-4}) {
        Scene scene = duct(300.0, true);
        for (Surface& surface : scene.surfaces) {
            for (Vec3& vertex : surface.vertices) {
                vertex.z += scene.groups[surface.group] == "z1" ? gap : 0.0;
            }
        }
        const PatchMesh mesh(scene);
        FactorSettings settings;
        settings.preset = Preset::exact;
        settings.estimate_error = false;
        settings.engine.device = test_device();
        const FormFactors factors = compute_form_factors(scene, mesh, settings);
        for (std::uint32_t i = 0; i < mesh.size(); ++i) {
            INFO(gap << ": " << mesh.groups()[mesh.group(i)]);
            CHECK(factors.matrix.row(i).environment <= 2.0 * gap);
            CHECK(factors.matrix.row(i).sum() == Approx(1.0).margin(1e-6 + 2.0 * gap).epsilon(0));
        }
    }
}
