#include "cli/report/trade_plot.hpp"

#include "hemi/core/error.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace hemi::cli {

namespace {

constexpr double width = 960.0;
constexpr double left = 84.0;
constexpr double right = width - 28.0;
constexpr double title_height = 38.0;
constexpr double panel_height = 580.0;
constexpr double panel_top = 74.0; ///< of the axes, below the panel's own top
constexpr double panel_bottom = panel_height - 62.0;
constexpr double text_size = 12.0;
constexpr double marker = 4.5;

struct Box {
    double x0, y0, x1, y1;

    [[nodiscard]] double overlap(const Box& other) const {
        const double across = std::min(x1, other.x1) - std::max(x0, other.x0);
        const double down = std::min(y1, other.y1) - std::max(y0, other.y0);
        return across > 0.0 && down > 0.0 ? across * down : 0.0;
    }
};

/// Of a sans serif at `text_size`, on the safe side.
double text_width(const std::string& text) {
    return 0.6 * text_size * static_cast<double>(text.size());
}

/// What fits above the drawing at 16 pixels, cut at a space.
std::string shortened(const std::string& title) {
    constexpr std::size_t most = 92;
    if (title.size() <= most) {
        return title;
    }
    const std::size_t space = title.rfind(' ', most - 4);
    return title.substr(0, space != std::string::npos && space > 0 ? space : most - 4) + " ...";
}

std::string escaped(const std::string& text) {
    std::string result;
    for (const char c : text) {
        switch (c) {
        case '<':
            result += "&lt;";
            break;
        case '>':
            result += "&gt;";
            break;
        case '&':
            result += "&amp;";
            break;
        default:
            result += static_cast<unsigned char>(c) < 0x20 ? ' ' : c;
        }
    }
    return result;
}

/// A logarithmic axis over whole decades, or over a part of them where one alone would do.
class Axis {
public:
    Axis(double smallest, double largest, double from, double upto) : from_(from), upto_(upto) {
        low_ = std::log10(smallest);
        high_ = std::log10(largest);
        const double margin = std::max(0.06 * (high_ - low_), 0.12);
        low_ -= margin;
        high_ += margin;
    }
    [[nodiscard]] double at(double value) const {
        return from_ + (upto_ - from_) * (std::log10(value) - low_) / (high_ - low_);
    }
    struct Tick {
        double value;
        bool labelled;
    };
    [[nodiscard]] std::vector<Tick> ticks() const {
        std::vector<Tick> ticks;
        const bool few = high_ - low_ < 2.7;
        for (int decade = static_cast<int>(std::floor(low_)); decade <= high_; ++decade) {
            for (int k = 1; k < 10; ++k) {
                const double exponent = decade + std::log10(k);
                if (exponent >= low_ && exponent <= high_) {
                    ticks.push_back({std::pow(10.0, exponent), k == 1 || (few && (k == 2 || k == 5))});
                }
            }
        }
        return ticks;
    }

private:
    double from_, upto_, low_ = 0.0, high_ = 1.0;
};

constexpr std::array<const char*, 8> colours{"#b5442c", "#1f6f8b", "#7a7a2a", "#7b4a94",
                                             "#3d7a46", "#555555", "#b0407f", "#a06a10"};

std::string written(double x, double y, const char* anchor, const char* colour, const std::string& text,
                    const std::string& more = "") {
    return fmt::format("<text x=\"{:.1f}\" y=\"{:.1f}\" text-anchor=\"{}\" fill=\"{}\" {}>{}</text>\n", x, y,
                       anchor, colour, more, escaped(text));
}

class Panel {
public:
    Panel(const PlotPanel& panel, double from_top)
        : panel_(panel), points_(panel.points), from_top_(from_top), top_(from_top + panel_top),
          bottom_(from_top + panel_bottom), x_(axis(&PlotPoint::seconds, left, right)),
          y_(axis(&PlotPoint::error, bottom_, top_)) {
        for (const PlotPoint& point : points_) {
            if (std::find(families_.begin(), families_.end(), point.family) == families_.end()) {
                families_.push_back(point.family);
            }
            const double x = x_.at(point.seconds);
            const double y = y_.at(point.error);
            taken_.push_back({x - marker, y - marker, x + marker, y + marker});
        }
    }

