#include "hemi/core/error.hpp"
#include "io/formats/base64.hpp"
#include "io/formats/binary_scan.hpp"
#include "io/formats/text_scan.hpp"
#include "io/meshes/vtk_cells.hpp"

#include <fmt/format.h>
#include <pugixml.hpp>
#include <zlib.h>

#include <algorithm>
#include <cmath>
#include <string>

namespace hemi::io {

namespace {

constexpr int most_cells = 1 << 30;

class VtkXmlReader {
public:
    VtkXmlReader(const std::filesystem::path& path, std::string_view bytes, const SceneReaderOptions& options,
                 Diagnostics& diagnostics)
        : file_(path.string()), bytes_(bytes), diagnostics_(diagnostics), faces_(path, options) {}

    FaceMesh read() {
        load_document();
        const pugi::xml_node root = document_.child("VTKFile");
        if (!root) {
            fail("no element VTKFile; this is no VTK file");
        }
        const std::string type = root.attribute("type").value();
        if (type != "PolyData" && type != "UnstructuredGrid") {
            fail(fmt::format("type {}; must be PolyData or UnstructuredGrid", in_quotes(type)));
        }
        order_ = std::string_view(root.attribute("byte_order").value()) == "BigEndian" ? std::endian::big
                                                                                       : std::endian::little;
        wide_ = std::string_view(root.attribute("header_type").value()) == "UInt64";
        const std::string compressor = root.attribute("compressor").value();
        compressed_ = !compressor.empty();
        if (compressed_ && compressor != "vtkZLibDataCompressor") {
            fail(fmt::format("compressor {}; must be vtkZLibDataCompressor, or none", in_quotes(compressor)));
        }
        for (const pugi::xml_node piece : root.child(type.c_str()).children("Piece")) {
            faces_.add(read_piece(piece, type == "PolyData"));
        }
        return faces_.finish(diagnostics_);
    }

private:
    /// The document without raw data at its end, which is no XML.
    void load_document() {
        std::string text(bytes_);
        const std::size_t tag = bytes_.find("<AppendedData");
        if (tag != std::string_view::npos) {
            const std::size_t end = bytes_.find('>', tag);
            const std::size_t begin = bytes_.find('_', std::min(end, bytes_.size()));
            if (end == std::string_view::npos || begin == std::string_view::npos) {
                fail("AppendedData without data; they begin with _");
            }
            appended_ = bytes_.substr(begin + 1);
            appended_base64_ = bytes_.substr(tag, end - tag).find("base64") != std::string_view::npos;
            text = std::string(bytes_.substr(0, tag)) + "</VTKFile>";
        }
        const pugi::xml_parse_result parsed = document_.load_buffer(text.data(), text.size());
        if (!parsed) {
            const auto before =
                bytes_.substr(0, static_cast<std::size_t>(std::max<std::ptrdiff_t>(parsed.offset, 0)));
            throw ParseError(file_,
                             static_cast<std::size_t>(std::count(before.begin(), before.end(), '\n')) + 1, 0,
                             "no sound XML: it is broken off or damaged here");
        }
    }

    VtkCells read_piece(const pugi::xml_node& piece, bool polygons) {
        VtkCells cells;
        const std::vector<double> points = values(piece.child("Points").child("DataArray"), "Points");
        if (points.size() % 3 != 0) {
            fail(fmt::format("{} coordinates of points; must be three each", points.size()));
        }
        for (std::size_t k = 0; k < points.size(); k += 3) {
            cells.points.emplace_back(points[k], points[k + 1], points[k + 2]);
        }
        if (polygons) { // in the order in which VTK counts them
            read_cells(piece.child("Verts"), cells, 1);
            read_cells(piece.child("Lines"), cells, 3);
            read_cells(piece.child("Polys"), cells, 7);
            read_cells(piece.child("Strips"), cells, 6);
        } else {
            read_cells(piece.child("Cells"), cells, 0);
        }
        read_groups(piece.child("CellData"), cells);
        return cells;
    }

