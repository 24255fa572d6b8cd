#include "hemi/io/vtp_file.hpp"

#include "hemi/core/error.hpp"
#include "io/formats/binary_output.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>

namespace hemi::io {

namespace {

std::string xml_text(const std::string& text) {
    std::string result;
    for (const char c : text) {
        switch (c) {
        case '&':
            result += "&amp;";
            break;
        case '<':
            result += "&lt;";
            break;
        case '>':
            result += "&gt;";
            break;
        case '"':
            result += "&quot;";
            break;
        default:
            result += static_cast<unsigned char>(c) < 0x20 ? '?' : c;
        }
    }
    return result;
}

/// The head of the file: where each array's bytes begin is counted as arrays are declared. Every array is
/// its size in bytes, 64 bits, and then its numbers.
class Head {
public:
    void open(const std::string& tag) { text_ += fmt::format("<{}>\n", tag); }
    void close(const std::string& tag) { text_ += fmt::format("</{}>\n", tag); }

    void array(const std::string& type, const std::string& name, std::size_t numbers,
               const std::vector<std::string>& components = {}, std::size_t count = 1) {
        text_ += fmt::format("<DataArray type=\"{}\" Name=\"{}\" NumberOfComponents=\"{}\"", type,
                             xml_text(name), components.empty() ? count : components.size());
        for (std::size_t c = 0; c < components.size(); ++c) {
            text_ += fmt::format(" ComponentName{}=\"{}\"", c, xml_text(components[c]));
        }
        text_ += fmt::format(" format=\"appended\" offset=\"{}\"/>\n", offset_);
        offset_ += sizeof(std::uint64_t) + numbers * sizeof(std::uint64_t);
    }

    /// Strings as the reader takes them: codes of their bytes, each string ended by 0.
    void names(const std::string& name, const std::vector<std::string>& strings) {
        text_ += fmt::format("<FieldData>\n<DataArray type=\"String\" Name=\"{}\" NumberOfTuples=\"{}\" "
                             "format=\"ascii\">\n",
                             name, strings.size());
        for (const std::string& string : strings) {
            for (const char c : string) {
                text_ += fmt::format("{} ", static_cast<unsigned>(static_cast<unsigned char>(c)));
            }
            text_ += "0\n";
        }
        text_ += "</DataArray>\n</FieldData>\n";
    }

