#pragma once

#include "hemi/core/error.hpp"

#include <optional>
#include <string>

namespace hemi {

/// Does work without which the rest can go on.
/// @return why it failed, a sentence; empty: it did not
/// @throws Cancelled
template <class Work>
[[nodiscard]] std::optional<std::string> failure(const Work& work) {
    try {
        work();
        return std::nullopt;
    } catch (const Cancelled&) {
        throw;
    } catch (const Error& error) {
        return error.what();
    }
}

} // namespace hemi
