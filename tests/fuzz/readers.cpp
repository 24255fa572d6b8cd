#include "hemi/core/error.hpp"
#include "hemi/io/baked_mesh_file.hpp"
#include "hemi/io/factor_file.hpp"
#include "hemi/io/factor_part_file.hpp"
#include "hemi/io/output_file.hpp"
#include "hemi/io/result_file.hpp"
#include "hemi/io/scene_reader.hpp"
#include "hemi/io/table_file.hpp"
#include "hemi/matrix/source_clusters.hpp"
#include "io/factors/checkpoint_file.hpp"

#include <zlib.h>

#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <functional>
#include <limits>
#include <map>
#include <memory>
#include <string>

/// Gives bytes to one reader, as a file. Whatever they are, it must read them or throw InputError.
/// hemi_fuzz --reader=NAME [libFuzzer's options] CORPUS…;  hemi_fuzz --list;  hemi_fuzz --seeds=FOLDER
/// writes a small sound file, or more, for every reader into a folder of its name.
namespace {

namespace fs = std::filesystem;
using namespace hemi;

struct Reader {
    std::string file; ///< the name by which the bytes are read
    std::function<void(const fs::path&)> read;
    std::function<void(const fs::path& folder)> seed; ///< besides the project's own files; may be empty
    bool has_checksums = false;
};

void write(const fs::path& path, std::string_view text) {
    io::OutputFile file(path);
    file.write(text);
    file.commit();
}

void read_as_scene(const fs::path& path) {
    Diagnostics diagnostics;
    (void)io::read_scene(path, {}, diagnostics);
    (void)io::read_scene(path, {.strict = true}, diagnostics);
}

FormFactorMatrix small_matrix(bool visibility) {
    FormFactorMatrix matrix(2);
    RowBlock block;
    block.begin = {0, 1, 2};
    block.columns = {1, 0};
    block.values = {0.25f, 0.5f};
    block.visibility = visibility ? RowArray<std::uint8_t>{255, 100} : RowArray<std::uint8_t>{};
    block.environment = {0.75, 0.5};
    block.blocked = {0.0, 0.0};
    block.known = {1, 1};
    matrix.set_block(std::move(block));
    return matrix;
}

/// The two patches, and both of them as one.
std::shared_ptr<const SourceClusters> small_clusters() {
    return std::make_shared<const SourceClusters>(
        std::vector<std::uint32_t>{1, 0}, std::vector<SourceClusters::Node>{{0, 2, 1}, {0, 1, 0}, {1, 2, 0}},
        std::vector<double>{1.0, 0.5});
}

/// Of which the first row has a cluster.
FormFactorMatrix clustered_matrix() {
    std::vector<RowBlock> blocks = small_matrix(true).take_blocks();
    blocks[0].columns[0] = 2;
    FormFactorMatrix matrix(2, small_clusters());
    matrix.set_block(std::move(blocks[0]));
    return matrix;
}

/// Two patches that face each other.
Scene small_scene() {
    Scene scene;
    scene.materials = {{"white", {0.5}, {1.0}}};
    scene.groups = {"floor", "ceiling"};
    scene.environment = {0.0};
    Surface floor;
    floor.vertices = {Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(1, 1, 0), Vec3(0, 1, 0)};
    Surface ceiling;
    ceiling.vertices = {Vec3(0, 0, 1), Vec3(0, 1, 1), Vec3(1, 1, 1), Vec3(1, 0, 1)};
    ceiling.group = 1;
    scene.surfaces = {floor, ceiling};
    return scene;
}

void seed_hff(const fs::path& folder) {
    FormFactors file;
    file.matrix = small_matrix(true);
    file.areas = {1.0, 0.5};
    file.groups = {"floor", "ceiling"};
    file.group_of = {0, 1};
    file.touching = {1};
    io::write_hff(folder / "plain.hff", file);
    file.reference = small_matrix(true);
    file.error = FactorErrorEstimate{2, 1e-5, 1e-3, 1e-4, 1e-2, {0.1, 0.2}};
    io::write_hff(folder / "judged.hff", file);
    file.cuts = {{{1, 1}}, {{{1, 0, 0}, {1, 0, 1}}}};
    io::write_hff(folder / "cut.hff", file);
    file.matrix = clustered_matrix();
    io::write_hff(folder / "clusters.hff", file);
}

void seed_part(const fs::path& folder) {
    const PatchMesh mesh(small_scene());
    io::FactorPart part;
    part.end = part.size = 2;
    part.key = {{"seed", "0"}};
    part.visibility = part.estimated = true;
    part.rows = part.reference = small_matrix(true);
    io::write_factor_part(folder / "a.hff", mesh, part);
    part.parts = {{1, 0}, {0, 1}};
    part.visibility = false;
    part.rows = small_matrix(false);
    part.reference = FormFactorMatrix(0);
    io::write_factor_part(folder / "parts.hff", mesh, part);
}

void seed_hres(const fs::path& folder) {
    io::ResultFile result;
    result.scene = small_scene();
    Solution& solution = result.solution;
    solution.radiosity = {1.5, 1.25};
    solution.irradiance = {1.0, 0.5};
    solution.row_sum = solution.environment_share = {0.5, 0.5};
    solution.back_face_share = {0.0, 0.0};
    io::write_hres(folder / "a.hres", result);
    result.surfaces_as_read = result.scene.surfaces;
    result.parts.patch_of = {1, 1};
    io::write_hres(folder / "parts.hres", result);
    solution.exitance = {0.5, 0.25};
    solution.temperature = {300.0, std::numeric_limits<double>::quiet_NaN()};
    solution.net_flux = {-1.5, 2.0};
    result.scene.thermal = Thermal{};
    io::write_hres(folder / "heat.hres", result);
}

void seed_rows(const fs::path& folder) {
    io::CheckpointFile checkpoint(folder / "a", false);
    checkpoint.start({{"seed", "0"}}, FormFactorMatrix(2), {});
    checkpoint.append(small_matrix(true).blocks().front());
}

void seed_clustered_rows(const fs::path& folder) {
    io::CheckpointFile checkpoint(folder / "a", false);
    checkpoint.start({{"seed", "0"}}, FormFactorMatrix(2, small_clusters()), {});
    const std::vector<std::uint8_t> marks{1, 0};
    checkpoint.append(clustered_matrix().block(0), marks);
}

void seed_glb(const fs::path& folder) {
    const PatchMesh mesh(small_scene());
    io::write_baked_glb(folder / "a.glb", mesh, std::vector<float>(2 * 12, 0.5f), 1.0);
}

constexpr std::string_view gltf = R"({"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0]}],
"nodes":[{"name":"floor","mesh":0,"children":[1],"rotation":[0,0,0,1]},{"camera":0,"translation":[0,0,2]}],
"meshes":[{"primitives":[{"attributes":{"POSITION":0},"indices":1,"material":0}]}],
"materials":[{"name":"paint","doubleSided":true,"emissiveFactor":[1,1,1],"pbrMetallicRoughness":
{"baseColorFactor":[0.5,0.25,0.75,1]},"extensions":{"KHR_materials_emissive_strength":{"emissiveStrength":5}}}],
"cameras":[{"type":"perspective","perspective":{"yfov":0.8,"znear":0.1}}],
"accessors":[{"bufferView":0,"componentType":5126,"type":"VEC3","count":4},
{"bufferView":1,"componentType":5123,"type":"SCALAR","count":6}],
"bufferViews":[{"buffer":0,"byteLength":48},{"buffer":0,"byteOffset":48,"byteLength":12}],
"buffers":[{"byteLength":60,"uri":"square.bin"}]})";

