#pragma once

#include <algorithm>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace hemi {

/// An enumerator and the word by which it is written on command lines, in JSON and in files.
template <class Enum>
struct NamedValue {
    Enum value;            ///< the enumerator
    std::string_view word; ///< its word
};

/// Words of an enumeration: specialised beside each enumeration, with a static member `table` of NamedValue
/// in the order in which words are listed.
template <class Enum>
struct Names;

/// The word of an enumerator.
template <class Enum>
[[nodiscard]] constexpr std::string_view to_word(Enum value) {
    for (const NamedValue<Enum>& named : Names<Enum>::table) {
        if (named.value == value) {
            return named.word;
        }
    }
    return {};
}

/// The enumerator of a word; nothing if there is none.
template <class Enum>
[[nodiscard]] constexpr std::optional<Enum> from_word(std::string_view word) {
    for (const NamedValue<Enum>& named : Names<Enum>::table) {
        if (named.word == word) {
            return named.value;
        }
    }
    return std::nullopt;
}

/// All words, in the order of the table.
template <class Enum>
[[nodiscard]] std::vector<std::string> words() {
    std::vector<std::string> all;
    for (const NamedValue<Enum>& named : Names<Enum>::table) {
        all.emplace_back(named.word);
    }
    return all;
}

} // namespace hemi