    [[nodiscard]] const std::string& text() const { return text_; }

private:
    std::string text_;
    std::uint64_t offset_ = 0;
};

/// Begins an array of 64-bit numbers: its size goes before it.
void begin(BinaryOutput& body, std::uint64_t numbers) {
    body.put(numbers * sizeof(std::uint64_t));
}

void check(const CellArray& array, std::size_t count, const char* what) {
    const std::size_t components = std::max<std::size_t>(array.components.size(), 1);
    if (array.values.size() != count * components) {
        throw InvalidArgument(fmt::format("{}: {} values for {} {} of {} components", array.name,
                                          array.values.size(), count, what, components));
    }
    if (std::any_of(array.values.begin(), array.values.end(), [](double v) { return std::isinf(v); })) {
        throw InvalidArgument(fmt::format("{}: a value that is infinite", array.name));
    }
}

std::uint64_t count_points(const PatchMesh& mesh) {
    std::uint64_t points = 0;
    for (std::uint32_t s = 0; s < mesh.surfaces().size(); ++s) {
        points +=
            std::uint64_t{mesh.first_patch(s + 1) - mesh.first_patch(s)} * mesh.surfaces()[s].vertex_count;
    }
    return points;
}

} // namespace

void write_vtp(const std::filesystem::path& path, const PatchMesh& mesh, std::span<const CellArray> arrays) {
    for (const CellArray& array : arrays) {
        check(array, mesh.size(), "patches");
    }
    const std::uint64_t size = mesh.size();
    const std::uint64_t points = count_points(mesh);

    Head head;
    head.open("?xml version=\"1.0\"?");
    head.open("VTKFile type=\"PolyData\" version=\"1.0\" byte_order=\"LittleEndian\" header_type=\"UInt64\"");
    head.open("PolyData");
    head.names("groups", mesh.groups());
    head.open(fmt::format("Piece NumberOfPoints=\"{}\" NumberOfVerts=\"0\" NumberOfLines=\"0\" "
                          "NumberOfStrips=\"0\" NumberOfPolys=\"{}\"",
                          points, size));
    head.open("CellData");
    head.array("Int64", "patch", size);
    head.array("Int64", "group", size);
    head.array("Float64", "area", size);
    for (const CellArray& array : arrays) {
        head.array("Float64", array.name, array.values.size(), array.components);
    }
    head.close("CellData");
    head.open("Points");
    head.array("Float64", "Points", 3 * points, {}, 3);
    head.close("Points");
    head.open("Polys");
    head.array("Int64", "connectivity", points);
    head.array("Int64", "offsets", size);
    head.close("Polys");
    head.close("Piece");
    head.close("PolyData");

    BinaryOutput body(path);
    body.text(head.text() + "<AppendedData encoding=\"raw\">\n_");
    begin(body, size);
    for (std::uint64_t i = 0; i < size; ++i) {
        body.put(i);
    }
    begin(body, size);
    for (std::uint32_t i = 0; i < size; ++i) {
        body.put(std::uint64_t{mesh.group(i)});
    }
    begin(body, size);
    for (const double area : mesh.areas()) {
        body.put(area);
    }
    for (const CellArray& array : arrays) {
        begin(body, array.values.size());
        for (const double value : array.values) {
            body.put(value);
        }
    }
    begin(body, 3 * points);
    for (std::uint32_t i = 0; i < size; ++i) {
        const PatchCorners corners = mesh.corners(i);
        for (const Vec3& corner : corners.polygon()) {
            body.put(corner.x);
            body.put(corner.y);
            body.put(corner.z);
        }
    }
    begin(body, points);
    for (std::uint64_t p = 0; p < points; ++p) {
        body.put(p);
    }
    begin(body, size);
    std::uint64_t end = 0;
    for (std::uint32_t i = 0; i < size; ++i) {
        end += mesh.surfaces()[mesh.surface_of()[i]].vertex_count;
        body.put(end);
    }
    body.text("\n</AppendedData>\n</VTKFile>\n");
    body.commit();
}

void write_points_vtp(const std::filesystem::path& path, std::span<const Vec3> positions,
                      std::span<const Vec3> normals, std::span<const CellArray> arrays) {
    const std::uint64_t size = positions.size();
    if (!normals.empty() && normals.size() != size) {
        throw InvalidArgument(fmt::format("{} normals for {} points", normals.size(), size));
    }
    for (const CellArray& array : arrays) {
        check(array, size, "points");
    }
    Head head;
    head.open("?xml version=\"1.0\"?");
    head.open("VTKFile type=\"PolyData\" version=\"1.0\" byte_order=\"LittleEndian\" header_type=\"UInt64\"");
    head.open("PolyData");
    head.open(fmt::format("Piece NumberOfPoints=\"{0}\" NumberOfVerts=\"{0}\" NumberOfLines=\"0\" "
                          "NumberOfStrips=\"0\" NumberOfPolys=\"0\"",
                          size));
    head.open("PointData");
    if (!normals.empty()) {
        head.array("Float64", "normals", 3 * size, {}, 3);
    }
    for (const CellArray& array : arrays) {
        head.array("Float64", array.name, array.values.size(), array.components);
    }
    head.close("PointData");
    head.open("Points");
    head.array("Float64", "Points", 3 * size, {}, 3);
    head.close("Points");
    head.open("Verts");
    head.array("Int64", "connectivity", size);
    head.array("Int64", "offsets", size);
    head.close("Verts");
    head.close("Piece");
    head.close("PolyData");

    BinaryOutput body(path);
    body.text(head.text() + "<AppendedData encoding=\"raw\">\n_");
    const auto put_vectors = [&body](std::span<const Vec3> vectors) {
        begin(body, 3 * vectors.size());
        for (const Vec3& vector : vectors) {
            body.put(vector.x);
            body.put(vector.y);
            body.put(vector.z);
        }
    };
    if (!normals.empty()) {
        put_vectors(normals);
    }
    for (const CellArray& array : arrays) {
        begin(body, array.values.size());
        for (const double value : array.values) {
            body.put(value);
        }
    }
    put_vectors(positions);
    begin(body, size);
    for (std::uint64_t p = 0; p < size; ++p) {
        body.put(p);
    }
    begin(body, size);
    for (std::uint64_t p = 0; p < size; ++p) {
        body.put(p + 1);
    }
    body.text("\n</AppendedData>\n</VTKFile>\n");
    body.commit();
}

} // namespace hemi::io