constexpr std::string_view vs3 = "T Two squares\n! a comment\nC encl=0 list=3\nF 3\n"
                                 "V 1 0 0 0\nV 2 1 0 0\nV 3 1 1 0\nV 4 0 1 0\n"
                                 "V 5 0. 0. 1.\nV 6 1 0 1\nv 7 1.e0 1 1\nV 8 0 1 1\n"
                                 "S 1  1  2  3  4 0 0 0.5  low\ns 2  7  6  5  8 0 1 0.75 high\n"
                                 "O 3  1 2 3  0\nEnd of data\n";

constexpr std::string_view ply =
    "ply\nformat ascii 1.0\ncomment two faces\nelement vertex 4\nproperty float x\nproperty float "
    "y\nproperty float z\n"
    "element face 2\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n"
    "3 0 1 2\n3 0 2 3\n";

constexpr std::string_view stl = "solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\n"
                                 "vertex 0 1 0\nendloop\nendfacet\nendsolid a\n";

constexpr std::string_view msh =
    "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$PhysicalNames\n1\n2 1 \"floor\"\n$EndPhysicalNames\n$Nodes\n4\n"
    "1 0 0 0\n2 1 0 0\n3 1 1 0\n4 0 1 0\n$EndNodes\n$Elements\n2\n1 2 2 1 1 1 2 3\n2 3 2 1 1 1 2 3 4\n"
    "$EndElements\n";

