#include "hemi/core/nearest_word.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <utility>
#include <vector>

namespace hemi {

namespace {

std::string lower(std::string_view word) {
    std::string result(word);
    for (char& letter : result) {
        if (letter >= 'A' && letter <= 'Z') {
            letter = static_cast<char>(letter - 'A' + 'a');
        }
    }
    return result;
}

std::size_t allowed_slips(std::size_t length) {
    if (length < 2) {
        return 0;
    }
    return length <= 5 ? 1 : length <= 8 ? 2 : 3;
}

/// Damerau-Levenshtein distance, neighbours swapped at most once (optimal string alignment).
std::size_t distance(std::string_view a, std::string_view b) {
    std::vector<std::size_t> before(b.size() + 1);
    std::vector<std::size_t> above(b.size() + 1);
    std::vector<std::size_t> row(b.size() + 1);
    for (std::size_t j = 0; j <= b.size(); ++j) {
        above[j] = j;
    }
    for (std::size_t i = 1; i <= a.size(); ++i) {
        row[0] = i;
        for (std::size_t j = 1; j <= b.size(); ++j) {
            const std::size_t replaced = above[j - 1] + (a[i - 1] == b[j - 1] ? 0 : 1);
            row[j] = std::min({above[j] + 1, row[j - 1] + 1, replaced});
            if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1]) {
                row[j] = std::min(row[j], before[j - 2] + 1);
            }
        }
        std::swap(before, above);
        std::swap(above, row);
    }
    return above[b.size()];
}

} // namespace

std::optional<std::string> nearest_word(std::string_view word, std::span<const std::string> known) {
    constexpr std::size_t longest = 200; // beyond, a mistyped word is not what happened
    if (word.size() > longest) {
        return std::nullopt;
    }
    const std::string wanted = lower(word);
    std::size_t best = allowed_slips(wanted.size()) + 1;
    std::optional<std::string> nearest;
    for (const std::string& candidate : known) {
        const std::size_t gap =
            std::max(candidate.size(), word.size()) - std::min(candidate.size(), word.size());
        if (gap >= best) {
            continue;
        }
        const std::size_t slips = distance(wanted, lower(candidate));
        if (slips < best) {
            best = slips;
            nearest = candidate;
        }
    }
    return nearest;
}

std::string did_you_mean(std::string_view word, std::span<const std::string> known) {
    const auto nearest = nearest_word(word, known);
    return nearest ? fmt::format("; did you mean \"{}\"?", *nearest) : std::string();
}

std::string did_you_mean_or_list(std::string_view word, std::span<const std::string> known) {
    if (const auto nearest = nearest_word(word, known)) {
        return fmt::format("; did you mean \"{}\"?", *nearest);
    }
    constexpr std::size_t most = 10;
    const auto shown = known.first(std::min(known.size(), most));
    return known.empty()
               ? std::string()
               : fmt::format("; there is {}{}", fmt::join(shown, ", "), known.size() > most ? ", …" : "");
}

} // namespace hemi
