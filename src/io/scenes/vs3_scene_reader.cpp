#include "hemi/core/error.hpp"
#include "hemi/core/nearest_word.hpp"
#include "hemi/io/output_file.hpp"
#include "hemi/io/scene_reader.hpp"
#include "io/formats/text_scan.hpp"
#include "io/meshes/face_mender.hpp"
#include "io/scenes/sides.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <map>
#include <unordered_map>
#include <utility>

namespace hemi::io {

namespace {

constexpr double least_emissivity = 0.001; // View3D's own; 0 would be a reflectance of 1

/// The words of a line up to its comment: "!" anywhere, "/" where a word begins.
class Words {
public:
    explicit Words(std::string_view line) : rest_(line.substr(0, line.find('!'))) {}

    std::string_view next() {
        const std::string_view word = next_word(rest_);
        if (word.starts_with('/')) {
            rest_ = {};
            return {};
        }
        return word;
    }
    [[nodiscard]] std::string_view rest() const { return trim(rest_); }

private:
    std::string_view rest_;
};

class Vs3Reader {
public:
    Vs3Reader(const std::filesystem::path& path, const SceneReaderOptions& options, Diagnostics& diagnostics)
        : file_(path.string()), text_(read_text(path)), lines_(text_), options_(options),
          diagnostics_(diagnostics), mender_(options, "surface") {
        scene_.name = to_utf8(path.stem().string());
        scene_.environment = {0.0};
    }

    Scene read() {
        std::string_view line;
        while (!ended_ && lines_.next(line)) {
            read_line(line);
        }
        if (numbered_ == 0) {
            throw InputError(fmt::format("{}: no surfaces; a scene needs at least one (S lines)", file_));
        }
        cut_out_subsurfaces();
        for (const Numbered& numbered : numbered_surfaces_) {
            add(numbered);
        }
        mender_.tell(file_, diagnostics_);
        set_sides(scene_, options_, file_, diagnostics_);
        return std::move(scene_);
    }

private:
    void read_line(std::string_view line) {
        Words words(line);
        const std::string_view word = words.next();
        if (word.empty()) {
            return;
        }
        const auto first = static_cast<char>(std::toupper(static_cast<unsigned char>(word[0])));
        // Titles and ends may be words; all other lines begin with a single letter.
        const bool known = word.size() == 1 || first == 'E' || first == '*' || first == 'T';
        const char letter = known ? first : '\0';
        if (letter == 'E' || letter == '*') {
            ended_ = true;
        } else if (letter == 'T') {
            read_title(line);
        } else if (letter == 'V') {
            read_vertex(words);
        } else if (letter == 'S') {
            read_surface(words);
        } else if (letter == 'O') {
            read_obstruction(words);
        } else if (letter == 'C') {
            read_control(words);
        } else if (letter == 'F') {
            read_format(words);
        } else {
            refuse(word);
        }
    }

    [[noreturn]] void refuse(std::string_view word) const {
        static const std::map<std::string_view, const char*> unsupported{
            {"M", "masking surfaces"}, {"N", "null surfaces"}, {"X", "coordinate transformations"}};
        std::string upper(word);
        upper[0] = static_cast<char>(std::toupper(static_cast<unsigned char>(upper[0])));
        if (const auto found = unsupported.find(upper); found != unsupported.end()) {
            fail(fmt::format("{}: {} are not supported; cut the base surface around them instead", word,
                             found->second));
        }
        fail(fmt::format("{}; a line begins with T, C, F, V, S, O, E or ! (a comment)", in_quotes(word)));
    }

    void read_title(std::string_view line) {
        std::string_view rest = line;
        (void)next_word(rest);
        if (!trim(rest).empty()) {
            scene_.name = to_utf8(trim(rest));
        }
    }

    void read_format(Words& words) const {
        const std::string_view format = words.next();
        if (format != "3") {
            fail(fmt::format("F {}; must be 3 (vertices and surfaces), the one format that is supported",
                             in_quotes(format)));
        }
    }

    void read_vertex(Words& words) {
        check_number(words, "vertex", vertices_.size());
        Vec3 point(0.0);
        for (int axis = 0; axis < 3; ++axis) {
            const std::string_view word = words.next();
            const auto value = parse_number(word);
            if (!value) {
                fail(fmt::format("vertex {}: {} {}; must be a number", vertices_.size() + 1, "xyz"[axis],
                                 in_quotes(word)));
            }
            point[axis] = *value;
        }
        vertices_.push_back(point);
    }

