#include "io/meshes/msh_blocks.hpp"

#include "hemi/core/error.hpp"
#include "hemi/core/text.hpp"
#include "io/formats/binary_scan.hpp"
#include "io/formats/text_scan.hpp"
#include "io/meshes/msh_faces.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <map>
#include <string>
#include <vector>

namespace hemi::io {

namespace {

/// The values of a file, as text or as bytes; lines between sections are text in either.
class Values {
public:
    Values(std::string_view text, const std::string& file, const MshFormat& format)
        : text_(text), file_(file), at_(format.bytes), line_(format.lines), binary_(format.binary) {
        if (binary_) {
            read_byte_order();
        }
    }

    /// The next line that is not empty, trimmed; false after the last.
    bool next_line(std::string_view& line) {
        while (at_ < text_.size()) {
            const std::size_t end = std::min(text_.find('\n', at_), text_.size());
            line = trim(text_.substr(at_, end - at_));
            while (line.ends_with('\r')) {
                line = trim(line.substr(0, line.size() - 1));
            }
            at_ = std::min(end + 1, text_.size());
            current_ = ++line_;
            if (!line.empty()) {
                return true;
            }
        }
        return false;
    }

    void need_line(std::string_view& line, std::string_view section) {
        if (!next_line(line)) {
            fail(fmt::format("cut short: the end of {} is missing", section));
        }
    }

    void skip_section(std::string_view section) {
        const std::string end = "$End" + std::string(section.substr(1));
        const std::size_t found = text_.find(end, at_);
        if (found == std::string_view::npos) {
            fail(fmt::format("cut short: the end of {} is missing", section));
        }
        count_lines(found);
        end_section(section);
    }

    void end_section(std::string_view section) {
        std::string_view line;
        need_line(line, section);
        const std::string end = "$End" + std::string(section.substr(1));
        if (line != end) {
            fail(fmt::format("{}; must be {}, the count says", in_quotes(line), end));
        }
    }

    /// An `int` of Gmsh.
    std::int64_t integer(const char* what) {
        return binary_ ? take<std::int32_t>(what) : parsed<std::int32_t>(what, "a whole number of 32 bits");
    }
    /// A `size_t` of Gmsh.
    std::uint64_t size(const char* what) {
        return binary_ ? take<std::uint64_t>(what) : parsed<std::uint64_t>(what, "a whole number from 0");
    }
    /// The number of things of which each takes at least that many bytes, in text two for each of its values.
    std::uint64_t count(const char* what, std::uint64_t binary_bytes, std::uint64_t values) {
        const std::uint64_t number = size(what);
        check_count(number, what, binary_bytes, values);
        return number;
    }
    void check_count(std::uint64_t number, const char* what, std::uint64_t binary_bytes,
                     std::uint64_t values) const {
        if (number > (text_.size() - at_ + 1) / (binary_ ? binary_bytes : 2 * values)) {
            fail(fmt::format("{} {} in a file of {} bytes; that cannot be", number, what, text_.size()));
        }
    }
    double real(const char* what) {
        if (!binary_) {
            const std::string_view word = next_value(what);
            if (const auto value = parse_number(word)) {
                return *value;
            }
            fail(fmt::format("{} {}; must be a finite number", what, in_quotes(word)));
        }
        const double value = take<double>(what);
        if (!std::isfinite(value)) {
            fail(fmt::format("{} {}; must be a finite number", what, value));
        }
        return value;
    }

    /// Of what was read last.
    [[nodiscard]] FacePlace place(std::uint64_t element) const { return {binary_ ? 0 : current_, element}; }

    [[noreturn]] void fail(const std::string& message) const {
        if (binary_) {
            throw InputError(fmt::format("{}: byte {}: {}", file_, at_, message));
        }
        throw ParseError(file_, std::max<std::size_t>(current_, 1), 0, message);
    }

private:
    void read_byte_order() {
        const std::uint64_t left = text_.size() - at_;
        for (const std::endian order : {std::endian::little, std::endian::big}) {
            if (left >= 4 && load<std::int32_t>(text_.data() + at_, order) == 1) {
                order_ = order;
                at_ += 4;
                return;
            }
        }
        fail("no integer 1, by which a binary file tells its byte order");
    }

    template <class Number>
    Number take(const char* what) {
        if (text_.size() - at_ < sizeof(Number)) {
            fail(fmt::format("cut short: {} is missing", what));
        }
        const auto number = load<Number>(text_.data() + at_, order_);
        at_ += sizeof(Number);
        return number;
    }

