#include "hemi/core/error.hpp"
#include "hemi/io/factor_file.hpp"
#include "hemi/io/output_file.hpp"
#include "io/factors/rows_builder.hpp"
#include "io/formats/binary_scan.hpp"
#include "io/formats/text_scan.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

namespace hemi::io {

namespace {

constexpr std::size_t head_bytes = 32; ///< of a binary file: 30 characters, CR LF
constexpr std::uint64_t most_rows = 1'000'000;

/// The numbers of a file behind its header, one after the other.
class Numbers {
public:
    Numbers(std::string_view bytes, std::string_view data, bool text, const std::string& file)
        : file_(file), text_(text), data_(data), lines_(bytes) {
        if (text_) {
            (void)lines_.next(rest_); // the header
            rest_ = {};
        }
    }

    /// @param what  it is, for the message
    double next(const char* what) {
        const double number = text_ ? next_word_value(what) : next_float(what);
        if (!(number >= 0.0 && number <= static_cast<double>(std::numeric_limits<float>::max()))) {
            fail(fmt::format("{} {}; must be finite and not negative", what, number));
        }
        return number;
    }

    void end() {
        if (text_ && !next_token().empty()) {
            fail(fmt::format("{} after the emissivities", in_quotes(token_)));
        }
        if (!text_ && at_ != data_.size()) {
            fail(fmt::format("{} bytes after the emissivities", data_.size() - at_));
        }
    }

    [[noreturn]] void fail(const std::string& message) const {
        if (text_) {
            throw ParseError(file_, lines_.number(), 0, message);
        }
        throw InputError(fmt::format("{}: byte {}: {}", file_, head_bytes + at_, message));
    }

private:
    std::string_view next_token() {
        do {
            token_ = next_word(rest_);
        } while (token_.empty() && lines_.next(rest_));
        return token_;
    }

    double next_word_value(const char* what) {
        const auto value = parse_number(next_token());
        if (!value) {
            fail(token_.empty() ? fmt::format("cut short: {} is missing", what)
                                : fmt::format("{} {}; must be a number", what, in_quotes(token_)));
        }
        return *value;
    }

    double next_float(const char* what) {
        if (data_.size() - at_ < sizeof(float)) {
            fail(fmt::format("cut short: {} is missing", what));
        }
        const auto value = static_cast<double>(load<float>(data_.data() + at_, std::endian::little));
        at_ += sizeof(float);
        return value;
    }

    const std::string& file_;
    bool text_;
    std::string_view data_;
    std::size_t at_ = 0;
    Lines lines_;
    std::string_view rest_;
    std::string_view token_;
};

struct Head {
    std::uint32_t size = 0;
    bool closed = false;
};

/// program, version, format, enclosure, whether reflection is in, N
Head read_head(std::string_view line, std::string_view bytes, bool text, const std::string& file) {
    const auto fail = [&](const std::string& message) { throw ParseError(file, 1, 0, message); };
    std::string_view rest = line;
    (void)next_word(rest);
    (void)next_word(rest);
    const auto format = parse_integer<std::uint64_t>(next_word(rest));
    const auto enclosure = parse_integer<std::uint64_t>(next_word(rest));
    const auto emission = parse_integer<std::uint64_t>(next_word(rest));
    const auto size = parse_integer<std::uint64_t>(next_word(rest));
    if (!format || !enclosure || !emission || !size || *size == 0) {
        fail(fmt::format(
            "{}; must be program, version, format, enclosure, emissivity and the number of surfaces",
            in_quotes(line)));
    }
    if (*format != (text ? 0 : 1)) {
        fail(fmt::format("format {}; must be {}, as the name's extension says", *format, text ? 0 : 1));
    }
    if (*emission != 0) {
        fail("the factors include reflection (emit = 1, as `hemi exchange` writes them); must be without it");
    }
    const std::uint64_t least = text ? 2 : sizeof(float); // bytes a number
    if (*size > most_rows || *size * (*size + 2) > (bytes.size() - line.size()) / least) {
        fail(fmt::format("{} surfaces in a file of {} bytes; that cannot be", *size, bytes.size()));
    }
    return {static_cast<std::uint32_t>(*size), *enclosure != 0};
}

} // namespace

FormFactors read_view3d(const std::filesystem::path& path, View3dFormat format) {
    const std::string file = path.string();
    const std::string bytes = read_file(path);
    const bool text = format == View3dFormat::text;
    std::string_view line;
    Lines lines(bytes);
    (void)lines.next(line);
    if (!text && (bytes.size() < head_bytes || line.size() > head_bytes)) {
        throw InputError(fmt::format("{}: {} bytes; View3D's binary files begin with a line of {}", file,
                                     bytes.size(), head_bytes));
    }
    const Head head = read_head(line, bytes, text, file);
    Numbers numbers(bytes, text ? std::string_view() : std::string_view(bytes).substr(head_bytes), text,
                    file);
    FormFactors result;
    result.enclosure = head.closed ? Enclosure::closed : Enclosure::open;
    for (std::uint32_t i = 0; i < head.size; ++i) {
        result.areas.push_back(numbers.next("area"));
        if (result.areas.back() == 0.0) {
            numbers.fail("area 0; must be positive");
        }
    }
    RowsBuilder rows(head.size);
    for (std::uint32_t i = 0; i < head.size; ++i) {
        for (std::uint32_t j = 0; j < head.size; ++j) {
            const auto factor = static_cast<float>(numbers.next("factor"));
            if (factor > 0.0f) {
                rows.add(j, factor);
            }
        }
        (void)rows.end_row();
    }
    for (std::uint32_t i = 0; i < head.size; ++i) {
        (void)numbers.next("emissivity");
    }
    numbers.end();
    result.matrix = rows.take();
    return result;
}

} // namespace hemi::io