constexpr std::string_view msh_4 = "$MeshFormat\n4.1 0 8\n$EndMeshFormat\n$PhysicalNames\n1\n2 9 "
                                   "\"floor\"\n$EndPhysicalNames\n$Entities\n0 0 1 0\n"
                                   "3 0 0 0 1 1 0 1 9 0\n$EndEntities\n$Nodes\n1 4 1 4\n2 3 1 "
                                   "4\n1\n2\n3\n4\n0 0 0 0 0\n1 0 0 1 0\n1 1 0 1 1\n0 1 0 0 1\n"
                                   "$EndNodes\n$Elements\n1 2 1 2\n2 3 2 2\n1 1 2 3\n2 1 3 4\n$EndElements\n";

/// Version 2.2: three nodes and a triangle.
std::string binary_msh() {
    std::string text = "$MeshFormat\n2.2 1 8\n";
    const auto add = [&text](auto value) {
        text.append(reinterpret_cast<const char*>(&value), sizeof value);
    };
    add(std::int32_t{1});
    text += "\n$EndMeshFormat\n$Nodes\n3\n";
    for (const std::int32_t number : {1, 2, 3}) {
        add(number);
        add(number == 2 ? 1.0 : 0.0);
        add(number == 3 ? 1.0 : 0.0);
        add(0.0);
    }
    text += "\n$EndNodes\n$Elements\n1\n";
    for (const std::int32_t value : {2, 1, 2, 1, 7, 7, 1, 2, 3}) {
        add(value);
    }
    return text + "\n$EndElements\n";
}

constexpr std::string_view vtk =
    "# vtk DataFile Version 3.0\na sheet\nASCII\nDATASET POLYDATA\nPOINTS 4 float\n0 0 0 1 0 0 1 1 0 0 1 "
    "0\nPOLYGONS 1 5\n"
    "4 0 1 2 3\nTRIANGLE_STRIPS 1 5\n4 0 1 3 2\nCELL_DATA 2\nSCALARS group int 1\nLOOKUP_TABLE default\n1 2\n"
    "FIELD more 1\nx 1 2 float\n0 1\n";

constexpr std::string_view vtu =
    "<VTKFile type=\"UnstructuredGrid\" byte_order=\"LittleEndian\"><UnstructuredGrid><Piece><Points>"
    "<DataArray type=\"Float32\" NumberOfComponents=\"3\" format=\"ascii\">0 0 0 1 0 0 1 1 0 0 1 "
    "0</DataArray></Points><Cells>"
    "<DataArray type=\"Int32\" Name=\"connectivity\" "
    "format=\"binary\">EAAAAAAAAAABAAAAAgAAAAMAAAA=</DataArray>"
    "<DataArray type=\"Int32\" Name=\"offsets\" format=\"ascii\">4</DataArray>"
    "<DataArray type=\"UInt8\" Name=\"types\" "
    "format=\"ascii\">9</DataArray></Cells></Piece></UnstructuredGrid></VTKFile>";

constexpr std::string_view inp =
    "*HEADING\n a plate\n*PART, NAME=plate\n*NODE\n1, 0, 0, 0\n2, 1, 0\n3, 1, 1\n4, 0, 1\n*ELEMENT, "
    "TYPE=S4R, ELSET=floor\n"
    "1, 1, 2, 3, 4\n*ELEMENT, TYPE=S3\n2, 1, 2, 3\n*ELSET, ELSET=all, GENERATE\n1, 2, 1\n*SURFACE, "
    "NAME=up\nall, SNEG\n"
    "*END PART\n*ASSEMBLY, NAME=a\n*INSTANCE, NAME=p, PART=plate\n0, 0, 1\n0, 0, 0, 0, 0, 1, 90\n*END "
    "INSTANCE\n"
    "*ELSET, ELSET=one, INSTANCE=p\n1\n*SURFACE, NAME=down\none, SPOS\n*END ASSEMBLY\n";