    template <class Number>
    Number parsed(const char* what, const char* wanted) {
        const std::string_view word = next_value(what);
        const auto number = parse_integer<Number>(word);
        if (!number) {
            fail(fmt::format("{} {}; must be {}", what, in_quotes(word), wanted));
        }
        return *number;
    }

    /// The next word of any line.
    std::string_view next_value(const char* what) {
        const auto is_blank = [](char c) { return c == ' ' || c == '\t' || c == '\r' || c == '\n'; };
        std::size_t begin = at_;
        while (begin < text_.size() && is_blank(text_[begin])) {
            line_ += text_[begin] == '\n' ? 1 : 0;
            ++begin;
        }
        at_ = begin;
        current_ = line_ + 1;
        while (at_ < text_.size() && !is_blank(text_[at_])) {
            ++at_;
        }
        if (at_ == begin) {
            fail(fmt::format("cut short: {} is missing", what));
        }
        return text_.substr(begin, at_ - begin);
    }

    void count_lines(std::size_t end) {
        if (!binary_) {
            line_ += static_cast<std::size_t>(std::count(text_.data() + at_, text_.data() + end, '\n'));
        }
        at_ = end;
    }

    std::string_view text_;
    const std::string& file_;
    std::size_t at_;
    std::size_t line_;        ///< those that have ended
    std::size_t current_ = 0; ///< number of the line of what was read last
    bool binary_;
    std::endian order_ = std::endian::native;
};

class MshBlockReader {
public:
    MshBlockReader(const std::filesystem::path& path, std::string_view text, const MshFormat& format,
                   const SceneReaderOptions& options, Diagnostics& diagnostics)
        : file_(path.string()), values_(text, file_, format), version_4_(format.version_4),
          bytes_(text.size()), diagnostics_(diagnostics), faces_(path, options) {}

    FaceMesh read() {
        values_.end_section("$MeshFormat");
        std::string_view line;
        while (values_.next_line(line)) {
            const std::string section(line);
            if (section == "$PhysicalNames") {
                read_names();
            } else if (version_4_ && (section == "$Entities" || section == "$PartitionedEntities")) {
                read_entities(section == "$PartitionedEntities");
            } else if (section == "$Nodes" || (!version_4_ && section == "$ParametricNodes")) {
                if (faces_.nodes() > 0) {
                    values_.fail("a second section of nodes");
                }
                version_4_ ? read_nodes() : read_old_nodes(section);
            } else if (section == "$Elements") {
                if (has_elements_) {
                    values_.fail("a second $Elements section");
                }
                has_elements_ = true;
                version_4_ ? read_elements() : read_old_elements();
            } else if (section.starts_with('$') && !section.starts_with("$End")) {
                if (section != "$Comments") {
                    diagnostics_.warn(
                        fmt::format("{}: the section {} is not used", file_, in_quotes(section)));
                }
                values_.skip_section(section);
                continue;
            } else {
                values_.fail(
                    fmt::format("{} between sections; a section begins with its name, such as $Elements",
                                in_quotes(section)));
            }
            values_.end_section(section);
        }
        if (!has_elements_) {
            throw InputError(fmt::format("{}: no $Elements section; a scene needs faces", file_));
        }
        if (several_ > 0) {
            diagnostics_.warn(
                fmt::format("{}: {} in several physical surfaces; the first one of each counts", file_,
                            plural(several_, "surface of the geometry is", "surfaces of the geometry are")));
        }
        return faces_.finish(diagnostics_);
    }

private:
    /// The count that stands on a line of its own, in binary files too.
    std::uint64_t read_count_line(std::string_view section, std::uint64_t binary_bytes,
                                  std::uint64_t values) {
        std::string_view line;
        values_.need_line(line, section);
        const auto count = parse_integer<std::uint64_t>(line);
        if (!count) {
            values_.fail(fmt::format("{} in {}; must be the number of its items", in_quotes(line), section));
        }
        values_.check_count(*count, "items", binary_bytes, values);
        return *count;
    }

    void read_names() {
        if (has_elements_) {
            values_.fail("$PhysicalNames after $Elements; names must come first");
        }
        const std::uint64_t count = read_count_line("$PhysicalNames", 7, 3); // 2 1 "" in either
        for (std::uint64_t k = 0; k < count; ++k) {
            std::string_view line;
            values_.need_line(line, "$PhysicalNames");
            if (const auto wrong = faces_.add_name(line)) {
                values_.fail(*wrong);
            }
        }
    }