    /// @param type  of all of them; 0: each has its own
    void read_cells(const pugi::xml_node& node, VtkCells& cells, int type) const {
        if (!node) {
            return;
        }
        const auto before = static_cast<std::int64_t>(cells.nodes.size());
        const std::vector<double> nodes = values(array(node, "connectivity"), "connectivity");
        const std::vector<double> ends = values(array(node, "offsets"), "offsets");
        for (const double value : nodes) {
            cells.nodes.push_back(whole(value, "connectivity"));
        }
        for (const double value : ends) {
            cells.ends.push_back(before + whole(value, "offsets"));
        }
        if (type != 0) {
            cells.types.resize(cells.ends.size(), type);
            return;
        }
        for (const double value : values(array(node, "types"), "types")) {
            cells.types.push_back(static_cast<int>(whole(value, "types") % most_cells));
        }
    }

    void read_groups(const pugi::xml_node& node, VtkCells& cells) const {
        pugi::xml_node chosen;
        int best = 0;
        for (const pugi::xml_node candidate : node.children("DataArray")) {
            const int rank = vtk_group_rank(candidate.attribute("Name").value());
            const bool single = candidate.attribute("NumberOfComponents").as_int(1) == 1;
            if (rank > 0 && single && (best == 0 || rank < best)) {
                best = rank;
                chosen = candidate;
            }
        }
        if (!chosen) {
            return;
        }
        cells.group_array = to_utf8(chosen.attribute("Name").value());
        cells.groups = values(chosen, cells.group_array);
    }

    [[nodiscard]] static pugi::xml_node array(const pugi::xml_node& node, const char* name) {
        return node.find_child_by_attribute("DataArray", "Name", name);
    }

    std::int64_t whole(double value, const char* what) const {
        if (!(std::abs(value) < 9e15) || value != std::floor(value)) {
            fail(fmt::format("{} {}; must be a whole number", what, value));
        }
        return static_cast<std::int64_t>(value);
    }

    /// The numbers of an array, which doubles hold: indices above 2^53 name no point.
    std::vector<double> values(const pugi::xml_node& node, const std::string& name) const {
        if (!node) {
            fail(fmt::format("no DataArray of {}", name));
        }
        const std::string format = node.attribute("format").value();
        const std::string type = node.attribute("type").value();
        if (format == "ascii" || format.empty()) {
            return text_values(node.text().get(), name);
        }
        std::string bytes;
        if (format == "appended") {
            const std::uint64_t offset = node.attribute("offset").as_ullong();
            if (offset >= appended_.size()) {
                fail(fmt::format("{} at byte {} of {} appended bytes", name, offset, appended_.size()));
            }
            bytes = decoded(appended_.substr(offset), appended_base64_, name);
        } else if (format == "binary") {
            std::string_view text = node.text().get();
            const std::size_t begin = std::min(text.find_first_not_of(" \t\r\n"), text.size());
            bytes = decoded(text.substr(begin), true, name);
        } else {
            fail(fmt::format("{} of format {}; must be ascii, binary or appended", name, in_quotes(format)));
        }
        if (type == "Float64") {
            return numbers<double>(bytes);
        }
        if (type == "Float32") {
            return numbers<float>(bytes);
        }
        if (type == "Int64") {
            return numbers<std::int64_t>(bytes);
        }
        if (type == "UInt64") {
            return numbers<std::uint64_t>(bytes);
        }
        if (type == "Int32") {
            return numbers<std::int32_t>(bytes);
        }
        if (type == "UInt32") {
            return numbers<std::uint32_t>(bytes);
        }
        if (type == "Int16") {
            return numbers<std::int16_t>(bytes);
        }
        if (type == "UInt16") {
            return numbers<std::uint16_t>(bytes);
        }
        if (type == "Int8") {
            return numbers<std::int8_t>(bytes);
        }
        if (type == "UInt8") {
            return numbers<std::uint8_t>(bytes);
        }
        fail(fmt::format("{} of type {}; must be Float32, Float64, or Int or UInt of 8 to 64 bits", name,
                         in_quotes(type)));
    }

    std::vector<double> text_values(std::string_view text, const std::string& name) const {
        std::vector<double> result;
        Lines lines(text);
        std::string_view line;
        while (lines.next(line)) {
            for (std::string_view word = next_word(line); !word.empty(); word = next_word(line)) {
                const auto value = parse_number(word);
                if (!value) {
                    fail(fmt::format("{}: {}; must be a finite number", name, in_quotes(word)));
                }
                result.push_back(*value);
            }
        }
        return result;
    }