constexpr std::string_view bdf =
    "SOL 101\nBEGIN BULK\n$ a comment\nGRID    1               0.      0.      0.\n"
    "GRID*   2                               1.5             0.\n*       1.5-3\n"
    "GRID,3,0,1.,1.,0.\nGRID,4,,0.,1.+0,0.0D0\n"
    "CQUAD4  1       7       1       2       3       4\n"
    "CTRIA6,2,8,1,2,3,,+A\n+A,,,4\nCTETRA         3       1       1       2       3       4\nENDDATA\n";

constexpr std::string_view epjson = R"({"GlobalGeometryRules": {"1": {"vertex_entry_direction": "Clockwise",
"coordinate_system": "Relative"}}, "Zone": {"Z": {"x_origin": 1, "direction_of_relative_north": 30}},
"BuildingSurface:Detailed": {"wall": {"zone_name": "z", "vertices": [
{"vertex_x_coordinate": 0, "vertex_y_coordinate": 0, "vertex_z_coordinate": 0},
{"vertex_x_coordinate": 3, "vertex_y_coordinate": 0, "vertex_z_coordinate": 0},
{"vertex_x_coordinate": 3, "vertex_y_coordinate": 0, "vertex_z_coordinate": 2},
{"vertex_x_coordinate": 0, "vertex_y_coordinate": 0, "vertex_z_coordinate": 2}]}},
"FenestrationSurface:Detailed": {"pane": {"building_surface_name": "wall", "multiplier": 2,
"vertex_1_x_coordinate": 1, "vertex_1_y_coordinate": 0, "vertex_1_z_coordinate": 1,
"vertex_2_x_coordinate": 2, "vertex_2_y_coordinate": 0, "vertex_2_z_coordinate": 1,
"vertex_3_x_coordinate": 2, "vertex_3_y_coordinate": 0.001, "vertex_3_z_coordinate": 1.5}},
"InternalMass": {"m": {"zone_name": "Z"}}, "Roof": {"r": {"zone_name": "other"}}})";

/// One triangle, 134 bytes.
std::string binary_stl() {
    std::string text(80, ' ');
    text += std::string("\1\0\0\0", 4);
    const float numbers[12] = {0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 0};
    text.append(reinterpret_cast<const char*>(numbers), sizeof numbers);
    return text + std::string(2, '\0');
}

void seed_view3d(const fs::path& folder, const char* name, io::View3dFormat format) {
    FormFactors file;
    file.matrix = small_matrix(false);
    file.areas = {1.0, 0.5};
    file.groups = {"floor", "ceiling"};
    file.group_of = {0, 1};
    io::write_view3d(folder / name, file, format);
}

constexpr std::string_view mtl = "newmtl white\nKd 0.5 0.5 0.5\nKe 1 2 3\n# end\nnewmtl dark\nKd 0\n";

/// Companions of the file that is fuzzed: what it may name.
void write_companions(const fs::path& folder) {
    std::string square(60, '\0');
    const float corners[12] = {0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0};
    const std::uint16_t indices[6] = {0, 1, 2, 0, 2, 3};
    std::memcpy(square.data(), corners, sizeof corners);
    std::memcpy(square.data() + 48, indices, sizeof indices);
    write(folder / "square.bin", square);
    write(folder / "white.mtl", mtl);
    const std::string faces = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nusemtl white\nf 1 2 3 4\n";
    write(folder / "square.obj", "mtllib white.mtl\n" + faces);
    write(folder / "fuzzed.obj", "mtllib fuzzed.mtl\n" + faces);
}

