#include "display/legend.hpp"

#include <fmt/format.h>
#include <stb_easy_font.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstring>

namespace hemi {

namespace {

using Colour = std::array<std::uint8_t, 3>;

constexpr Colour ground{22, 24, 26};
constexpr Colour ink{235, 235, 235};
constexpr int line_height = 12; // of the font, pixels before scaling
constexpr int raised = 2;
constexpr std::uint32_t least_width = 200; // of a picture with a legend, pixels
constexpr std::uint32_t least_height = 160;
constexpr std::uint32_t scale_height = 400; // of a picture for each step of its size
// Of the legend, pixels before scaling.
constexpr int legend_margin = 6;
constexpr int legend_pad = 6;
constexpr int legend_height = 2 * legend_pad + 2 * line_height + 14;

/// How much larger than in a small picture it is drawn.
int scale_of_height(std::uint32_t height) {
    return std::max(1, static_cast<int>(height / scale_height));
}

/// A piece of a text: what the font has, or a raised letter in place of what it has not.
struct Run {
    std::string text;
    bool small = false;
};

std::vector<Run> runs_of(std::string_view text) {
    constexpr std::string_view squared = "²";
    constexpr std::string_view degree = "°";
    std::vector<Run> runs;
    while (!text.empty()) {
        if (text.starts_with(squared) || text.starts_with(degree)) {
            runs.push_back({text.starts_with(squared) ? "2" : "o", true});
            text.remove_prefix(squared.size());
            continue;
        }
        if (runs.empty() || runs.back().small) {
            runs.emplace_back();
        }
        runs.back().text += text.front();
        text.remove_prefix(1);
    }
    return runs;
}

class Canvas {
public:
    explicit Canvas(Picture& picture) : picture_(picture), scale_(scale_of_height(picture.height)) {}

    [[nodiscard]] int scale() const { return scale_; }

    void fill(int left, int top, int right, int bottom, const Colour& colour) {
        const int width = static_cast<int>(picture_.width);
        const int height = static_cast<int>(picture_.height);
        for (int y = std::max(top, 0); y < std::min(bottom, height); ++y) {
            for (int x = std::max(left, 0); x < std::min(right, width); ++x) {
                const auto at =
                    (static_cast<std::size_t>(y) * picture_.width + static_cast<std::size_t>(x)) * 3;
                std::copy(colour.begin(), colour.end(),
                          picture_.srgb.begin() + static_cast<std::ptrdiff_t>(at));
            }
        }
    }

    [[nodiscard]] int width_of(std::string_view text) const {
        int width = 0;
        for (Run& run : runs_of(text)) {
            width += stb_easy_font_width(run.text.data()) * scale_of(run);
        }
        return width;
    }

    void text(int left, int top, std::string_view text) {
        for (Run& run : runs_of(text)) {
            const int scale = scale_of(run);
            print(left, run.small ? top - (scale == scale_ ? raised * scale : 0) : top, run.text, scale);
            left += stb_easy_font_width(run.text.data()) * scale;
        }
    }

private:
    [[nodiscard]] int scale_of(const Run& run) const { return run.small ? (scale_ + 1) / 2 : scale_; }

    /// The font is made of rectangles: four corners of three floats and a colour each.
    void print(int left, int top, std::string& text, int scale) {
        constexpr std::size_t corner_bytes = 16;
        std::vector<char> bytes((text.size() + 1) * 16 * 4 * corner_bytes); // no letter has 16 rectangles
        const int quads = stb_easy_font_print(0.0F, 0.0F, text.data(), nullptr, bytes.data(),
                                              static_cast<int>(bytes.size()));
        for (int quad = 0; quad < quads; ++quad) {
            std::array<float, 2> first{};
            std::array<float, 2> last{};
            const char* const start = bytes.data() + static_cast<std::size_t>(quad) * 4 * corner_bytes;
            std::memcpy(first.data(), start, sizeof(first));
            std::memcpy(last.data(), start + 2 * corner_bytes, sizeof(last));
            const auto pixel = [scale](float value) { return static_cast<int>(std::lround(value)) * scale; };
            fill(left + pixel(first[0]), top + pixel(first[1]), left + pixel(last[0]), top + pixel(last[1]),
                 ink);
        }
    }

