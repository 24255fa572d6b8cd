#include "io/factors/npy.hpp"

#include "hemi/core/error.hpp"
#include "hemi/io/factor_file.hpp"
#include "hemi/io/output_file.hpp"
#include "io/factors/dense_rows.hpp"
#include "io/factors/triples.hpp"
#include "io/formats/text_scan.hpp"

#include <fmt/format.h>

#include <bit>
#include <cstring>
#include <utility>

namespace hemi::io {

static_assert(std::endian::native == std::endian::little, "arrays are little endian; swap bytes here");

namespace {

constexpr std::string_view magic = "\x93NUMPY";

/// What stands between `before` and `after`; nothing if they do not.
std::optional<std::string_view> between(std::string_view text, std::string_view before,
                                        std::string_view after) {
    const std::size_t start = text.find(before);
    if (start == std::string_view::npos) {
        return std::nullopt;
    }
    text.remove_prefix(start + before.size());
    const std::size_t end = text.find(after);
    return end == std::string_view::npos ? std::nullopt : std::optional(text.substr(0, end));
}

template <class T>
T element(std::string_view data, std::size_t index) {
    T value;
    std::memcpy(&value, data.data() + index * sizeof(T), sizeof(T));
    return value;
}

} // namespace

std::string npy_header(std::string_view type, std::string_view shape) {
    std::string text = fmt::format("{{'descr': '{}', 'fortran_order': False, 'shape': {}, }}", type, shape);
    const std::size_t before = magic.size() + 4;
    text.append(63 - (before + text.size()) % 64, ' ');
    text += '\n';
    std::string result(magic);
    result += {'\x01', '\x00', static_cast<char>(text.size() & 0xFF), static_cast<char>(text.size() >> 8)};
    return result + text;
}

void write_npy(const std::filesystem::path& path, const FormFactorMatrix& factors) {
    require_all_known(factors, "an .npy file");
    OutputFile output(path);
    output.write(npy_header("<f4", fmt::format("({0}, {0})", factors.size())));
    write_dense_rows(output, factors);
    output.commit();
}

NpyArray::NpyArray(std::string bytes, std::string name) : bytes_(std::move(bytes)), name_(std::move(name)) {
    const std::string_view all = bytes_;
    if (all.substr(0, magic.size()) != magic || all.size() < magic.size() + 6) {
        fail("is no NumPy array");
    }
    const bool short_length = all[magic.size()] == 1;
    const std::size_t before = magic.size() + (short_length ? 4 : 6);
    const std::size_t length = short_length ? element<std::uint16_t>(all.substr(magic.size() + 2), 0)
                                            : element<std::uint32_t>(all.substr(magic.size() + 2), 0);
    if (length > all.size() - before) {
        fail("cut short");
    }
    start_ = before + length;
    read_description(all.substr(before, length));
    if (data().size() % element_bytes() != 0 || data().size() / element_bytes() != size_) {
        fail(fmt::format("{} bytes of data for {} elements of type {}", data().size(), size_, type_));
    }
}

void NpyArray::read_description(std::string_view text) {
    const auto type = between(text, "'descr': '", "'");
    const auto shape = between(text, "'shape': (", ")");
    if (!type || !shape) {
        fail(fmt::format("header {}; must name a type and a shape", in_quotes(trim(text))));
    }
    type_ = *type;
    if (shape->empty()) {
        return;
    }
    const std::size_t comma = shape->find(',');
    const auto size = parse_integer<std::uint64_t>(shape->substr(0, comma));
    if (!size || comma == std::string_view::npos || !trim(shape->substr(comma + 1)).empty()) {
        fail(fmt::format("shape ({}); must have one dimension", *shape));
    }
    size_ = *size;
}

std::size_t NpyArray::element_bytes() const {
    const auto count =
        parse_integer<std::size_t>(std::string_view(type_).substr(std::min<std::size_t>(2, type_.size())));
    if (!count || *count == 0 || *count > 1024 || (type_[0] != '<' && type_[0] != '|')) {
        fail(fmt::format("type {}; must be a little-endian type such as <f4 or <i4", in_quotes(type_)));
    }
    return type_[1] == 'U' ? 4 * *count : *count;
}

std::vector<std::uint64_t> NpyArray::integers() const {
    if (type_ != "<i4" && type_ != "<i8") {
        fail(fmt::format("type {}; must be <i4 or <i8", in_quotes(type_)));
    }
    std::vector<std::uint64_t> values(size_);
    for (std::size_t k = 0; k < size_; ++k) {
        const std::int64_t value =
            type_ == "<i4" ? element<std::int32_t>(data(), k) : element<std::int64_t>(data(), k);
        if (value < 0) {
            fail(fmt::format("element {} is {}; must not be negative", k, value));
        }
        values[k] = static_cast<std::uint64_t>(value);
    }
    return values;
}

std::vector<double> NpyArray::numbers() const {
    if (type_ != "<f4" && type_ != "<f8") {
        fail(fmt::format("type {}; must be <f4 or <f8", in_quotes(type_)));
    }
    std::vector<double> values(size_);
    for (std::size_t k = 0; k < size_; ++k) {
        values[k] =
            type_ == "<f4" ? static_cast<double>(element<float>(data(), k)) : element<double>(data(), k);
    }
    return values;
}

std::string NpyArray::text() const {
    const bool wide = type_.substr(0, 2) == "<U";
    if (size_ != 1 || (!wide && type_.substr(0, 2) != "|S")) {
        fail(fmt::format("type {}; must be a string", in_quotes(type_)));
    }
    std::string result;
    for (std::size_t k = 0; k < data().size(); k += wide ? 4 : 1) {
        if (data()[k] != '\0') {
            result += data()[k];
        }
    }
    return result;
}

void NpyArray::fail(const std::string& message) const {
    throw InputError(fmt::format("{}: {}", name_, message));
}

} // namespace hemi::io
