#include "benchmark/files.hpp"

#include "benchmark/timing.hpp"
#include "hemi/core/error.hpp"
#include "hemi/io/factor_file.hpp"
#include "hemi/io/output_file.hpp"
#include "hemi/io/scene_reader.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <functional>
#include <string>
#include <utility>
#include <vector>

namespace hemi::bench {

namespace {

namespace fs = std::filesystem;

class TemporaryFolder {
public:
    TemporaryFolder() {
        std::string name = (fs::temp_directory_path() / "hemi-bench-XXXXXX").string();
        if (mkdtemp(name.data()) == nullptr) {
            throw IoError(name + ": cannot be made");
        }
        path_ = name;
    }
    ~TemporaryFolder() {
        std::error_code ignored;
        fs::remove_all(path_, ignored);
    }
    TemporaryFolder(const TemporaryFolder&) = delete;
    TemporaryFolder& operator=(const TemporaryFolder&) = delete;

    fs::path operator/(const std::string& name) const { return path_ / name; }

private:
    fs::path path_;
};

/// N patches that each see every second one.
FormFactors half_full(std::uint32_t size) {
    FormFactors file;
    file.matrix = FormFactorMatrix(size);
    file.areas.assign(size, 1.0);
    file.groups = {"even", "odd"};
    std::uint32_t random = 1;
    for (std::uint32_t first = 0; first < size; first += FormFactorMatrix::block_rows) {
        RowBlock block;
        block.first_row = first;
        block.begin = {0};
        for (std::uint32_t i = first; i < std::min(size, first + FormFactorMatrix::block_rows); ++i) {
            for (std::uint32_t j = i % 2; j < size; j += 2) {
                random = random * 1664525u + 1013904223u;
                block.columns.push_back(j);
                block.values.push_back(static_cast<float>(random >> 8) * 0x1p-24f / static_cast<float>(size));
            }
            block.begin.push_back(block.columns.size());
            block.environment.push_back(0.0);
            block.blocked.push_back(0.0);
            block.known.push_back(1);
            file.group_of.push_back(i % 2);
        }
        file.matrix.set_block(std::move(block));
    }
    return file;
}

struct Writer {
    const char* extension;
    std::function<void(const fs::path&, const FormFactors&)> write;
};

std::vector<Writer> writers() {
    return {
        {".hff", [](const fs::path& path, const FormFactors& file) { io::write_hff(path, file); }},
        {".npz", [](const fs::path& path, const FormFactors& file) { io::write_npz(path, file.matrix); }},
        {".npy", [](const fs::path& path, const FormFactors& file) { io::write_npy(path, file.matrix); }},
        {".h5", [](const fs::path& path, const FormFactors& file) { io::write_h5(path, file); }},
        {".mtx", [](const fs::path& path, const FormFactors& file) { io::write_mtx(path, file.matrix); }},
        {".csv", [](const fs::path& path, const FormFactors& file) { io::write_csv(path, file.matrix); }},
        {".dat", [](const fs::path& path,
                    const FormFactors& file) { io::write_elmer(path, file.matrix, io::ElmerFormat::text); }},
        {".bin",
         [](const fs::path& path, const FormFactors& file) {
             io::write_elmer(path, file.matrix, io::ElmerFormat::binary);
         }},
        {".txt", [](const fs::path& path,
                    const FormFactors& file) { io::write_view3d(path, file, io::View3dFormat::text); }},
        {".vf", [](const fs::path& path,
                   const FormFactors& file) { io::write_view3d(path, file, io::View3dFormat::binary); }},
        {".idf",
         [](const fs::path& path, const FormFactors& file) {
             Diagnostics unused;
             io::write_energyplus(path, file, unused);
         }},
    };
}

double seconds_of(const std::function<void()>& work) {
    const auto start = std::chrono::steady_clock::now();
    work();
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

void measure_writers(Report& report, const TemporaryFolder& folder, unsigned rounds) {
    const FormFactors small = half_full(1000);
    const FormFactors large = half_full(4000);
    const auto entries = static_cast<double>(large.matrix.entries());
    const double times = entries / static_cast<double>(small.matrix.entries());
    for (const Writer& writer : writers()) {
        const fs::path path = folder / ("factors" + std::string(writer.extension));
        const std::array<Subject, 2> subjects{
            [&] { return seconds_of([&] { writer.write(path, small); }); },
            [&] { return seconds_of([&] { writer.write(path, large); }); },
        };
        const std::vector<Series> series = time_interleaved(subjects, rounds);
        report.finding({fmt::format("writing {}", writer.extension), entries / median(series[1]) / 1e6, "M/s",
                        Bound::none, 0.0});
        report.finding(
            {fmt::format("writing {}: seconds an entry, {:.0f} times the entries", writer.extension, times),
             median_ratio(series[1], series[0]) / times, "times", Bound::at_most, 1.5});
    }
}

/// A square of waves: 2 n² triangles on (n + 1)² vertices.
class Waves {
public:
    explicit Waves(std::uint32_t n) : n_(n) {}

    [[nodiscard]] std::uint32_t vertices() const { return (n_ + 1) * (n_ + 1); }
    [[nodiscard]] std::uint32_t triangles() const { return 2 * n_ * n_; }

    [[nodiscard]] std::array<float, 3> vertex(std::uint32_t index) const {
        const std::uint32_t i = index % (n_ + 1);
        const std::uint32_t j = index / (n_ + 1);
        return {static_cast<float>(i), static_cast<float>(j),
                static_cast<float>((i * i + 3 * j) % 7) * 0.125f};
    }
    [[nodiscard]] std::array<std::uint32_t, 3> triangle(std::uint32_t index) const {
        const std::uint32_t first = index / 2 / n_ * (n_ + 1) + index / 2 % n_;
        return index % 2 == 0 ? std::array{first, first + 1, first + n_ + 1}
                              : std::array{first + 1, first + n_ + 2, first + n_ + 1};
    }

private:
    std::uint32_t n_;
};

template <class Number>
void append(std::string& bytes, Number number) {
    bytes.append(reinterpret_cast<const char*>(&number), sizeof number);
}

std::string obj_of(const Waves& waves) {
    std::string text;
    for (std::uint32_t v = 0; v < waves.vertices(); ++v) {
        const auto [x, y, z] = waves.vertex(v);
        text += fmt::format("v {} {} {}\n", x, y, z);
    }
    for (std::uint32_t t = 0; t < waves.triangles(); ++t) {
        const auto [a, b, c] = waves.triangle(t);
        text += fmt::format("f {} {} {}\n", a + 1, b + 1, c + 1);
    }
    return text;
}

std::string msh_of(const Waves& waves) {
    std::string text = fmt::format("$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n{}\n", waves.vertices());
    for (std::uint32_t v = 0; v < waves.vertices(); ++v) {
        const auto [x, y, z] = waves.vertex(v);
        text += fmt::format("{} {} {} {}\n", v + 1, x, y, z);
    }
    text += fmt::format("$EndNodes\n$Elements\n{}\n", waves.triangles());
    for (std::uint32_t t = 0; t < waves.triangles(); ++t) {
        const auto [a, b, c] = waves.triangle(t);
        text += fmt::format("{} 2 2 1 1 {} {} {}\n", t + 1, a + 1, b + 1, c + 1);
    }
    return text + "$EndElements\n";
}

/// Version 4.1, nodes and triangles in a block each.
std::string msh4_of(const Waves& waves) {
    const std::uint32_t nodes = waves.vertices();
    const std::uint32_t triangles = waves.triangles();
    std::string text =
        fmt::format("$MeshFormat\n4.1 0 8\n$EndMeshFormat\n$Nodes\n1 {0} 1 {0}\n2 1 0 {0}\n", nodes);
    for (std::uint32_t v = 0; v < nodes; ++v) {
        text += fmt::format("{}\n", v + 1);
    }
    for (std::uint32_t v = 0; v < nodes; ++v) {
        const auto [x, y, z] = waves.vertex(v);
        text += fmt::format("{} {} {}\n", x, y, z);
    }
    text += fmt::format("$EndNodes\n$Elements\n1 {0} 1 {0}\n2 1 2 {0}\n", triangles);
    for (std::uint32_t t = 0; t < triangles; ++t) {
        const auto [a, b, c] = waves.triangle(t);
        text += fmt::format("{} {} {} {}\n", t + 1, a + 1, b + 1, c + 1);
    }
    return text + "$EndElements\n";
}

std::string inp_of(const Waves& waves) {
    std::string text = "*NODE\n";
    for (std::uint32_t v = 0; v < waves.vertices(); ++v) {
        const auto [x, y, z] = waves.vertex(v);
        text += fmt::format("{}, {}, {}, {}\n", v + 1, x, y, z);
    }
    text += "*ELEMENT, TYPE=S3, ELSET=waves\n";
    for (std::uint32_t t = 0; t < waves.triangles(); ++t) {
        const auto [a, b, c] = waves.triangle(t);
        text += fmt::format("{}, {}, {}, {}\n", t + 1, a + 1, b + 1, c + 1);
    }
    return text;
}

std::string bdf_of(const Waves& waves) {
    std::string text = "BEGIN BULK\n";
    for (std::uint32_t v = 0; v < waves.vertices(); ++v) {
        const auto [x, y, z] = waves.vertex(v);
        text += fmt::format("GRID    {:>8}{:>8}{:>8.1f}{:>8.1f}{:>8.3f}\n", v + 1, "", x, y, z);
    }
    for (std::uint32_t t = 0; t < waves.triangles(); ++t) {
        const auto [a, b, c] = waves.triangle(t);
        text += fmt::format("CTRIA3  {:>8}{:>8}{:>8}{:>8}{:>8}\n", t + 1, 1, a + 1, b + 1, c + 1);
    }
    return text + "ENDDATA\n";
}

std::string vtu_of(const Waves& waves) {
    std::string text = fmt::format("<VTKFile type=\"UnstructuredGrid\"><UnstructuredGrid><Piece "
                                   "NumberOfPoints=\"{}\" NumberOfCells=\"{}\"><Points><DataArray "
                                   "type=\"Float32\" NumberOfComponents=\"3\" format=\"ascii\">\n",
                                   waves.vertices(), waves.triangles());
    for (std::uint32_t v = 0; v < waves.vertices(); ++v) {
        const auto [x, y, z] = waves.vertex(v);
        text += fmt::format("{} {} {}\n", x, y, z);
    }
    text += "</DataArray></Points><Cells><DataArray type=\"Int64\" Name=\"connectivity\" format=\"ascii\">\n";
    for (std::uint32_t t = 0; t < waves.triangles(); ++t) {
        const auto [a, b, c] = waves.triangle(t);
        text += fmt::format("{} {} {}\n", a, b, c);
    }
    text += "</DataArray><DataArray type=\"Int64\" Name=\"offsets\" format=\"ascii\">\n";
    for (std::uint32_t t = 0; t < waves.triangles(); ++t) {
        text += fmt::format("{}\n", 3 * (t + 1));
    }
    text += "</DataArray><DataArray type=\"UInt8\" Name=\"types\" format=\"ascii\">\n";
    for (std::uint32_t t = 0; t < waves.triangles(); ++t) {
        text += "5\n";
    }
    return text + "</DataArray></Cells></Piece></UnstructuredGrid></VTKFile>\n";
}

std::string ply_of(const Waves& waves) {
    std::string bytes =
        fmt::format("ply\nformat binary_little_endian 1.0\nelement vertex {}\nproperty float x\n"
                    "property float y\nproperty float z\nelement face {}\n"
                    "property list uchar uint vertex_indices\nend_header\n",
                    waves.vertices(), waves.triangles());
    for (std::uint32_t v = 0; v < waves.vertices(); ++v) {
        append(bytes, waves.vertex(v));
    }
    for (std::uint32_t t = 0; t < waves.triangles(); ++t) {
        bytes += '\3';
        append(bytes, waves.triangle(t));
    }
    return bytes;
}

std::string stl_of(const Waves& waves) {
    std::string bytes(80, ' ');
    append(bytes, waves.triangles());
    for (std::uint32_t t = 0; t < waves.triangles(); ++t) {
        append(bytes, std::array<float, 3>{});
        for (const std::uint32_t corner : waves.triangle(t)) {
            append(bytes, waves.vertex(corner));
        }
        bytes.append(2, '\0');
    }
    return bytes;
}

void measure_readers(Report& report, const TemporaryFolder& folder, unsigned rounds) {
    const Waves waves(708);
    struct Format {
        const char* extension;
        const char* version; ///< of formats that have several
        std::string (*make)(const Waves&);
    };
    const Format formats[] = {{".obj", "", obj_of},     {".ply", "", ply_of},      {".stl", "", stl_of},
                              {".msh", " 2.2", msh_of}, {".msh", " 4.1", msh4_of}, {".inp", "", inp_of},
                              {".bdf", "", bdf_of},     {".vtu", "", vtu_of}};
    for (const auto& [extension, version, make] : formats) {
        const fs::path path = folder / ("waves" + std::string(extension));
        io::OutputFile file(path);
        file.write(make(waves));
        file.commit();
        const std::array<Subject, 1> subject{[&path = path] {
            Diagnostics unused;
            return seconds_of([&] { (void)io::read_scene(path, {}, unused); });
        }};
        report.finding({fmt::format("reading {}{}, {} triangles", extension, version, waves.triangles()),
                        median(time_interleaved(subject, rounds)[0]), "s", Bound::at_most, 5.0});
    }
}

} // namespace

void measure_files(Report& report, unsigned rounds) {
    const TemporaryFolder folder;
    measure_writers(report, folder, rounds);
    measure_readers(report, folder, rounds);
}

} // namespace hemi::bench
