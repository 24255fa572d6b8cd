#include "io/scenes/obj_lines.hpp"

#include "hemi/core/error.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <limits>
#include <utility>

namespace hemi::io {

ObjLines::ObjLines(std::string file, std::string_view text, Diagnostics& diagnostics)
    : file_(std::move(file)), lines_(text), diagnostics_(diagnostics) {}

ObjLines::int_type ObjLines::underflow() {
    while (next_logical_line()) {
        if (is_for_loader()) {
            current_ += '\n';
            setg(current_.data(), current_.data(), current_.data() + current_.size());
            return traits_type::to_int_type(current_.front());
        }
    }
    return traits_type::eof();
}

/// Joins lines that end with a backslash; the first one gives the number. Comments end with their line: they
/// may name a folder.
bool ObjLines::next_logical_line() {
    std::string_view piece;
    if (!lines_.next(piece)) {
        return false;
    }
    line_ = lines_.number();
    current_.assign(piece);
    const bool is_comment = trim(piece).starts_with('#');
    while (!is_comment && !current_.empty() && current_.back() == '\\' && lines_.next(piece)) {
        current_.back() = ' ';
        current_ += piece;
    }
    return true;
}

bool ObjLines::is_for_loader() {
    std::string_view rest = current_;
    const std::string_view word = next_word(rest);
    if (word.empty() || word[0] == '#') {
        return false;
    }
    if (current_.find('\0') != std::string::npos) {
        fail("a zero byte; this is not an OBJ file");
    }
    if (word == "v") {
        read_vertex(rest);
        return false;
    }
    if (word == "f") {
        current_ = face_for_loader(rest);
        return true;
    }
    if (word == "g" || word == "o" || word == "usemtl") {
        current_ += ' '; // the loader overlooks the word alone
        return true;
    }
    if (word == "mtllib") {
        libraries_.push_back({line_, std::string(trim(rest))});
        return false;
    }
    if (word != "vn" && word != "vt" && word != "s" && ignored_.size() < 100 &&
        ignored_.emplace(word).second) {
        diagnostics_.warn(
            fmt::format("{}:{}: {} lines are left out; only v, f, o, g, usemtl and mtllib are used", file_,
                        line_, in_quotes(word)));
    }
    return false;
}

void ObjLines::read_vertex(std::string_view rest) {
    Vec3 point{0.0};
    int count = 0;
    for (std::string_view word = next_word(rest); !word.empty(); word = next_word(rest), ++count) {
        const auto value = parse_number(word);
        if (!value) {
            fail(fmt::format("{} in a vertex; must be a finite number", in_quotes(word)));
        }
        if (count < 3) {
            point[count] = *value;
        }
    }
    if (count < 3) {
        fail(fmt::format("a vertex of {} numbers; must have 3", count));
    }
    if (vertices_.size() == std::numeric_limits<int>::max()) {
        fail("more vertices than the loader can count, 2^31 - 1");
    }
    vertices_.push_back(point);
}

/// The face with nothing but its vertices: what else stands there, the loader reads in ways of its own.
std::string ObjLines::face_for_loader(std::string_view rest) const {
    std::string face = "f";
    int count = 0;
    const auto size = static_cast<std::int64_t>(vertices_.size());
    for (std::string_view word = next_word(rest); !word.empty(); word = next_word(rest), ++count) {
        const std::string_view vertex = word.substr(0, word.find('/'));
        const auto index = parse_integer<std::int64_t>(vertex);
        if (!index || *index == 0) {
            fail(fmt::format("{} in a face; must be the number of a vertex, from 1, or from -1 backwards",
                             in_quotes(word)));
        }
        if (*index > size || *index < -size) {
            fail(fmt::format("a face with vertex {}; there are {} vertices so far", *index, size));
        }
        const std::string_view others = word.substr(vertex.size());
        if (others.find_first_not_of("0123456789-/") != std::string_view::npos ||
            std::count(others.begin(), others.end(), '/') > 2) {
            fail(fmt::format("{} in a face; must be like 1, 1/2, 1//3 or 1/2/3", in_quotes(word)));
        }
        fmt::format_to(std::back_inserter(face), " {}", *index);
    }
    if (count < 3) {
        fail(fmt::format("a face of {} vertices; must have 3 or more", count));
    }
    return face;
}

void ObjLines::fail(const std::string& message) const {
    throw ParseError(file_, line_, 0, message);
}

} // namespace hemi::io
