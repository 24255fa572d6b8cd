#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace hemi::io {

/// The bytes that base64 text stands for (RFC 4648, with or without padding); nothing if it is none.
[[nodiscard]] std::optional<std::string> decode_base64(std::string_view text);

} // namespace hemi::io