    /// What surfaces of the geometry belong to.
    void read_entities(bool partitioned) {
        if (partitioned) {
            (void)values_.size("number of partitions");
            const std::uint64_t ghosts = values_.count("ghost entities", 8, 2);
            for (std::uint64_t k = 0; k < ghosts; ++k) {
                (void)values_.integer("ghost entity");
                (void)values_.integer("its partition");
            }
        }
        std::array<std::uint64_t, 4> counts{};
        for (std::uint64_t& count : counts) {
            count = values_.count("entities", 36, 5);
        }
        for (std::uint32_t dimension = 0; dimension < 4; ++dimension) {
            for (std::uint64_t k = 0; k < counts[dimension]; ++k) {
                read_entity(dimension, partitioned);
            }
        }
    }

    void read_entity(std::uint32_t dimension, bool partitioned) {
        const std::int64_t tag = values_.integer("entity");
        if (partitioned) {
            (void)values_.integer("dimension of the parent");
            (void)values_.integer("parent");
            skip_integers("partitions");
        }
        for (int k = 0; k < (dimension == 0 ? 3 : 6); ++k) {
            (void)values_.real("a coordinate of an entity");
        }
        const std::uint64_t count = values_.count("physical groups", 4, 1);
        for (std::uint64_t k = 0; k < count; ++k) {
            const std::int64_t physical = values_.integer("physical group");
            if (dimension == 2 && k == 0) {
                physical_[tag] = std::abs(physical);
            }
        }
        several_ += dimension == 2 && count > 1 ? 1 : 0;
        if (dimension > 0) {
            skip_integers("bounding entities");
        }
    }

    void skip_integers(const char* what) {
        const std::uint64_t count = values_.count(what, 4, 1);
        for (std::uint64_t k = 0; k < count; ++k) {
            (void)values_.integer(what);
        }
    }

    Vec3 read_point() {
        Vec3 point(0.0);
        for (int axis = 0; axis < 3; ++axis) {
            point[axis] = values_.real("a coordinate of a node");
        }
        return point;
    }

    void add_node(std::uint64_t number, const Vec3& point) {
        if (faces_.nodes() >= ~std::uint32_t{0} - 1) {
            values_.fail("more nodes than there can be, 2^32 - 2");
        }
        if (!faces_.add_node(number, point)) {
            values_.fail(fmt::format("node {} is there twice", number));
        }
    }

    void read_nodes() {
        const std::uint64_t blocks = values_.count("blocks of nodes", 20, 4);
        faces_.reserve_nodes(values_.count("nodes", 32, 4));
        (void)values_.size("lowest node");
        (void)values_.size("highest node");
        std::vector<std::uint64_t> numbers;
        for (std::uint64_t b = 0; b < blocks; ++b) {
            const std::int64_t dimension = values_.integer("dimension of a block");
            (void)values_.integer("entity of a block");
            const std::int64_t parametric = values_.integer("whether a block is parametric");
            if (dimension < 0 || dimension > 3 || parametric < 0 || parametric > 1) {
                values_.fail(fmt::format("a block of dimension {}, parametric {}; must be 0 to 3, and 0 or 1",
                                         dimension, parametric));
            }
            const std::uint64_t count = values_.count("nodes", 32, 4);
            numbers.clear();
            for (std::uint64_t k = 0; k < count; ++k) {
                numbers.push_back(values_.size("node"));
            }
            for (const std::uint64_t number : numbers) {
                add_node(number, read_point());
                for (std::int64_t p = 0; parametric == 1 && p < dimension; ++p) {
                    (void)values_.real("a parameter of a node");
                }
            }
        }
    }

    const MshElementType& type_of(std::int64_t number) const {
        const MshElementType* const type =
            number > 0 && number < 1000 ? find_msh_element_type(static_cast<std::uint32_t>(number)) : nullptr;
        if (type == nullptr) {
            values_.fail(fmt::format("elements of type {} are not supported; surfaces are triangles and "
                                     "quadrilaterals, such as 2 and 3",
                                     number));
        }
        return *type;
    }