    Picture& picture_;
    int scale_;
};

/// Every few of them, from the first on.
std::vector<double> every_few(const std::vector<double>& values, std::size_t every) {
    std::vector<double> few;
    for (std::size_t k = 0; k < values.size(); k += every) {
        few.push_back(values[k]);
    }
    return few;
}

} // namespace

std::uint8_t srgb_of(float linear) {
    const float srgb =
        linear <= 0.0031308F ? 12.92F * linear : 1.055F * std::pow(linear, 1.0F / 2.4F) - 0.055F;
    return static_cast<std::uint8_t>(std::lround(255.0F * std::clamp(srgb, 0.0F, 1.0F)));
}

std::string level_text(double level, const std::vector<double>& marks) {
    constexpr int most_decimals = 6;
    double step = std::abs(level);
    for (std::size_t k = 1; k < marks.size(); ++k) {
        step = k == 1 ? marks[k] - marks[k - 1] : std::min(step, marks[k] - marks[k - 1]);
    }
    const double largest = std::max(std::abs(marks.front()), std::abs(marks.back()));
    const int decimals = step > 0.0 ? 1 - static_cast<int>(std::floor(std::log10(step) + 1e-9)) : 0;
    if (largest >= 1e7 || decimals > most_decimals) {
        return fmt::format("{:.3g}", level);
    }
    std::string words = fmt::format("{:.{}f}", level, std::max(decimals, 0));
    if (words.find('.') != std::string::npos) {
        words.erase(words.find_last_not_of('0') + 1);
        words.erase(words.find_last_not_of('.') + 1);
    }
    return words == "-0" ? "0" : words;
}

bool is_dark_colour(const std::array<float, 3>& linear) {
    constexpr float dark = 0.12F;
    return 0.2126F * linear[0] + 0.7152F * linear[1] + 0.0722F * linear[2] < dark;
}

std::string mark_text(double mark, const std::vector<double>& marks) {
    const double step = marks.size() > 1 ? marks[1] - marks[0] : std::abs(mark);
    const double largest = std::max(std::abs(marks.front()), std::abs(marks.back()));
    if (largest >= 1e7 || (largest > 0.0 && step < 1e-4)) {
        return fmt::format("{:.3g}", mark);
    }
    const int decimals =
        step > 0.0 ? std::clamp(-static_cast<int>(std::floor(std::log10(step) + 1e-9)), 0, 6) : 0;
    return fmt::format("{:.{}f}", mark, decimals);
}

bool draw_legend(Picture& picture, const ColourScale& scale, std::string_view title,
                 const std::array<bool, 2>& beyond, std::uint32_t below) {
    const int width = static_cast<int>(picture.width);
    if (picture.width < least_width || picture.height < least_height * (below + 1)) {
        return false;
    }
    Canvas canvas(picture);
    const int s = canvas.scale();
    const int margin = legend_margin * s;
    const int pad = legend_pad * s;
    const int height =
        static_cast<int>(picture.height) - static_cast<int>(below) * (legend_height + legend_margin) * s;
    const int box_width = std::min(std::max(220 * s, canvas.width_of(title) + 2 * pad), width - 2 * margin);
    const int box_height = legend_height * s;
    const int left = margin;
    const int top = height - margin - box_height;
    canvas.fill(left, top, left + box_width, top + box_height, ground);
    canvas.text(left + pad, top + pad, title);
    const int bar_left = left + pad + 14 * s;
    const int bar_right = left + box_width - pad - 20 * s;
    const int bar_top = top + pad + line_height * s + s;
    const int bar_bottom = bar_top + 8 * s;
    for (int x = bar_left; x < bar_right; ++x) {
        const std::array<float, 3> linear =
            scale.colour_at((x + 0.5 - bar_left) / static_cast<double>(bar_right - bar_left));
        canvas.fill(x, bar_top, x + 1, bar_bottom,
                    {srgb_of(linear[0]), srgb_of(linear[1]), srgb_of(linear[2])});
    }
    if (beyond[0]) {
        canvas.text(bar_left - 9 * s, bar_top, "<");
    }
    if (beyond[1]) {
        canvas.text(bar_right + 3 * s, bar_top, ">");
    }
    const auto place = [&](double mark) {
        return bar_left + static_cast<int>(std::lround(scale.position(mark) * (bar_right - bar_left - 1)));
    };
    const bool of_levels = scale.bands > 1 || scale.lines;
    const std::vector<double> levels = of_levels ? scale.marks() : std::vector<double>();
    std::vector<double> marks;
    const auto words_of = [&](double mark) {
        return of_levels ? level_text(mark, levels)
                         : (scale.logarithmic ? fmt::format("{:.3g}", mark) : mark_text(mark, marks));
    };
    // Words of the ends of bands stay in the box.
    const auto text_left = [&](double mark) {
        const int width_of_words = canvas.width_of(words_of(mark));
        const int from = place(mark) - width_of_words / 2;
        return of_levels ? std::clamp(from, left + 2 * s,
                                      std::max(left + 2 * s, left + box_width - 2 * s - width_of_words))
                         : from;
    };
    const auto is_crowded = [&] {
        int free_from = left;
        for (const double mark : marks) {
            if (text_left(mark) < free_from) {
                return true;
            }
            free_from = text_left(mark) + canvas.width_of(words_of(mark)) + 4 * s;
        }
        return free_from > left + box_width + 4 * s;
    };
    for (std::size_t every = 1; every <= levels.size() && (marks.empty() || is_crowded()); ++every) {
        marks = every_few(levels, every);
    }
    for (const double level : levels) {
        const bool line = scale.lines && level > scale.low && level < scale.high;
        const std::array<std::uint8_t, 3> colour =
            line && is_dark_colour(scale.colour_at(scale.position(level))) ? ink : ground;
        canvas.fill(place(level), line ? bar_top : bar_bottom, place(level) + s,
                    bar_bottom + (line ? 0 : 2 * s), line ? colour : ink);
    }
    for (std::size_t most = 8; !of_levels && most > 0 && (marks.empty() || is_crowded()); --most) {
        marks = scale.logarithmic ? decade_marks(scale.low, scale.high, most)
                                  : round_marks(scale.low, scale.high, most);
    }
    for (const double mark : marks) {
        canvas.fill(place(mark), bar_bottom, place(mark) + s, bar_bottom + 3 * s, ink);
        const std::string words = words_of(mark);
        canvas.text(text_left(mark), bar_bottom + 5 * s, words);
    }
    return true;
}

bool draw_key(Picture& picture, std::string_view title, std::span<const KeyLine> lines) {
    Canvas canvas(picture);
    const int s = canvas.scale();
    const int pad = legend_pad * s;
    const int step = line_height * s;
    const int left = legend_margin * s;
    const int box_height = 2 * pad + step * static_cast<int>(lines.size() + 1);
    const int top = static_cast<int>(picture.height) - left - box_height;
    int box_width = canvas.width_of(title) + 2 * pad;
    for (const KeyLine& line : lines) {
        box_width = std::max(box_width, canvas.width_of(line.words) + step + 2 * pad);
    }
    if (picture.width < least_width || picture.height < least_height || top < 0 ||
        box_width > static_cast<int>(picture.width) - 2 * left) {
        return false;
    }
    canvas.fill(left, top, left + box_width, top + box_height, ground);
    canvas.text(left + pad, top + pad, title);
    int at = top + pad + step;
    for (const KeyLine& line : lines) {
        canvas.fill(left + pad, at, left + pad + 8 * s, at + 8 * s,
                    {srgb_of(line.colour[0]), srgb_of(line.colour[1]), srgb_of(line.colour[2])});
        canvas.text(left + pad + step, at, line.words);
        at += step;
    }
    return true;
}

Picture legend_strip(std::uint32_t width, const ColourScale& scale, std::string_view title,
                     const std::array<bool, 2>& beyond) {
    constexpr std::uint32_t box_width = 320; // of a title of 40 letters
    constexpr std::uint8_t paper = 255;
    const std::uint32_t s = std::clamp(width / box_width, 1u, 2u);
    Picture picture;
    picture.width = std::max(width, box_width);
    picture.height = s * scale_height;
    picture.srgb.assign(std::size_t{picture.width} * picture.height * 3, paper);
    draw_legend(picture, scale, title, beyond);
    const std::uint32_t height = s * static_cast<std::uint32_t>(legend_height + 2 * legend_margin);
    picture.srgb.erase(picture.srgb.begin(), picture.srgb.end() - std::ptrdiff_t{height} * picture.width * 3);
    picture.height = height;
    return picture;
}

} // namespace hemi
