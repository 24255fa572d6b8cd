#pragma once

#include "hemi/core/text.hpp"

#include <charconv>
#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

namespace hemi::io {

/// A text file without the byte order mark that UTF-8 may begin with.
/// @throws InputError as read_file(), and for text in UTF-16
[[nodiscard]] std::string read_text(const std::filesystem::path& path);

/// A file of text and, maybe, raw numbers, without the byte order mark that UTF-8 may begin with.
/// @throws InputError as read_file()
[[nodiscard]] std::string read_unmarked(const std::filesystem::path& path);

/// The lines of a text, ended by LF, CRLF or CR; the last one may lack its end.
class Lines {
public:
    explicit Lines(std::string_view text) : rest_(text) {}

    /// The next line, without its end; false after the last.
    bool next(std::string_view& line);
    /// Number of the line that next() gave, from 1.
    [[nodiscard]] std::size_t number() const noexcept { return number_; }
    /// What comes after that line.
    [[nodiscard]] std::string_view rest() const noexcept { return rest_; }

private:
    std::string_view rest_;
    std::size_t number_ = 0;
};

/// `text` without blanks and tabs at either end.
[[nodiscard]] std::string_view trim(std::string_view text);

/// Takes the next word (ended by blanks or tabs) off the front of `rest`; empty when there is none.
std::string_view next_word(std::string_view& rest);

/// `text` with the letters of ASCII as capitals, for words that count in any case.
[[nodiscard]] std::string upper_case(std::string_view text);

/// The number that `word` spells from end to end, if it does and is finite. Whatever the locale.
[[nodiscard]] std::optional<double> parse_number(std::string_view word);

/// The same for an integer that fits.
template <class Integer>
[[nodiscard]] std::optional<Integer> parse_integer(std::string_view word) {
    if (word.size() > 1 && word[0] == '+' && word[1] != '-') {
        word.remove_prefix(1);
    }
    Integer value{};
    const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
    if (error != std::errc() || end != word.data() + word.size()) {
        return std::nullopt;
    }
    return value;
}

/// `text` in quotes for a message: shortened, control characters as "?".
[[nodiscard]] std::string in_quotes(std::string_view text);

/// `text` itself if it is valid UTF-8, else its bytes taken as Latin-1: names from old files stay distinct
/// and can be written as JSON.
[[nodiscard]] std::string to_utf8(std::string_view text);

} // namespace hemi::io