    template <class Number>
    std::vector<double> numbers(const std::string& bytes) const {
        std::vector<double> result;
        result.reserve(bytes.size() / sizeof(Number));
        for (std::size_t at = 0; at + sizeof(Number) <= bytes.size(); at += sizeof(Number)) {
            result.push_back(static_cast<double>(load<Number>(bytes.data() + at, order_)));
        }
        return result;
    }

    /// Bytes from an encoded stream: as many as asked for, from its start.
    std::string take(std::string_view source, bool base64, std::uint64_t count,
                     const std::string& name) const {
        const std::uint64_t encoded = base64 ? (count + 2) / 3 * 4 : count;
        if (count > source.size() || encoded > source.size()) {
            fail(fmt::format("{}: cut short: {} bytes are left, {} needed", name, source.size(), encoded));
        }
        if (!base64) {
            return std::string(source.substr(0, count));
        }
        auto bytes = decode_base64(source.substr(0, encoded));
        if (!bytes || bytes->size() < count) {
            fail(fmt::format("{}: no base64 text", name));
        }
        bytes->resize(count);
        return std::move(*bytes);
    }

    [[nodiscard]] std::uint64_t header(const std::string& bytes, std::size_t index) const {
        const char* const at = bytes.data() + index * header_bytes();
        return wide_ ? load<std::uint64_t>(at, order_) : load<std::uint32_t>(at, order_);
    }
    [[nodiscard]] std::size_t header_bytes() const { return wide_ ? 8 : 4; }

    std::string decoded(std::string_view source, bool base64, const std::string& name) const {
        if (!compressed_) {
            const std::uint64_t size = header(take(source, base64, header_bytes(), name), 0);
            if (size > source.size()) {
                fail(fmt::format("{}: cut short: {} bytes in {}", name, size, source.size()));
            }
            return take(source, base64, header_bytes() + size, name).substr(header_bytes());
        }
        const std::uint64_t blocks = header(take(source, base64, header_bytes(), name), 0);
        if (blocks > source.size()) {
            fail(fmt::format("{}: {} compressed blocks in {} bytes", name, blocks, source.size()));
        }
        const std::size_t head_size = (3 + blocks) * header_bytes();
        const std::string head = take(source, base64, head_size, name);
        std::string_view rest = source.substr(base64 ? (head_size + 2) / 3 * 4 : head_size);
        std::uint64_t total = 0;
        for (std::uint64_t b = 0; b < blocks; ++b) {
            total += std::min<std::uint64_t>(header(head, 3 + b), source.size());
        }
        const std::string packed = take(rest, base64, total, name);
        std::string result;
        std::size_t at = 0;
        for (std::uint64_t b = 0; b < blocks; ++b) {
            const std::uint64_t last = header(head, 2);
            const std::uint64_t size = b + 1 == blocks && last != 0 ? last : header(head, 1);
            const std::uint64_t length = header(head, 3 + b);
            // zlib packs by a thousand at most.
            if (length > packed.size() - at || size / 1100 > length) {
                fail(fmt::format("{}: a block of {} bytes packed in {}", name, size, length));
            }
            const std::size_t before = result.size();
            result.resize(before + size);
            uLongf unpacked = size;
            const int status = uncompress(reinterpret_cast<Bytef*>(result.data() + before), &unpacked,
                                          reinterpret_cast<const Bytef*>(packed.data() + at), length);
            if (status != Z_OK || unpacked != size) {
                fail(fmt::format("{}: a compressed block is damaged", name));
            }
            at += length;
        }
        return result;
    }

    [[noreturn]] void fail(const std::string& message) const {
        throw InputError(fmt::format("{}: {}", file_, message));
    }

    std::string file_;
    std::string_view bytes_;
    Diagnostics& diagnostics_;
    VtkFaces faces_;
    pugi::xml_document document_;
    std::string_view appended_; ///< from behind its _
    bool appended_base64_ = false;
    std::endian order_ = std::endian::little;
    bool wide_ = false; ///< sizes are 64 bits
    bool compressed_ = false;
};

} // namespace

FaceMesh read_vtk_xml(const std::filesystem::path& path, std::string_view bytes,
                      const SceneReaderOptions& options, Diagnostics& diagnostics) {
    return VtkXmlReader(path, bytes, options, diagnostics).read();
}

} // namespace hemi::io