const std::map<std::string, Reader> readers{
    {"json",
     {"fuzzed.json", read_as_scene,
      [](const fs::path& folder) {
          write(folder / "mesh.json", R"({"hemi":1,"materials":{"w":{"reflectance":0.5}},"surfaces":[
{"mesh":"square.obj","material":"w","transform":{"scale":2,"rotate":[0,90,0],"translate":[1,2,3]}}]})");
          write(folder / "holes.json",
                R"({"hemi":1,"materials":{"w":{"reflectance":0.5}},"surfaces":[{"material":"w",
"polygon":[[0,0,0],[4,0,0],[4,4,0],[3,1,0],[0,4,0]],"holes":[[[1,0,0],[2,0,0],[2,1,0]]],"flip":true}]})");
      }}},
    {"obj",
     {"fuzzed.obj", read_as_scene,
      [](const fs::path& folder) {
          write(folder / "material.obj",
                "mtllib white.mtl\no a b\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv .5 2 0\nv 0 1 0\nusemtl white\n"
                "f 1/1 2//2 \\\n3/3/3 4 5\ng\nf -1 -2 -3\n");
      }}},
    {"mtl",
     {"fuzzed.mtl", [](const fs::path& path) { read_as_scene(path.parent_path() / "fuzzed.obj"); },
      [](const fs::path& folder) { write(folder / "a.mtl", mtl); }}},
    {"gltf", {"fuzzed.gltf", read_as_scene, [](const fs::path& folder) { write(folder / "a.gltf", gltf); }}},
    {"glb", {"fuzzed.glb", read_as_scene, seed_glb}},
    {"vs3", {"fuzzed.vs3", read_as_scene, [](const fs::path& folder) { write(folder / "a.vs3", vs3); }}},
    {"ply", {"fuzzed.ply", read_as_scene, [](const fs::path& folder) { write(folder / "a.ply", ply); }}},
    {"stl",
     {"fuzzed.stl", read_as_scene,
      [](const fs::path& folder) {
          write(folder / "a.stl", stl);
          write(folder / "b.stl", binary_stl());
      }}},
    {"msh",
     {"fuzzed.msh", read_as_scene,
      [](const fs::path& folder) {
          write(folder / "a.msh", msh);
          write(folder / "b.msh", msh_4);
          write(folder / "c.msh", binary_msh());
      }}},
    {"vtk", {"fuzzed.vtk", read_as_scene, [](const fs::path& folder) { write(folder / "a.vtk", vtk); }}},
    {"vtk-xml", {"fuzzed.vtu", read_as_scene, [](const fs::path& folder) { write(folder / "a.vtu", vtu); }}},
    {"inp", {"fuzzed.inp", read_as_scene, [](const fs::path& folder) { write(folder / "a.inp", inp); }}},
    {"bdf", {"fuzzed.bdf", read_as_scene, [](const fs::path& folder) { write(folder / "a.bdf", bdf); }}},
    {"epjson",
     {"fuzzed.epJSON",
      [](const fs::path& path) {
          try {
              read_as_scene(path);
          } catch (const InvalidArgument&) { // no zone, or several
          }
      },
      [](const fs::path& folder) { write(folder / "a.epJSON", epjson); }}},
    {"view3d-text",
     {"fuzzed.txt", [](const fs::path& path) { (void)io::read_view3d(path, io::View3dFormat::text); },
      [](const fs::path& folder) { seed_view3d(folder, "a.txt", io::View3dFormat::text); }}},
    {"view3d-binary",
     {"fuzzed.vf", [](const fs::path& path) { (void)io::read_view3d(path, io::View3dFormat::binary); },
      [](const fs::path& folder) { seed_view3d(folder, "a.vf", io::View3dFormat::binary); }}},
    {"elmer-text",
     {"fuzzed.dat", [](const fs::path& path) { (void)io::read_elmer(path, io::ElmerFormat::text); },
      [](const fs::path& folder) {
          io::write_elmer(folder / "a.dat", small_matrix(false), io::ElmerFormat::text);
      }}},
    {"elmer-binary",
     {"fuzzed.dat", [](const fs::path& path) { (void)io::read_elmer(path, io::ElmerFormat::binary); },
      [](const fs::path& folder) {
          io::write_elmer(folder / "a.dat", small_matrix(false), io::ElmerFormat::binary);
      }}},
    {"hff", {"fuzzed.hff", [](const fs::path& path) { (void)io::read_hff(path); }, seed_hff, true}},
    {"part", {"fuzzed.hff", [](const fs::path& path) { (void)io::read_factor_part(path); }, seed_part, true}},
    {"hres", {"fuzzed.hres", [](const fs::path& path) { (void)io::read_hres(path); }, seed_hres, true}},
    {"rows",
     {"fuzzed.rows",
      [](const fs::path& path) {
          io::CheckpointFile checkpoint(path.parent_path() / "fuzzed", true);
          checkpoint.start({{"seed", "0"}}, FormFactorMatrix(2),
                           [](std::uint32_t, const RowView& row, bool) { (void)row.sum(); });
      },
      seed_rows, true}},
    {"clustered-rows",
     {"fuzzed.rows",
      [](const fs::path& path) {
          io::CheckpointFile checkpoint(path.parent_path() / "fuzzed", true);
          checkpoint.start({{"seed", "0"}}, FormFactorMatrix(2, small_clusters()),
                           [](std::uint32_t, const RowView& row, bool) { (void)row.sum(); });
      },
      seed_clustered_rows, true}},
    {"mtx",
     {"fuzzed.mtx", [](const fs::path& path) { (void)io::read_mtx(path); },
      [](const fs::path& folder) { io::write_mtx(folder / "a.mtx", small_matrix(false)); }}},
    {"csv",
     {"fuzzed.csv", [](const fs::path& path) { (void)io::read_csv(path); },
      [](const fs::path& folder) { io::write_csv(folder / "a.csv", small_matrix(false)); }}},
    {"table",
     {"fuzzed.csv", [](const fs::path& path) { (void)io::read_table(path); },
      [](const fs::path& folder) {
          io::write_table(folder / "a.csv", {{"time", "a, b"}, {{"0", "300"}, {"1", "\"20\" C"}}, {}});
      }}},
    {"npz",
     {"fuzzed.npz", [](const fs::path& path) { (void)io::read_npz(path); },
      [](const fs::path& folder) { io::write_npz(folder / "a.npz", small_matrix(false)); }}},
};

