#include "hemi/core/error.hpp"
#include "io/formats/binary_scan.hpp"
#include "io/formats/text_scan.hpp"
#include "io/meshes/vtk_cells.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <map>
#include <utility>

namespace hemi::io {

namespace {

/// Bytes of a value of a type in a binary file; 0: not known.
std::size_t bytes_of(std::string_view type) {
    static const std::map<std::string_view, std::size_t> known{
        {"unsigned_char", 1},  {"char", 1},         {"vtktypeuint8", 1},  {"vtktypeint8", 1},
        {"unsigned_short", 2}, {"short", 2},        {"unsigned_int", 4},  {"int", 4},
        {"vtkIdType", 4},      {"vtktypeint32", 4}, {"vtktypeuint32", 4}, {"unsigned_long", 8},
        {"long", 8},           {"vtktypeint64", 8}, {"vtktypeuint64", 8}, {"float", 4},
        {"double", 8}};
    const auto found = known.find(type);
    return found == known.end() ? 0 : found->second;
}

class VtkLegacyReader {
public:
    VtkLegacyReader(const std::filesystem::path& path, std::string_view bytes,
                    const SceneReaderOptions& options, Diagnostics& diagnostics)
        : file_(path.string()), bytes_(bytes), diagnostics_(diagnostics), faces_(path, options) {}

    FaceMesh read() {
        (void)line(); // the version
        (void)line(); // the title
        const std::string_view kind = trim(line());
        binary_ = kind == "BINARY";
        if (!binary_ && kind != "ASCII") {
            fail(fmt::format("{}; must be ASCII or BINARY", in_quotes(kind)));
        }
        for (std::string_view word = next_word(); !word.empty(); word = next_word()) {
            read_section(word);
        }
        faces_.add(cells_);
        return faces_.finish(diagnostics_);
    }

private:
    void read_section(std::string_view word) {
        if (word == "DATASET") {
            const std::string_view type = next_word();
            if (type != "POLYDATA" && type != "UNSTRUCTURED_GRID") {
                fail(fmt::format("data set {}; must be POLYDATA or UNSTRUCTURED_GRID", in_quotes(type)));
            }
        } else if (word == "POINTS") {
            const std::uint64_t count = number("points");
            const std::vector<double> values = array(next_word(), count, 3);
            for (std::size_t k = 0; k < values.size(); k += 3) {
                cells_.points.emplace_back(values[k], values[k + 1], values[k + 2]);
            }
        } else if (word == "VERTICES") {
            read_cells(1);
        } else if (word == "LINES") {
            read_cells(3);
        } else if (word == "POLYGONS") {
            read_cells(7);
        } else if (word == "TRIANGLE_STRIPS") {
            read_cells(6);
        } else if (word == "CELLS") {
            read_cells(0);
        } else if (word == "CELL_TYPES") {
            for (const double type : array("int", number("cell types"), 1)) {
                cells_.types.push_back(static_cast<int>(index(type) % (1 << 30)));
            }
        } else if (word == "CELL_DATA" || word == "POINT_DATA") {
            of_cells_ = word == "CELL_DATA";
            tuples_ = number("tuples");
        } else if (word == "METADATA") {
            skip_metadata();
        } else {
            read_attribute(word);
        }
    }

    /// Counts and points of cells, or, since version 5, where each ends and the points.
    void read_cells(int type) {
        const std::uint64_t count = number("cells");
        const std::uint64_t size = number("size of cells");
        const std::size_t mark = at_;
        if (next_word() == "OFFSETS") {
            const auto before = static_cast<std::int64_t>(cells_.nodes.size());
            const std::vector<double> ends = array(next_word(), count, 1);
            if (next_word() != "CONNECTIVITY") {
                fail("no CONNECTIVITY after OFFSETS");
            }
            for (const double node : array(next_word(), size, 1)) {
                cells_.nodes.push_back(index(node));
            }
            for (std::size_t k = 1; k < ends.size(); ++k) {
                cells_.ends.push_back(before + index(ends[k]));
            }
        } else {
            at_ = mark;
            const std::vector<double> values = array("int", size, 1);
            std::size_t place = 0;
            for (std::uint64_t k = 0; k < count; ++k) {
                const double points = place < values.size() ? values[place] : -1.0;
                if (!(points >= 0.0) || points >= static_cast<double>(values.size() - place)) {
                    fail(fmt::format("cell {} of {} points; {} values are left", k, points,
                                     values.size() - place));
                }
                const auto end = place + 1 + static_cast<std::size_t>(points);
                for (++place; place < end; ++place) {
                    cells_.nodes.push_back(index(values[place]));
                }
                cells_.ends.push_back(static_cast<std::int64_t>(cells_.nodes.size()));
            }
        }
        if (type != 0) {
            cells_.types.resize(cells_.ends.size(), type);
        }
    }

