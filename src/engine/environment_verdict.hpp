#pragma once

#include "hemi/core/enclosure.hpp"
#include "hemi/matrix/form_factor_matrix.hpp"
#include "hemi/matrix/provenance.hpp"

#include <cstddef>
#include <functional>
#include <span>

namespace hemi {

/// What a row says of the environment's share: by texels, by what its factors leave of 1, by the geometry.
struct EnvironmentEvidence {
    double texels = 0.0;    ///< share that texels measured
    double remainder = 0.0; ///< 1 less the sum of the factors and the share of backs
    /// Most that the remainder may be wrong by. Not finite where texels alone know of something what is
    /// hidden: then they decide.
    double error = 0.0;
    bool enclosed = false; ///< by the geometry: there is no environment
};

/// Relative error of unoccluded factors.
[[nodiscard]] double unoccluded_error(ExchangeRule rule);

/// Whether texels that measured so much of the environment saw it, and not only what slips through where two
/// walls meet.
[[nodiscard]] bool sees_environment(double share, Enclosure enclosure);

/// What a row says whose environment's share is as texels measured it.
/// @param row     with visibility
/// @param hidden  whether texels hide some patch from it that it faces
[[nodiscard]] EnvironmentEvidence evidence_of(const RowView& row, bool hidden, ExchangeRule rule);

/// Whether rows really see the environment, and not only what slips through where two walls meet: where their
/// factors leave more of 1 than their error, or, where that does not say, texels see enough.
/// @param rows             that are known
/// @param enclosure        as the scene says
/// @param exact_evidence   of a row by its number: with factors by the exact rule. Asked for the rows that
///                         lack most, where the standard rule cannot tell; may be empty
[[nodiscard]] bool is_open(std::span<const EnvironmentEvidence> rows, Enclosure enclosure,
                           const std::function<EnvironmentEvidence(std::size_t)>& exact_evidence = {});

/// The environment's share of a row: in an open scene what its factors leave of 1, which F0 knows better than
/// texels do; else what texels saw slip through, no more than the remainder allows.
/// @param open  is_open() of all rows
[[nodiscard]] double environment_share(const EnvironmentEvidence& row, Enclosure enclosure, bool open);

} // namespace hemi