    void read_surface(Words& words) {
        if (obstructions_) {
            fail("S after the first O; obstructions must come last");
        }
        Surface surface = read_polygon(words, "surface");
        const std::uint64_t base = whole(words, "base");
        const std::uint64_t combined = whole(words, "cmb");
        surface.material = material(words.next());
        const std::string_view name = words.next();
        if (!words.rest().empty() && !words.rest().starts_with('/') && !warned_of_name_) {
            warned_of_name_ = true;
            diagnostics_.warn(fmt::format("{}:{}: {} after the name is not used; a name is one word", file_,
                                          lines_.number(), in_quotes(words.rest())));
        }
        surface.group = combined != 0  ? combined_group(combined)
                        : name.empty() ? group(fmt::format("surface_{}", numbered_))
                                       : group(to_utf8(name));
        groups_.push_back(surface.group);
        is_combined_.push_back(combined != 0);
        numbered_surfaces_.push_back({surface, "surface", lines_.number(), base, {}});
    }

    /// Two-sided, so that what meets it from either side counts as arrived and not as blocked by a back.
    void read_obstruction(Words& words) {
        obstructions_ = true;
        Surface surface = read_polygon(words, "obstruction");
        surface.two_sided = true;
        surface.material = material_index({"obstruction", {0.0}, {0.0}});
        surface.group = group("obstruction");
        numbered_surfaces_.push_back({surface, "obstruction", lines_.number(), 0, {}});
    }

    Surface read_polygon(Words& words, std::string_view kind) {
        check_number(words, kind, numbered_);
        ++numbered_;
        Surface surface;
        for (std::uint32_t corner = 0; corner < 4; ++corner) {
            const std::string_view word = words.next();
            const auto index = parse_integer<std::uint64_t>(word);
            if (corner == 3 && index == std::uint64_t{0}) {
                surface.vertex_count = 3;
                break;
            }
            if (!index || *index == 0 || *index > vertices_.size()) {
                fail(fmt::format("{} {}: vertex {} of 4 is {}; must be from 1 to {}, the vertices above{}",
                                 kind, numbered_, corner + 1, in_quotes(word), vertices_.size(),
                                 corner == 3 ? ", or 0 for a triangle" : ""));
            }
            surface.vertices[corner] = vertices_[*index - 1];
        }
        return surface;
    }

    /// A line S or O; the index is its number less one.
    struct Numbered {
        Surface surface;
        const char* kind;
        std::size_t line;
        std::uint64_t base;                   ///< number of the surface that it is cut out of; 0: none
        std::vector<std::vector<Vec3>> holes; ///< what is cut out of it
    };

    void cut_out_subsurfaces() {
        for (std::size_t k = 0; k < numbered_surfaces_.size(); ++k) {
            const Numbered& part = numbered_surfaces_[k];
            if (part.base == 0) {
                continue;
            }
            if (part.base > groups_.size() || part.base == k + 1) {
                fail(part, k,
                     fmt::format("base {}; must be the number of another surface, from 1 to {}", part.base,
                                 groups_.size()));
            }
            const std::span<const Vec3> outline = part.surface.polygon();
            numbered_surfaces_[part.base - 1].holes.emplace_back(outline.begin(), outline.end());
        }
    }

    [[noreturn]] void fail(const Numbered& part, std::size_t index, const std::string& message) const {
        throw ParseError(file_, part.line, 0, fmt::format("{} {}: {}", part.kind, index + 1, message));
    }

    void add(const Numbered& numbered) {
        const Surface& surface = numbered.surface;
        const auto defect = mender_.mend(surface.polygon(), numbered.holes, [&numbered] {
            return FaceSpot{numbered.line, {}};
        });
        if (defect) {
            fail(numbered, static_cast<std::size_t>(&numbered - numbered_surfaces_.data()), *defect);
        }
        for (const PolygonPiece& piece : mender_.pieces()) {
            Surface part = surface;
            part.vertices = piece.points;
            part.vertex_count = piece.count;
            part.continues = &piece != mender_.pieces().data();
            scene_.surfaces.push_back(part);
        }
    }

    std::uint32_t combined_group(std::uint64_t with) const {
        if (with >= numbered_) {
            fail(
                fmt::format("surface {}: cmb {}; must be the number of an earlier surface", numbered_, with));
        }
        if (is_combined_[with - 1]) {
            fail(fmt::format("surface {}: cmb {}, which is itself combined with another; name that one",
                             numbered_, with));
        }
        return groups_[with - 1];
    }

    std::uint32_t material(std::string_view word) {
        const auto emissivity = parse_number(word);
        if (!emissivity || !(*emissivity >= 0.0 && *emissivity <= 1.0)) {
            fail(fmt::format("surface {}: emissivity {}; must be a number from 0 to 1", numbered_,
                             in_quotes(word)));
        }
        if (*emissivity < least_emissivity && !warned_of_emissivity_) {
            warned_of_emissivity_ = true;
            diagnostics_.warn(fmt::format("{}:{}: emissivity {} taken as {}, as View3D does", file_,
                                          lines_.number(), *emissivity, least_emissivity));
        }
        const double used = std::max(*emissivity, least_emissivity);
        return material_index({fmt::format("emissivity {}", used), {1.0 - used}, {0.0}});
    }