    void read_attribute(std::string_view word) {
        const std::string kind(word);
        if (kind == "FIELD") {
            (void)next_word();
            const std::uint64_t arrays = number("arrays");
            for (std::uint64_t k = 0; k < arrays; ++k) {
                const std::string name(need_word());
                if (name == "METADATA") {
                    skip_metadata();
                    --k;
                    continue;
                }
                const std::uint64_t components = number("components");
                const std::uint64_t tuples = number("tuples");
                take(name, array(next_word(), tuples, components), components);
            }
            return;
        }
        const std::string name(need_word());
        if (kind == "SCALARS") {
            const std::string type(need_word());
            std::string_view rest = line();
            const std::string_view given = hemi::io::next_word(rest);
            const std::uint64_t components = given.empty() ? 1 : whole(given, "components");
            const std::size_t mark = at_;
            if (next_word() == "LOOKUP_TABLE") {
                (void)next_word();
            } else {
                at_ = mark;
            }
            take(name, array(type, tuples_, components), components);
        } else if (kind == "LOOKUP_TABLE") {
            (void)array(binary_ ? "unsigned_char" : "float", number("colours"), 4);
        } else if (kind == "COLOR_SCALARS") {
            (void)array(binary_ ? "unsigned_char" : "float", tuples_, number("values"));
        } else if (kind == "VECTORS" || kind == "NORMALS") {
            (void)array(next_word(), tuples_, 3);
        } else if (kind == "TENSORS") {
            (void)array(next_word(), tuples_, 9);
        } else if (kind == "TEXTURE_COORDINATES") {
            const std::uint64_t dimension = number("dimensions");
            (void)array(next_word(), tuples_, dimension);
        } else if (kind == "GLOBAL_IDS" || kind == "PEDIGREE_IDS") {
            (void)array(next_word(), tuples_, 1);
        } else {
            fail(fmt::format("{}; must be a section of a VTK file, such as POINTS or CELL_DATA",
                             in_quotes(kind)));
        }
    }

    /// Keeps the array that tells groups best.
    void take(const std::string& name, std::vector<double> values, std::uint64_t components) {
        const int rank = vtk_group_rank(name);
        if (of_cells_ && components == 1 && rank > 0 && (group_rank_ == 0 || rank < group_rank_) &&
            values.size() == cells_.ends.size()) {
            group_rank_ = rank;
            cells_.group_array = to_utf8(name);
            cells_.groups = std::move(values);
        }
    }

    std::vector<double> array(std::string_view type, std::uint64_t tuples, std::uint64_t components) {
        const std::size_t size = bytes_of(type);
        if (size == 0) {
            fail(fmt::format("values of type {}; must be int, float, double or the like", in_quotes(type)));
        }
        const std::uint64_t least = binary_ ? size : 1;
        if (components > 1000 || tuples > bytes_.size() ||
            tuples * components > (bytes_.size() - at_ + 1) / least) {
            fail(fmt::format("{} times {} values; the file has {} bytes", tuples, components, bytes_.size()));
        }
        std::vector<double> values;
        values.reserve(tuples * components);
        if (binary_) {
            end_line();
        }
        for (std::uint64_t k = 0; k < tuples * components; ++k) {
            values.push_back(binary_ ? binary_value(type, size) : text_value());
        }
        return values;
    }

