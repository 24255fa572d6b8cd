#pragma once

#include "cli/candidate.hpp"

#include <cstddef>
#include <span>
#include <string>
#include <vector>

/// `--error-target`: the cheapest settings by which a result is good enough.
namespace hemi::cli {

/// Goes up a ladder of settings, cheapest first. Each is judged by a few rows before all are computed.
class TargetSearch {
public:
    /// @param target   of rows' error (root of the sum of squares, rms over the rows), or of the error of
    /// what
    ///   is reflected, relative, once there is a radiosity to judge by
    /// @param patches  whose rows are needed
    TargetSearch(const LoadedScene& loaded, std::span<const std::uint32_t> patches, const RowOptions& options,
                 double target, const Terminal& terminal);

    /// The lowest rung, whatever it is good for.
    [[nodiscard]] RowOptions first();
    /// The next rung that meets the target on the sample.
    /// @param radiosity  N·channels of about what it is; empty: rows are judged
    /// @throws ToleranceMissed if none does within the limits.
    [[nodiscard]] RowOptions next(std::span<const double> radiosity = {});

    /// Whether what came of the last rung in the end, all rows and repaired, meets the target.
    [[nodiscard]] bool met(double error);

    [[nodiscard]] const Reference& reference() const { return reference_; }
    /// What was chosen and why, as a line for people and files.
    [[nodiscard]] std::string told() const;

private:
    [[noreturn]] void give_up() const;

    const LoadedScene& loaded_;
    std::vector<std::uint32_t> patches_;
    double target_;
    const Terminal& terminal_;
    std::uint64_t memory_limit_;
    Reference reference_;
    std::vector<Candidate> ladder_;
    std::size_t rung_ = 0; ///< the next one
    double least_ = 0.0;   ///< error of the best so far; 0: none was tried
    std::string best_;
    std::string omitted_; ///< rungs that do not fit the memory
};

} // namespace hemi::cli
