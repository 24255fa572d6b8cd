#include "io/scenes/mtl_reader.hpp"

#include "hemi/core/error.hpp"
#include "hemi/io/output_file.hpp"
#include "io/formats/text_scan.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace hemi::io {

namespace {

// Own code rather than the OBJ loader's: that one rounds 0.7 to 0.7000000000000001, takes "Kd 0.5" (which
// stands for all three) as 0.5 0 0, and any word for 0.
class MtlReader {
public:
    MtlReader(const std::filesystem::path& path, Diagnostics& diagnostics)
        : file_(path.string()), text_(read_text(path)), lines_(text_), diagnostics_(diagnostics) {}

    std::vector<MtlMaterial> read() {
        std::string_view line;
        while (lines_.next(line)) {
            std::string_view rest = line;
            read_line(next_word(rest), rest);
        }
        return std::move(materials_);
    }

private:
    void read_line(std::string_view word, std::string_view rest) {
        if (word == "newmtl") {
            start(trim(rest));
        } else if (word == "Kd" || word == "Ke") {
            if (materials_.empty()) {
                fail(fmt::format("{} before the first newmtl", word));
            }
            (word == "Kd" ? materials_.back().reflectance : materials_.back().exitance) = colour(word, rest);
        } else if ((word == "map_Kd" || word == "map_Ke") && !warned_) {
            warned_ = true;
            diagnostics_.warn(
                fmt::format("{}:{}: textures are not used; Kd and Ke count", file_, lines_.number()));
        }
    }

    void start(std::string_view name) {
        if (name.empty()) {
            fail("newmtl without a name");
        }
        materials_.push_back({to_utf8(name), {}, {}, fmt::format("{}:{}", file_, lines_.number())});
    }

    std::array<double, 3> colour(std::string_view key, std::string_view rest) const {
        std::array<double, 3> values{};
        std::size_t count = 0;
        for (std::string_view word = next_word(rest); !word.empty() && word[0] != '#';
             word = next_word(rest)) {
            const auto value = parse_number(word);
            if (!value || count == 3) {
                fail(fmt::format("{} after {}; must be one or three numbers", in_quotes(word), key));
            }
            values[count++] = *value;
        }
        if (count != 1 && count != 3) {
            fail(fmt::format("{} with {} numbers; must be one or three", key, count));
        }
        if (count == 1) {
            values.fill(values[0]);
        }
        return values;
    }

    [[noreturn]] void fail(const std::string& message) const {
        throw ParseError(file_, lines_.number(), 0, message);
    }

    std::string file_;
    std::string text_;
    Lines lines_;
    Diagnostics& diagnostics_;
    std::vector<MtlMaterial> materials_;
    bool warned_ = false;
};

} // namespace

void read_mtl(const std::filesystem::path& path, std::vector<MtlMaterial>& materials,
              Diagnostics& diagnostics) {
    for (MtlMaterial& material : MtlReader(path, diagnostics).read()) {
        const auto same = std::find_if(materials.begin(), materials.end(),
                                       [&](const MtlMaterial& other) { return other.name == material.name; });
        if (same == materials.end()) {
            materials.push_back(std::move(material));
        } else if (!same->same_values(material)) {
            throw InputError(
                fmt::format("{}: material \"{}\" has other values than at {}; a name stands for one material",
                            material.place, material.name, same->place));
        }
    }
}

bool limit_reflectance(MtlMaterial& material) {
    bool limited = false;
    for (double& value : material.reflectance) {
        limited = limited || value == 1.0;
        value = value == 1.0 ? most_reflectance : value;
    }
    return limited;
}

void check_range(const MtlMaterial& material) {
    for (const double value : material.reflectance) {
        if (!(value >= 0.0 && value < 1.0)) {
            throw InputError(
                fmt::format("{}: material \"{}\": Kd {}; a reflectance must be at least 0 and below 1 "
                            "(no surface reflects all it receives; 0.99 is a very good mirror)",
                            material.place, material.name, value));
        }
    }
    for (const double value : material.exitance) {
        if (!(value >= 0.0)) {
            throw InputError(fmt::format("{}: material \"{}\": Ke {}; an exitance must not be negative",
                                         material.place, material.name, value));
        }
    }
}

} // namespace hemi::io