    [[nodiscard]] std::string text() {
        write(left, from_top_ + 16.0, "start", "#222222", panel_.heading,
              "font-size=\"14\" font-weight=\"bold\"");
        grid();
        legend();
        front();
        for (const std::string& family : families_) {
            series(family);
        }
        labels();
        return svg_;
    }

private:
    [[nodiscard]] Axis axis(double PlotPoint::*value, double from, double upto) const {
        const auto [low, high] =
            std::minmax_element(points_.begin(), points_.end(),
                                [value](const auto& a, const auto& b) { return a.*value < b.*value; });
        return {(*low).*value, (*high).*value, from, upto};
    }

    void write(double x, double y, const char* anchor, const char* colour, const std::string& text,
               const std::string& more = "") {
        svg_ += written(x, y, anchor, colour, text, more);
    }
    void line(double x0, double y0, double x1, double y1, const char* colour, double thickness) {
        svg_ += fmt::format("<line x1=\"{:.1f}\" y1=\"{:.1f}\" x2=\"{:.1f}\" y2=\"{:.1f}\" stroke=\"{}\" "
                            "stroke-width=\"{}\"/>\n",
                            x0, y0, x1, y1, colour, thickness);
    }
    [[nodiscard]] const char* colour_of(const std::string& family) const {
        const auto at = std::find(families_.begin(), families_.end(), family) - families_.begin();
        return colours[static_cast<std::size_t>(at) % colours.size()];
    }

    void grid() {
        for (const Axis::Tick& tick : x_.ticks()) {
            const double x = x_.at(tick.value);
            line(x, top_, x, bottom_, tick.labelled ? "#d9d9d9" : "#f1f1f1", 1.0);
            if (tick.labelled) {
                write(x, bottom_ + 18.0, "middle", "#444444", fmt::format("{:g}", tick.value));
            }
        }
        for (const Axis::Tick& tick : y_.ticks()) {
            const double y = y_.at(tick.value);
            line(left, y, right, y, tick.labelled ? "#d9d9d9" : "#f1f1f1", 1.0);
            if (tick.labelled) {
                write(left - 8.0, y + 4.0, "end", "#444444",
                      panel_.percent ? fmt::format("{:g} %", 100.0 * tick.value)
                                     : fmt::format("{:.0e}", tick.value));
            }
        }
        svg_ += fmt::format("<rect x=\"{}\" y=\"{}\" width=\"{}\" height=\"{}\" fill=\"none\" "
                            "stroke=\"#888888\"/>\n",
                            left, top_, right - left, bottom_ - top_);
        write((left + right) / 2, bottom_ + 42.0, "middle", "#222222", panel_.seconds_name);
        write(0.0, 0.0, "middle", "#222222", panel_.error_name,
              fmt::format("transform=\"translate(20 {:.1f}) rotate(-90)\"", (top_ + bottom_) / 2));
    }

    void legend() {
        double x = left;
        double y = from_top_ + 40.0;
        const auto make_room = [&](double needed) { // on a second line, where the first is full
            if (x > left && x + needed > right) {
                x = left;
                y += 18.0;
            }
        };
        for (const std::string& family : families_) {
            make_room(15.0 + text_width(family));
            svg_ += fmt::format("<circle cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"{}\" fill=\"{}\"/>\n", x + 5.0,
                                y - 4.0, marker, colour_of(family));
            write(x + 15.0, y, "start", "#222222", family);
            x += 15.0 + text_width(family) + 12.0;
        }
        const std::string best = "the best for their time";
        make_room(28.0 + text_width(best));
        line(x, y - 4.0, x + 22.0, y - 4.0, "#bbbbbb", 5.0);
        write(x + 28.0, y, "start", "#222222", best);
    }

    void front() {
        std::vector<const PlotPoint*> best;
        for (const PlotPoint& point : points_) {
            if (point.front) {
                best.push_back(&point);
            }
        }
        std::sort(best.begin(), best.end(),
                  [](const auto* a, const auto* b) { return a->seconds < b->seconds; });
        if (best.empty()) {
            return;
        }
        std::string path = fmt::format("M{:.1f} {:.1f}", x_.at(best.front()->seconds), top_);
        for (const PlotPoint* point : best) {
            path += fmt::format(" H{:.1f} V{:.1f}", x_.at(point->seconds), y_.at(point->error));
        }
        path += fmt::format(" H{:.1f}", right);
        svg_ += fmt::format("<path d=\"{}\" fill=\"none\" stroke=\"#bbbbbb\" stroke-width=\"5\" "
                            "stroke-opacity=\"0.6\"/>\n",
                            path);
    }

