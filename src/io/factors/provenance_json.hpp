#pragma once

#include "hemi/core/names.hpp"
#include "hemi/matrix/provenance.hpp"
#include "io/formats/json_node.hpp"

#include <fmt/format.h>

#include <cstdint>
#include <limits>
#include <optional>

/// What made rows, in the description of a file of them.
namespace hemi::io {

/// A value of an enumeration by its word. @throws InputError for any other text
template <class Enum>
[[nodiscard]] Enum read_word(const JsonNode& node) {
    const std::optional<Enum> value = from_word<Enum>(node.any_text());
    if (!value) {
        node.expect(fmt::format("one of {}", fmt::join(words<Enum>(), ", ")));
    }
    return *value;
}

/// @throws InputError unless it is a whole number of 32 bits
[[nodiscard]] inline std::uint32_t integer32(const JsonNode& node) {
    return static_cast<std::uint32_t>(node.integer(std::numeric_limits<std::uint32_t>::max()));
}

/// Adds all but what the settings were chosen for.
void add_provenance(Json& head, const Provenance& provenance);
/// The same from a file.
/// @throws InputError
[[nodiscard]] Provenance read_provenance(const JsonNode& head);

} // namespace hemi::io