    void read_elements() {
        const std::uint64_t blocks = values_.count("blocks of elements", 20, 4);
        const std::uint64_t elements = values_.count("elements", 16, 2);
        faces_.reserve_faces(elements, bytes_ / 8);
        (void)values_.size("lowest element");
        (void)values_.size("highest element");
        for (std::uint64_t b = 0; b < blocks; ++b) {
            const std::int64_t dimension = values_.integer("dimension of a block");
            const std::int64_t entity = values_.integer("entity of a block");
            const MshElementType& type = type_of(values_.integer("type of a block"));
            const std::uint64_t count = values_.count("elements", 8 * (type.nodes + 1), type.nodes + 1);
            MshFaces::Tags tags{0, entity};
            if (const auto found = physical_.find(entity); dimension == 2 && found != physical_.end()) {
                tags.physical = found->second;
            }
            const auto next = [this](const char* what) { return values_.size(what); };
            for (std::uint64_t k = 0; k < count; ++k) {
                const std::uint64_t number = next("element");
                read_element(type, tags, number, next);
            }
        }
    }

    /// The nodes of an element. @param next  reads the number of one
    template <class Next>
    void read_element(const MshElementType& type, const MshFaces::Tags& tags, std::uint64_t number,
                      const Next& next) {
        const FacePlace place = values_.place(number);
        std::array<std::uint32_t, 4> corners{};
        const std::size_t size = type.kind == MshElementType::Kind::triangle ? 3 : 4;
        for (std::uint32_t c = 0; c < type.nodes; ++c) {
            const std::uint64_t node = next("node of an element");
            if (!type.is_face()) {
                continue;
            }
            const auto index = faces_.find_node(node);
            if (!index) {
                values_.fail(fmt::format("element {}: node {}; must be the number of one of the {} nodes",
                                         number, node, faces_.nodes()));
            }
            if (c < size) {
                corners[c] = *index;
            }
        }
        if (type.is_face()) {
            faces_.add_face(type, tags, {corners.data(), size}, place);
        } else {
            faces_.leave_out(type, place);
        }
    }

    /// Of version 2.2: every node by itself.
    void read_old_nodes(const std::string& section) {
        const std::uint64_t count = read_count_line(section, 28, 4);
        faces_.reserve_nodes(count);
        for (std::uint64_t k = 0; k < count; ++k) {
            const auto number = static_cast<std::uint64_t>(values_.integer("node"));
            add_node(number, read_point());
            if (section == "$ParametricNodes") {
                const std::int64_t dimension = values_.integer("dimension of a node's entity");
                (void)values_.integer("entity of a node");
                for (std::int64_t p = 0; p < dimension && dimension < 3; ++p) {
                    (void)values_.real("a parameter of a node");
                }
            }
        }
    }

    /// Of version 2.2: blocks of one type and number of tags, as many as it takes.
    void read_old_elements() {
        const std::uint64_t elements = read_count_line("$Elements", 8, 2);
        faces_.reserve_faces(elements, bytes_ / 12);
        for (std::uint64_t done = 0; done < elements;) {
            const MshElementType& type = type_of(values_.integer("type of a block"));
            const std::int64_t count = values_.integer("elements of a block");
            const std::int64_t tags = values_.integer("tags of an element");
            if (count <= 0 || static_cast<std::uint64_t>(count) > elements - done || tags < 0) {
                values_.fail(fmt::format("a block of {} elements with {} tags; {} elements are left", count,
                                         tags, elements - done));
            }
            for (std::int64_t k = 0; k < count; ++k) {
                const auto number = static_cast<std::uint64_t>(values_.integer("element"));
                MshFaces::Tags of;
                for (std::int64_t t = 0; t < tags; ++t) {
                    const std::int64_t tag = values_.integer("tag of an element");
                    of.physical = t == 0 ? tag : of.physical;
                    of.elementary = t == 1 ? tag : of.elementary;
                }
                read_element(type, of, number, [this](const char* what) {
                    return static_cast<std::uint64_t>(values_.integer(what));
                });
            }
            done += static_cast<std::uint64_t>(count);
        }
    }

    std::string file_;
    Values values_;
    bool version_4_;
    std::size_t bytes_;
    Diagnostics& diagnostics_;
    MshFaces faces_;
    std::map<std::int64_t, std::int64_t> physical_; ///< of surfaces of the geometry
    std::uint64_t several_ = 0;
    bool has_elements_ = false;
};

} // namespace

FaceMesh read_msh_blocks(const std::filesystem::path& path, std::string_view text, const MshFormat& format,
                         const SceneReaderOptions& options, Diagnostics& diagnostics) {
    return MshBlockReader(path, text, format, options, diagnostics).read();
}

} // namespace hemi::io