    std::int64_t index(double value) const {
        if (!(std::abs(value) < 9e15) || value != std::floor(value)) {
            fail(fmt::format("{}; must be a whole number", value));
        }
        return static_cast<std::int64_t>(value);
    }

    double text_value() {
        const std::string_view word = need_word();
        if (const auto value = parse_number(word)) {
            return *value;
        }
        // Not a number, or infinite, which arrays that are not used may be.
        double value = 0.0;
        const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
        if (error != std::errc() || end != word.data() + word.size()) {
            fail(fmt::format("{}; must be a number", in_quotes(word)));
        }
        return value;
    }

    double binary_value(std::string_view type, std::size_t size) {
        if (bytes_.size() - at_ < size) {
            fail("cut short");
        }
        const char* const at = bytes_.data() + at_;
        at_ += size;
        constexpr auto order = std::endian::big;
        if (type == "float") {
            return static_cast<double>(load<float>(at, order));
        }
        if (type == "double") {
            return load<double>(at, order);
        }
        const bool is_signed =
            type.find("unsigned") == std::string_view::npos && type.find("uint") == std::string_view::npos;
        switch (size) {
        case 1:
            return is_signed ? load<std::int8_t>(at, order) : load<std::uint8_t>(at, order);
        case 2:
            return is_signed ? load<std::int16_t>(at, order) : load<std::uint16_t>(at, order);
        case 4:
            return is_signed ? load<std::int32_t>(at, order) : load<std::uint32_t>(at, order);
        default:
            return is_signed ? static_cast<double>(load<std::int64_t>(at, order))
                             : static_cast<double>(load<std::uint64_t>(at, order));
        }
    }

    /// The rest of the line that was being read.
    std::string_view line() {
        const std::size_t end = std::min(bytes_.find('\n', at_), bytes_.size());
        std::string_view text = bytes_.substr(at_, end - at_);
        at_ = std::min(end + 1, bytes_.size());
        return text.ends_with('\r') ? text.substr(0, text.size() - 1) : text;
    }

    /// It ends with an empty line.
    void skip_metadata() {
        end_line();
        while (!trim(line()).empty()) {
        }
    }

    /// Passes over the end of the line before binary values.
    void end_line() { (void)line(); }

    std::string_view next_word() {
        const auto is_blank = [](char c) { return c == ' ' || c == '\t' || c == '\r' || c == '\n'; };
        while (at_ < bytes_.size() && is_blank(bytes_[at_])) {
            ++at_;
        }
        const std::size_t begin = at_;
        while (at_ < bytes_.size() && !is_blank(bytes_[at_])) {
            ++at_;
        }
        return bytes_.substr(begin, at_ - begin);
    }

    std::string_view need_word() {
        const std::string_view word = next_word();
        if (word.empty()) {
            fail("cut short");
        }
        return word;
    }

    std::uint64_t whole(std::string_view word, const char* what) const {
        const auto value = parse_integer<std::uint64_t>(word);
        if (!value) {
            fail(fmt::format("number of {} {}; must be a whole number", what, in_quotes(word)));
        }
        return *value;
    }
    std::uint64_t number(const char* what) { return whole(next_word(), what); }

    [[noreturn]] void fail(const std::string& message) const {
        const auto before = bytes_.substr(0, at_);
        if (binary_) {
            throw InputError(fmt::format("{}: byte {}: {}", file_, at_, message));
        }
        const auto lines = static_cast<std::size_t>(std::count(before.begin(), before.end(), '\n'));
        throw ParseError(file_, lines + (before.ends_with('\n') ? 0 : 1), 0, message);
    }

    std::string file_;
    std::string_view bytes_;
    Diagnostics& diagnostics_;
    VtkFaces faces_;
    VtkCells cells_;
    std::size_t at_ = 0;
    bool binary_ = false;
    bool of_cells_ = false; ///< attributes that follow
    std::uint64_t tuples_ = 0;
    int group_rank_ = 0;
};

} // namespace

FaceMesh read_vtk_legacy(const std::filesystem::path& path, std::string_view bytes,
                         const SceneReaderOptions& options, Diagnostics& diagnostics) {
    return VtkLegacyReader(path, bytes, options, diagnostics).read();
}

} // namespace hemi::io
