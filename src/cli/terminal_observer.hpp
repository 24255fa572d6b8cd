#pragma once

#include "cli/progress_bar.hpp"
#include "cli/terminal.hpp"
#include "hemi/pipeline/observer.hpp"

#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace hemi::cli {

/// Shows on the terminal what the pipeline tells, and stops it once the user has interrupted.
class TerminalObserver : public Observer {
public:
    explicit TerminalObserver(const Terminal& terminal) : terminal_(terminal) {}

    /// What the work will consist of, in this order, as far as that is known: "2/6 combining pairs".
    void plan(std::vector<Phase> phases) { plan_ = std::move(phases); }

    bool progress(Phase phase, std::size_t done, std::size_t total) override;
    void warning(std::string_view message, std::string_view setting) override;
    void note(std::string_view message) override;
    void detail(std::string_view message) override;

private:
    [[nodiscard]] std::string title(Phase phase) const;

    const Terminal& terminal_;
    std::vector<Phase> plan_;
    std::optional<Phase> phase_; ///< of the bar
    std::optional<ProgressBar> bar_;
};

} // namespace hemi::cli
