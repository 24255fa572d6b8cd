#pragma once

#include "hemi/matrix/form_factor_matrix.hpp"

#include <algorithm>
#include <cstdint>
#include <limits>

namespace hemi {

/// V of a pair of patches, the same for both directions, in two bytes: hidden (0), clear (1, and known to
/// be), or between, in 65,534ths.
class PairVisibility {
public:
    /// Hidden.
    PairVisibility() = default;
    [[nodiscard]] static PairVisibility clear() { return PairVisibility(clear_code); }
    /// Not clear, even if `visibility` is 1. Below half a step it is one step: something was seen.
    [[nodiscard]] static PairVisibility from(double visibility) {
        return PairVisibility(
            visibility <= 0.0 ? std::uint16_t{0}
                              : static_cast<std::uint16_t>(std::clamp(visibility * scale + 0.5, 1.0, scale)));
    }

    [[nodiscard]] bool is_hidden() const { return code_ == 0; }
    /// In [0, 1].
    [[nodiscard]] double value() const { return code_ == clear_code ? 1.0 : code_ / scale; }
    /// As it is stored beside a factor that is not 0: in 255ths, below visibility_clear unless it is clear.
    [[nodiscard]] std::uint8_t stored() const {
        return code_ == clear_code ? visibility_clear
                                   : static_cast<std::uint8_t>(std::clamp(value() * visibility_clear + 0.5,
                                                                          1.0, visibility_clear - 1.0));
    }

private:
    static constexpr std::uint16_t clear_code = std::numeric_limits<std::uint16_t>::max();
    static constexpr double scale = clear_code - 1.0;

    explicit PairVisibility(std::uint16_t code) : code_(code) {}

    std::uint16_t code_ = 0;
};

/// V of a pair and what it rests on.
struct PairEstimate {
    PairVisibility visibility;
    double texels; ///< of both directions together; 0: it is assumed
};

} // namespace hemi