    std::uint32_t material_index(Material material) {
        const auto [entry, is_new] =
            materials_.emplace(material.name, static_cast<std::uint32_t>(materials_.size()));
        if (is_new) {
            scene_.materials.push_back(std::move(material));
        }
        return entry->second;
    }

    std::uint32_t group(const std::string& name) {
        const auto [entry, is_new] =
            group_indices_.emplace(name, static_cast<std::uint32_t>(scene_.groups.size()));
        if (is_new) {
            scene_.groups.push_back(name);
        }
        return entry->second;
    }

    void read_control(const Words& words) {
        std::string text(words.rest());
        std::replace_if(
            text.begin(), text.end(), [](char c) { return c == '=' || c == ','; }, ' ');
        std::string_view rest = text;
        for (std::string_view name = next_word(rest); !name.empty(); name = next_word(rest)) {
            const std::string_view word = next_word(rest);
            const auto value = parse_number(word);
            if (!value) {
                fail(fmt::format("{} = {}; must be a number", name, in_quotes(word)));
            }
            apply_control(name, *value);
        }
    }

    void apply_control(std::string_view name, double value) {
        static const std::vector<std::string> known{"eps",  "maxU", "maxO", "minO", "row",  "col",
                                                    "encl", "emit", "out",  "list", "prjD", "maxV"};
        const auto same = [](std::string_view a, std::string_view b) {
            return std::equal(a.begin(), a.end(), b.begin(), b.end(), [](unsigned char x, unsigned char y) {
                return std::tolower(x) == std::tolower(y);
            });
        };
        if (std::none_of(known.begin(), known.end(), [&](const auto& word) { return same(word, name); })) {
            diagnostics_.warn(fmt::format("{}:{}: the control word {} is not known and not used{}", file_,
                                          lines_.number(), in_quotes(name), did_you_mean(name, known)));
        }
        if (same(name, "encl")) {
            scene_.enclosure = value != 0.0 ? Enclosure::closed : Enclosure::open;
        } else if (same(name, "emit") && value != 0.0) {
            diagnostics_.warn(
                fmt::format("{}:{}: emit = {} asks for exchange factors, which include reflection: "
                            "`hemi exchange` has them (-o FILE.txt); form factors are without it",
                            file_, lines_.number(), value));
        } else if ((same(name, "row") || same(name, "col")) && value != 0.0) {
            diagnostics_.warn(fmt::format("{}:{}: {} = {} is not used: all rows count", file_,
                                          lines_.number(), name, value));
        }
    }

    /// View3D's numbers are there to be checked: they must count up from 1.
    void check_number(Words& words, std::string_view kind, std::size_t before) const {
        const std::string_view word = words.next();
        if (parse_integer<std::uint64_t>(word) != before + 1) {
            fail(fmt::format("{} number {}; must be {}, the next one", kind, in_quotes(word), before + 1));
        }
    }

    std::uint64_t whole(Words& words, std::string_view field) const {
        const std::string_view word = words.next();
        const auto value = parse_integer<std::uint64_t>(word);
        if (!value) {
            fail(fmt::format("surface {}: {} {}; must be a whole number (S # v1 v2 v3 v4 base cmb emit name)",
                             numbered_, field, in_quotes(word)));
        }
        return *value;
    }

    [[noreturn]] void fail(const std::string& message) const {
        throw ParseError(file_, lines_.number(), 0, message);
    }

    std::string file_;
    std::string text_;
    Lines lines_;
    const SceneReaderOptions& options_;
    Diagnostics& diagnostics_;
    FaceMender mender_;
    Scene scene_;
    std::vector<Vec3> vertices_;
    std::vector<std::uint32_t> groups_; ///< of every S
    std::vector<bool> is_combined_;     ///< for every S
    std::vector<Numbered> numbered_surfaces_;
    std::unordered_map<std::string, std::uint32_t> materials_;
    std::unordered_map<std::string, std::uint32_t> group_indices_;
    std::size_t numbered_ = 0; ///< S and O so far
    bool obstructions_ = false;
    bool ended_ = false;
    bool warned_of_name_ = false;
    bool warned_of_emissivity_ = false;
};

} // namespace

Scene read_vs3_scene(const std::filesystem::path& path, const SceneReaderOptions& options,
                     Diagnostics& diagnostics) {
    return Vs3Reader(path, options, diagnostics).read();
}

} // namespace hemi::io
