#include "cli/error_target.hpp"

#include "cli/exit_status.hpp"
#include "cli/report.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace hemi::cli {

namespace {

constexpr double reference_seconds = 1.5;

std::vector<Candidate> make_ladder(const RowOptions& options, std::uint32_t patches) {
    return {hemicube_candidate(options, "plain", patches, 1, 64),
            hemicube_candidate(options, "plain", patches, 1, 128),
            hemicube_candidate(options, "fast", patches),
            hemicube_candidate(options, "default", patches),
            hemicube_candidate(options, "default", patches, 4, 64),
            hemicube_candidate(options, "default", patches, 9, 128),
            hemicube_candidate(options, "exact", patches),
            hemicube_candidate(options, "exact", patches, 16, 128),
            hemicube_candidate(options, "exact", patches, 36, 128)};
}

} // namespace

TargetSearch::TargetSearch(const LoadedScene& loaded, std::span<const std::uint32_t> patches,
                           const RowOptions& options, double target, const Terminal& terminal)
    : loaded_(loaded), patches_(patches.begin(), patches.end()), target_(target), terminal_(terminal),
      memory_limit_(memory_limit(options)),
      reference_(find_reference(loaded, patches, options, reference_seconds)),
      ladder_(make_ladder(options, loaded.mesh.size())) {}

RowOptions TargetSearch::first() {
    rung_ = 1;
    return ladder_.front().options;
}

RowOptions TargetSearch::next(std::span<const double> radiosity) {
    for (; rung_ < ladder_.size(); ++rung_) {
        const Candidate& candidate = ladder_[rung_];
        if (table_of_pairs(candidate, loaded_.mesh.size(), patches_.size()) > memory_limit_) {
            omitted_ = candidate.command;
            continue;
        }
        const Measurement measurement =
            try_on_sample(loaded_, candidate, reference_, patches_.size(), radiosity);
        const double error = measurement.radiosity.value_or(measurement.error.row_rms);
        terminal_.detail(fmt::format("{}: error {:.2g} on {}, {} for all rows", candidate.command, error,
                                     plural(reference_.patches.size(), "row", "rows"),
                                     seconds_text(measurement.seconds)));
        if (best_.empty() || error < least_) {
            least_ = error;
            best_ = candidate.command;
        }
        if (error <= target_) {
            ++rung_;
            return candidate.options;
        }
    }
    give_up();
}

bool TargetSearch::met(double error) {
    const std::string& command = ladder_[rung_ - 1].command;
    if (best_.empty() || error < least_) {
        least_ = error;
        best_ = command;
    }
    if (error > target_) {
        terminal_.detail(
            fmt::format("{}: error {:.2g} with all rows, more than {}", command, error, target_));
    }
    return error <= target_;
}

std::string TargetSearch::told() const {
    return fmt::format("{} for --error-target {}", ladder_[rung_ - 1].command, target_);
}

void TargetSearch::give_up() const {
    std::string message = fmt::format("--error-target {} cannot be met", target_);
    if (!best_.empty()) {
        message += fmt::format(": the best there is, {}, is off by {:.2g}", best_, least_);
    }
    if (!omitted_.empty()) {
        message += fmt::format("; {} needs more than the {} of memory that it may take", omitted_,
                               memory_text(memory_limit_));
    }
    throw ToleranceMissed(message);
}

} // namespace hemi::cli
