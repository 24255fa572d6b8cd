#pragma once

#include "hemi/core/diagnostics.hpp"
#include "hemi/core/names.hpp"

#include <cstddef>
#include <functional>
#include <string>
#include <string_view>
#include <utility>

namespace hemi::cli {

/// When messages are coloured.
enum class ColourChoice { automatic, always, never };

/// Messages for people, on stderr. Standard output is left to data.
class Terminal {
public:
    /// Colours by `colour`; for automatic, NO_COLOR, CLICOLOR_FORCE, TERM=dumb and whether stderr is a
    /// terminal decide.
    /// @param quiet  errors only.
    explicit Terminal(bool quiet = false, bool verbose = false,
                      ColourChoice colour = ColourChoice::automatic);

    [[nodiscard]] bool quiet() const noexcept { return quiet_; }
    [[nodiscard]] bool verbose() const noexcept { return verbose_; }
    /// Whether a line on stderr may be drawn again and again.
    [[nodiscard]] bool can_redraw() const noexcept { return can_redraw_; }

    void error(std::string_view message) const;
    void warn(std::string_view message) const;
    /// Its warnings, then its notes.
    void warn(const Diagnostics& diagnostics) const;
    /// A sentence that most people want to read; not with -q.
    void note(std::string_view message) const;
    /// Only with -v.
    void detail(std::string_view message) const;

private:
    void write(std::string_view label, std::string_view colour, std::string_view message) const;

    bool quiet_;
    bool verbose_;
    bool colours_;
    bool can_redraw_;
};

} // namespace hemi::cli

namespace hemi {
template <>
struct Names<cli::ColourChoice> {
    static constexpr NamedValue<cli::ColourChoice> table[] = {{cli::ColourChoice::automatic, "auto"},
                                                              {cli::ColourChoice::always, "always"},
                                                              {cli::ColourChoice::never, "never"}};
};
} // namespace hemi
