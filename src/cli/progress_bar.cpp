#include "cli/progress_bar.hpp"

#include "cli/signals.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <sys/ioctl.h>
#include <unistd.h>

namespace hemi::cli {

namespace {

constexpr std::chrono::milliseconds redraw_interval{100};
constexpr std::chrono::seconds long_run{10};

std::size_t terminal_width() {
    winsize size{};
    return ioctl(STDERR_FILENO, TIOCGWINSZ, &size) == 0 && size.ws_col > 0 ? size.ws_col : 80;
}

std::string clock_text(double seconds) {
    const auto whole = static_cast<long long>(std::ceil(seconds));
    if (whole >= 3600) {
        return fmt::format("{}:{:02}:{:02}", whole / 3600, whole / 60 % 60, whole % 60);
    }
    return fmt::format("{}:{:02}", whole / 60, whole % 60);
}

/// "43 %  1234 rows/s  0:12 left"
/// @param before   of `done`, what was done when the clock began to run
/// @param seconds  by that clock
std::string figures(std::size_t before, std::size_t done, std::size_t total, double seconds,
                    const std::string& unit) {
    const double share = static_cast<double>(done) / static_cast<double>(total);
    std::string text = fmt::format("{:3.0f} %", std::floor(100.0 * share));
    // The first rows wait for everything to start and tell nothing about the rest.
    if (done > before && seconds > 0.0 && (share >= 0.02 || seconds > 3.0)) {
        const double rate = static_cast<double>(done - before) / seconds;
        if (!unit.empty()) {
            text += fmt::format("  {:.{}f} {}/s", rate, rate < 10.0 ? 1 : 0, unit);
        }
        text += fmt::format("  {} left", clock_text(static_cast<double>(total - done) / rate));
    }
    return text;
}

} // namespace

ProgressBar::ProgressBar(const Terminal& terminal, std::string title, std::string unit)
    : terminal_(terminal), title_(std::move(title)), unit_(std::move(unit)), start_(Clock::now()),
      drawn_(start_) {}

ProgressBar::~ProgressBar() {
    if (visible_) {
        std::fputs("\r\x1b[K", stderr);
    }
}

bool ProgressBar::update(std::size_t done, std::size_t total) {
    if (total > 0 && !terminal_.quiet()) {
        const Clock::time_point now = Clock::now();
        before_ = std::min(before_.value_or(done), done);
        if (!terminal_.can_redraw()) {
            print_tenth(done, total, now);
        } else if (now - drawn_ >= redraw_interval) {
            draw(done, total, now);
        }
    }
    return !interrupted();
}

void ProgressBar::draw(std::size_t done, std::size_t total, Clock::time_point now) {
    const double seconds = std::chrono::duration<double>(now - start_).count();
    const std::string text = figures(*before_, done, total, seconds, unit_);
    const std::size_t taken = title_.size() + text.size() + 6;
    const std::size_t width = terminal_width();
    std::string bar;
    if (width > taken + 10) {
        const std::size_t cells = std::min<std::size_t>(width - taken, 30);
        const std::size_t filled = cells * done / total;
        bar = fmt::format("[{:.<{}}] ", std::string(filled, '#'), cells);
    }
    const std::string line = fmt::format("\r\x1b[K{} {}{}", title_, bar, text);
    std::fwrite(line.data(), 1, line.size(), stderr);
    drawn_ = now;
    visible_ = true;
}

void ProgressBar::print_tenth(std::size_t done, std::size_t total, Clock::time_point now) {
    const std::size_t tenth = 10 * done / total;
    const bool wanted = terminal_.verbose() && !unit_.empty();
    if (tenth == tenth_ || (!wanted && now - start_ < long_run)) {
        return;
    }
    tenth_ = tenth;
    const double seconds = std::chrono::duration<double>(now - start_).count();
    const std::string line = fmt::format("{} {}\n", title_, figures(*before_, done, total, seconds, unit_));
    std::fwrite(line.data(), 1, line.size(), stderr);
}

} // namespace hemi::cli
