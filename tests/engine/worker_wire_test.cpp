#include "engine/workers/worker_wire.hpp"
#include "support/scenes.hpp"

#include <catch2/catch.hpp>

using namespace hemi;
using namespace hemi::test;
using Catch::Matchers::Contains;

namespace {

std::string packed(const PatchMesh& mesh) {
    const HemicubeSettings settings{.resolution = 32, .seed = 7, .eye_points = 4};
    return pack(make_engine_geometry(mesh, settings), settings, RowQuantity::visibility, "osmesa");
}

UnpackedGeometry unpacked(const std::string& bytes) {
    return unpack(std::as_bytes(std::span(bytes)));
}

} // namespace

TEST_CASE("workers: geometry and settings arrive as they were sent", "[engine]") {
    const PatchMesh mesh(open_corner());
    const UnpackedGeometry arrived = unpacked(packed(mesh));
    CHECK(arrived.settings == HemicubeSettings{.resolution = 32, .seed = 7, .eye_points = 4});
    CHECK(arrived.quantity == RowQuantity::visibility);
    CHECK(arrived.device == "osmesa");
    CHECK(arrived.geometry.eyes.patches() == mesh.size());
    CHECK(arrived.geometry.list.item_of_id == make_engine_geometry(mesh, arrived.settings).list.item_of_id);
}

TEST_CASE("workers: a worker of another build refuses, and the error names both", "[engine]") {
    CHECK_NOTHROW(check_same_build(worker_build(), worker_build()));
    CHECK_THROWS_WITH(check_same_build("9.9.9 (layout 1)", worker_build()),
                      Contains("9.9.9 (layout 1)") && Contains(worker_build()));

    std::string bytes = packed(PatchMesh(open_corner()));
    const std::size_t at = bytes.find(worker_build());
    REQUIRE(at != std::string::npos);
    bytes[at] = '9';
    CHECK_THROWS_AS(unpacked(bytes), OtherBuild);
    CHECK_THROWS_WITH(unpacked(bytes),
                      Contains(bytes.substr(at, worker_build().size())) && Contains(worker_build()));
    CHECK_THROWS_AS(unpacked("from before there were stamps"), OtherBuild);
    CHECK_THROWS_AS(unpacked(""), OtherBuild);
}

TEST_CASE("workers: a refusal is a packet of its own, which every build understands", "[engine]") {
    const OtherBuild reason("other");
    const std::string packet = refusal_packet(reason);
    CHECK(packet == "HEMIREFUother");
    CHECK(refusal_reason(packet) == "other");
    const FromWorker message;
    CHECK_FALSE(refusal_reason({reinterpret_cast<const char*>(&message), sizeof message}));
    CHECK(refusal_packet(OtherBuild(std::string(5000, 'x'))).size() == sizeof(FromWorker));
}

TEST_CASE("workers: bytes that are cut off are refused", "[engine]") {
    const std::string bytes = packed(PatchMesh(open_corner()));
    for (std::size_t size = 0; size < bytes.size(); size += 97) {
        CHECK_THROWS_AS(unpacked(bytes.substr(0, size)), Error);
    }
}

TEST_CASE("workers: a program hears why a worker refuses", "[engine][gl]") {
    // A worker that refuses at once, as one of another build does: fd 3 is its socket.
    const PatchMesh mesh(open_corner());
    const std::string script = data_path("workers/refuses.sh");
    const auto engine = make_hemicube_engine(mesh, {.resolution = 32}, {"osmesa", 1, script});
    CHECK_THROWS_WITH(engine->renderer(), "the worker program is of hemi 9.9.9");
}
