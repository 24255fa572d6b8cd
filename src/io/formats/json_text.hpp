#pragma once

#include <nlohmann/json.hpp>

#include <string>
#include <string_view>

namespace hemi::io {

/// JSON whose objects keep the file's order.
using Json = nlohmann::ordered_json;

/// Parses a JSON text strictly: no duplicate keys, no number beyond a double, at most 64 levels deep.
/// @throws ParseError with line and column for syntax; InputError with the JSON path for the rest.
[[nodiscard]] Json parse_json(std::string_view text, const std::string& file);

/// The text of a document, without line breaks. Bytes that are not UTF-8 become U+FFFD.
[[nodiscard]] std::string json_text(const Json& document);

} // namespace hemi::io