    void series(const std::string& family) {
        std::string path;
        std::string circles;
        for (const PlotPoint& point : points_) {
            if (point.family == family) {
                const double x = x_.at(point.seconds);
                const double y = y_.at(point.error);
                path += fmt::format("{}{:.1f} {:.1f}", path.empty() || !point.joined ? " M" : " L", x, y);
                circles += fmt::format("<circle cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"{}\" fill=\"{}\" "
                                       "stroke=\"#ffffff\" stroke-width=\"0.8\"/>\n",
                                       x, y, marker, colour_of(family));
            }
        }
        svg_ += fmt::format("<path d=\"{}\" fill=\"none\" stroke=\"{}\" stroke-opacity=\"0.45\"/>\n", path,
                            colour_of(family));
        svg_ += circles;
    }

    /// Each where it covers least; away from its point, with a line to it, where there is no room beside it.
    void labels() {
        for (const PlotPoint& point : points_) {
            if (point.label.empty()) {
                continue;
            }
            const double x = x_.at(point.seconds);
            const double y = y_.at(point.error);
            const double long_side = text_width(point.label);
            Box best{};
            double least = 1e300;
            double best_reach = 0.0;
            for (const double reach : {8.0, 20.0, 34.0, 50.0, 70.0}) {
                for (int direction = 0; direction < 16; ++direction) {
                    const double angle = direction * 0.39269908169872414;
                    // The box touches the circle of this reach with the side or corner that faces the point.
                    const double cx = x + std::cos(angle) * (reach + 0.5 * long_side);
                    const double cy = y - std::sin(angle) * (reach + 0.5 * text_size);
                    const Box box{cx - 0.5 * long_side, cy - 0.5 * text_size - 1.0, cx + 0.5 * long_side,
                                  cy + 0.5 * text_size + 1.0};
                    double cost = 0.4 * reach + 0.01 * direction;
                    for (const Box& other : taken_) {
                        cost += 20.0 * box.overlap(other);
                    }
                    const Box frame{left + 2.0, top_ + 2.0, right - 2.0, bottom_ - 2.0};
                    const double inside = box.overlap(frame);
                    cost += 20.0 * ((box.x1 - box.x0) * (box.y1 - box.y0) - inside);
                    if (cost < least) {
                        least = cost;
                        best = box;
                        best_reach = reach;
                    }
                }
            }
            taken_.push_back(best);
            const double cx = 0.5 * (best.x0 + best.x1);
            const double cy = 0.5 * (best.y0 + best.y1);
            if (best_reach > 20.0) {
                line(x, y, std::clamp(x, best.x0, best.x1), std::clamp(y, best.y0, best.y1), "#aaaaaa", 0.7);
            }
            const std::string halo = "stroke=\"#ffffff\" stroke-width=\"3\" paint-order=\"stroke\"";
            write(cx, cy + 0.36 * text_size, "middle", colour_of(point.family), point.label,
                  halo + (point.front ? " font-weight=\"bold\"" : ""));
        }
    }

    const PlotPanel& panel_;
    const std::vector<PlotPoint>& points_;
    double from_top_, top_, bottom_;
    Axis x_, y_;
    std::vector<std::string> families_;
    std::vector<Box> taken_;
    std::string svg_;
};

} // namespace

std::string trade_plot(const std::string& title, const std::vector<PlotPanel>& panels) {
    if (panels.empty()) {
        throw InvalidArgument("there is nothing to draw");
    }
    const double height = title_height + panel_height * static_cast<double>(panels.size());
    std::string svg =
        fmt::format("<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {0} {1}\" width=\"{0}\" "
                    "height=\"{1}\" font-family=\"Helvetica, Arial, sans-serif\" font-size=\"{2}\">\n"
                    "<rect width=\"100%\" height=\"100%\" fill=\"#ffffff\"/>\n",
                    width, height, text_size);
    svg += written(left, 26.0, "start", "#222222", shortened(title), "font-size=\"16\" font-weight=\"bold\"");
    double from_top = title_height;
    for (const PlotPanel& panel : panels) {
        if (panel.points.empty()) {
            throw InvalidArgument(fmt::format("{}: there is nothing to draw", panel.heading));
        }
        for (const PlotPoint& point : panel.points) {
            if (!(point.seconds > 0.0) || !(point.error > 0.0) || !std::isfinite(point.seconds) ||
                !std::isfinite(point.error)) {
                throw InvalidArgument(
                    fmt::format("{}: {} s with an error of {} has no place on logarithmic axes", point.label,
                                point.seconds, point.error));
            }
        }
        svg += Panel(panel, from_top).text();
        from_top += panel_height;
    }
    return svg + "</svg>\n";
}

} // namespace hemi::cli
