#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>

namespace hemi {

/// The known word that `word` was most likely meant to be: fewest single-letter insertions, deletions,
/// replacements and swaps of neighbours (case aside), the first of equals. Nothing if none is close: one slip
/// in two to five letters, two in six to eight, three in longer words.
[[nodiscard]] std::optional<std::string> nearest_word(std::string_view word,
                                                      std::span<const std::string> known);

/// `; did you mean "room"?`, or nothing if no known word is close.
[[nodiscard]] std::string did_you_mean(std::string_view word, std::span<const std::string> known);

/// As did_you_mean, but lists the known words (up to ten) where none is close.
[[nodiscard]] std::string did_you_mean_or_list(std::string_view word, std::span<const std::string> known);

} // namespace hemi