/// Makes the checksums of a chunk file right, so that what is behind them is reached.
void seal(std::string& bytes) {
    for (std::size_t start = 16; start + 16 <= bytes.size();) {
        std::uint64_t length = 0;
        std::memcpy(&length, bytes.data() + start + 8, 8);
        if (length > bytes.size() - start - 16) {
            return;
        }
        const auto* data = reinterpret_cast<const unsigned char*>(bytes.data()) + start;
        const auto crc =
            static_cast<std::uint32_t>(crc32_z(crc32_z(crc32_z(0, data, 4), data + 8, 8), data + 16, length));
        std::memcpy(bytes.data() + start + 4, &crc, 4);
        start += 16 + (length + 7) / 8 * 8;
    }
}

const Reader* chosen = nullptr;
fs::path workplace;

} // namespace

// libFuzzer has no header of its own.
extern "C" int LLVMFuzzerInitialize(int* argc, char*** argv);
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size);

extern "C" int LLVMFuzzerInitialize(int* argc, char*** argv) {
    for (int k = 1; k < *argc; ++k) {
        const std::string_view word = (*argv)[k];
        if (word == "--list") {
            for (const auto& [name, reader] : readers) {
                std::puts(name.c_str());
            }
            std::exit(0);
        }
        if (word.starts_with("--seeds=")) {
            for (const auto& [name, reader] : readers) {
                const fs::path folder = fs::path(word.substr(8)) / name;
                fs::create_directories(folder);
                reader.seed(folder);
            }
            std::exit(0);
        }
        if (word.starts_with("--reader=")) {
            const auto found = readers.find(std::string(word.substr(9)));
            chosen = found == readers.end() ? nullptr : &found->second;
        }
    }
    if (chosen == nullptr) {
        std::fputs("hemi_fuzz: --reader=NAME is missing, or there is no such reader (--list)\n", stderr);
        std::exit(2);
    }
    std::string name = (fs::temp_directory_path() / "hemi-fuzz-XXXXXX").string();
    if (mkdtemp(name.data()) == nullptr) {
        std::abort();
    }
    workplace = name;
    write_companions(workplace);
    std::atexit([] {
        std::error_code ignored;
        fs::remove_all(workplace, ignored);
    });
    return 0;
}

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    std::string bytes(reinterpret_cast<const char*>(data), size);
    if (chosen->has_checksums) {
        seal(bytes);
    }
    const fs::path path = workplace / chosen->file;
    std::FILE* file = std::fopen(path.c_str(), "wb");
    if (file == nullptr || std::fwrite(bytes.data(), 1, size, file) != size || std::fclose(file) != 0) {
        std::abort();
    }
    try {
        chosen->read(path);
    } catch (const InputError&) { // anything else is a bug
    } catch (const IoError&) {    // a journal that is none
        if (chosen->file != "fuzzed.rows") {
            throw;
        }
    }
    return 0;
}
