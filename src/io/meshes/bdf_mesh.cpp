#include "hemi/core/error.hpp"
#include "hemi/core/text.hpp"
#include "io/formats/text_scan.hpp"
#include "io/meshes/face_builder.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <deque>
#include <map>
#include <optional>
#include <utility>

namespace hemi::io {

namespace {

constexpr std::size_t name_width = 8;
constexpr std::size_t most_fields =
    24; // of a card, its continuations with it: more than any that is read has

struct BdfElementType {
    std::string_view name;
    std::uint32_t corners;
    bool curved;
};

/// Shells; the first nodes of each are its corners.
constexpr std::array bdf_element_types{BdfElementType{"CTRIA3", 3, false}, BdfElementType{"CTRIAR", 3, false},
                                       BdfElementType{"CTRIA6", 3, true},  BdfElementType{"CQUAD4", 4, false},
                                       BdfElementType{"CQUADR", 4, false}, BdfElementType{"CQUAD8", 4, true}};

/// Elements that are no surfaces. Other names that begin with C are no elements: CORD2R, CONM2 and the like.
constexpr std::array other_elements{"CTETRA", "CHEXA",  "CPENTA", "CPYRAM", "CPYRA",  "CBAR",   "CBEAM",
                                    "CROD",   "CONROD", "CTUBE",  "CBUSH",  "CELAS1", "CELAS2", "CSHEAR"};

struct Node {
    std::uint64_t number;
    std::size_t line;
    Vec3 point;
};

struct BdfElement {
    std::uint64_t number;
    std::size_t line;
    std::uint64_t property;
    std::array<std::uint64_t, 4> corners;
    std::uint32_t count;
};

/// What a card and the lines that continue it say.
struct Card {
    std::string name;
    std::size_t line = 0;
    std::vector<std::string_view> fields; ///< behind the name; those that are not there are left out
    std::deque<std::string> expanded;     ///< lines whose tabs became blanks

    [[nodiscard]] std::string_view field(std::size_t k) const {
        return k < fields.size() ? fields[k] : std::string_view();
    }
};

/// A line as its fields.
struct Fields {
    std::string_view name;
    std::array<std::string_view, 8> data;
    std::size_t count = 0;
    std::string_view mark; ///< behind them, that the next line bears in place of a name
};

class BdfReader {
public:
    BdfReader(const std::filesystem::path& path, const SceneReaderOptions& options, Diagnostics& diagnostics)
        : file_(path.string()), text_(read_text(path)), lines_(text_), diagnostics_(diagnostics),
          faces_(path, options) {}

    FaceMesh read() {
        skip_control();
        while (!line_.empty() && !is_end()) {
            read_card();
        }
        add_faces();
        tell_left_out();
        return faces_.finish("shell elements", diagnostics_);
    }

private:
    [[noreturn]] void fail(std::size_t line, const std::string& message) const {
        throw ParseError(file_, std::max<std::size_t>(line, 1), 0, message);
    }

    /// The next line that has something beside a comment; none at the end.
    void next_line() {
        while (lines_.next(line_)) {
            line_ = line_.substr(0, line_.find('$'));
            if (!trim(line_).empty()) {
                return;
            }
        }
        line_ = {};
    }

    [[nodiscard]] bool begins_bulk() const {
        std::string_view rest = line_;
        return upper_case(next_word(rest)) == "BEGIN" && upper_case(trim(rest)).starts_with("BULK");
    }

    [[nodiscard]] bool is_end() const { return upper_case(trim(line_)).starts_with("ENDDATA"); }

    /// Goes to the first line of bulk data: what is before BEGIN BULK, if it is there, is of the analysis.
    void skip_control() {
        const Lines start = lines_;
        do {
            next_line();
        } while (!line_.empty() && !begins_bulk());
        if (line_.empty()) {
            lines_ = start;
        }
        next_line();
    }

    /// Splits the line; `card` keeps it where its tabs become blanks.
    [[nodiscard]] Fields split(Card& card) const {
        return line_.find(',') != std::string_view::npos ? split_free() : split_columns(card);
    }

    [[nodiscard]] Fields split_free() const {
        Fields fields;
        std::string_view rest = line_;
        const auto take = [&rest] {
            const std::size_t comma = std::min(rest.find(','), rest.size());
            const std::string_view field = trim(rest.substr(0, comma));
            rest.remove_prefix(std::min(comma + 1, rest.size()));
            return field;
        };
        fields.name = take();
        const std::size_t most = is_large(fields.name) ? 4 : 8;
        while (!rest.empty() && fields.count < most) {
            fields.data[fields.count++] = take();
        }
        fields.mark = take();
        if (!trim(rest).empty()) {
            fail(lines_.number(), fmt::format("{} after {} fields and the mark of the line that goes on",
                                              in_quotes(trim(rest)), most));
        }
        const std::string_view last = fields.count > 0 ? fields.data[fields.count - 1] : std::string_view();
        if (fields.mark.empty() && (last.starts_with('+') || last.starts_with('*')) && !parse_real(last)) {
            fields.mark = last;
            --fields.count;
        }
        return fields;
    }

    [[nodiscard]] Fields split_columns(Card& card) const {
        std::string_view line = line_;
        if (line.find('\t') != std::string_view::npos) {
            std::string blank;
            for (const char c : line) {
                blank += c == '\t' ? ' ' : c;
                while (c == '\t' && blank.size() % name_width != 0) {
                    blank += ' ';
                }
            }
            line = card.expanded.emplace_back(std::move(blank));
        }
        const auto columns = [line](std::size_t from, std::size_t width) {
            return trim(line.substr(std::min(from, line.size()), width));
        };
        Fields fields;
        fields.name = columns(0, name_width);
        const bool large = is_large(fields.name);
        const std::size_t width = large ? 16 : 8;
        const std::size_t most = large ? 4 : 8;
        while (fields.count < most && name_width + fields.count * width < line.size()) {
            fields.data[fields.count] = columns(name_width + fields.count * width, width);
            ++fields.count;
        }
        fields.mark = columns(name_width + 64, name_width);
        return fields;
    }

    [[nodiscard]] static bool is_large(std::string_view name) {
        return name.starts_with('*') || name.ends_with('*');
    }

    [[nodiscard]] bool continues() const {
        if (line_.empty()) {
            return false;
        }
        const std::string_view name = trim(line_.substr(0, std::min(name_width, line_.find(','))));
        return name.empty() || name.front() == '+' || name.front() == '*';
    }

    /// Whether a card of that name is read; the fields of others are passed over.
    [[nodiscard]] static bool is_read(const std::string& name) {
        return name == "GRID" || name == "GRDSET" || find_type(name) != nullptr;
    }

    [[nodiscard]] static const BdfElementType* find_type(const std::string& name) {
        const auto* const found = std::find_if(bdf_element_types.begin(), bdf_element_types.end(),
                                               [&](const BdfElementType& type) { return type.name == name; });
        return found == bdf_element_types.end() ? nullptr : found;
    }

    void read_card() {
        Card card;
        card.line = lines_.number();
        if (continues()) {
            fail(card.line, fmt::format("{} goes on from no line", in_quotes(trim(line_))));
        }
        std::string_view name =
            trim(line_.substr(0, std::min({name_width, line_.find(','), line_.find('\t')})));
        name = name.substr(0, name.find_first_of(" *"));
        card.name = upper_case(name);
        const bool wanted = is_read(card.name);
        std::string_view mark;
        for (bool first = true; first || continues(); first = false) {
            if (wanted) {
                const Fields fields = split(card);
                if (!first && mark.size() > 1 && fields.name.size() > 1 &&
                    upper_case(mark.substr(1)) != upper_case(fields.name.substr(1))) {
                    fail(
                        lines_.number(),
                        fmt::format("goes on as {}, the line before as {}; lines that go on must follow each "
                                    "other",
                                    in_quotes(fields.name), in_quotes(mark)));
                }
                mark = fields.mark;
                for (std::size_t k = 0; k < fields.count && card.fields.size() < most_fields; ++k) {
                    card.fields.push_back(fields.data[k]);
                }
                // Fields at the end of a line may be left out, but those of the next one have their places.
                const std::size_t width = is_large(fields.name) ? 4 : 8;
                while (card.fields.size() % width != 0 && card.fields.size() < most_fields) {
                    card.fields.emplace_back();
                }
            }
            next_line();
        }
        take(card);
    }

    void take(const Card& card) {
        if (const BdfElementType* const type = find_type(card.name)) {
            take_element(card, *type);
        } else if (card.name == "GRID") {
            take_node(card);
        } else if (card.name == "GRDSET") {
            refuse_system(card);
        } else if (card.name == "INCLUDE") {
            fail(card.line, "INCLUDE is not supported; put the file's contents here");
        } else if (std::find(other_elements.begin(), other_elements.end(), card.name) !=
                   other_elements.end()) {
            auto& left = left_out_[card.name];
            left = {left.first + 1, left.second == 0 ? card.line : left.second};
        }
    }

    void refuse_system(const Card& card) const {
        const std::string_view system = card.field(1);
        if (!system.empty() && parse_integer<std::int64_t>(system) != 0) {
            fail(card.line, fmt::format("{} in the coordinate system {} (CP); must be 0, that of the model",
                                        card.name, in_quotes(system)));
        }
    }

    [[nodiscard]] std::uint64_t number_of(const Card& card, std::size_t field, const char* what) const {
        const auto number = parse_integer<std::uint64_t>(card.field(field));
        if (!number || *number == 0) {
            fail(card.line, fmt::format("{}: {} {}; must be a whole number above 0", card.name, what,
                                        in_quotes(card.field(field))));
        }
        return *number;
    }

    /// A number as Fortran writes it, also without the E of its exponent.
    [[nodiscard]] static std::optional<double> parse_real(std::string_view word) {
        constexpr std::size_t longest = 40;
        std::array<char, 2 * longest> text{}; // every sign may get an e before it
        std::size_t size = 0;
        if (word.size() > longest) {
            return std::nullopt;
        }
        for (std::size_t k = 0; k < word.size(); ++k) {
            const char c = word[k];
            const bool exponent = c == 'd' || c == 'D' || c == 'e' || c == 'E';
            const char before = k > 0 ? word[k - 1] : '\0';
            if ((c == '+' || c == '-') &&
                (std::isdigit(static_cast<unsigned char>(before)) != 0 || before == '.')) {
                text[size++] = 'e';
            }
            text[size++] = exponent ? 'e' : c;
        }
        return parse_number({text.data(), size});
    }

    /// 0 where nothing stands.
    [[nodiscard]] double real(const Card& card, std::size_t field) const {
        const std::string_view word = card.field(field);
        const auto value = word.empty() ? std::optional(0.0) : parse_real(word);
        if (!value) {
            fail(card.line, fmt::format("{}: {}; must be a finite number", card.name, in_quotes(word)));
        }
        return *value;
    }

    void take_node(const Card& card) {
        const std::uint64_t number = number_of(card, 0, "node");
        refuse_system(card);
        nodes_.push_back({number, card.line, {real(card, 2), real(card, 3), real(card, 4)}});
    }

    void take_element(const Card& card, const BdfElementType& type) {
        BdfElement element{number_of(card, 0, "element"), card.line, 0, {}, type.corners};
        element.property = card.field(1).empty() ? element.number : number_of(card, 1, "property");
        for (std::uint32_t c = 0; c < type.corners; ++c) {
            element.corners[c] = number_of(card, 2 + c, "node");
        }
        curved_ += type.curved ? 1 : 0;
        elements_.push_back(element);
    }

    /// Nodes by their numbers; the same one may be there several times, in one place.
    void sort_nodes() {
        const auto by_number = [](const Node& a, const Node& b) { return a.number < b.number; };
        if (!std::is_sorted(nodes_.begin(), nodes_.end(), by_number)) {
            std::stable_sort(nodes_.begin(), nodes_.end(), by_number);
        }
        for (std::size_t k = 1; k < nodes_.size(); ++k) {
            if (nodes_[k].number == nodes_[k - 1].number && nodes_[k].point != nodes_[k - 1].point) {
                fail(nodes_[k].line, fmt::format("node {} is in line {}, too, in another place",
                                                 nodes_[k].number, nodes_[k - 1].line));
            }
        }
        const auto same = [](const Node& a, const Node& b) { return a.number == b.number; };
        nodes_.erase(std::unique(nodes_.begin(), nodes_.end(), same), nodes_.end());
    }

    [[nodiscard]] const Vec3& point_of(const BdfElement& element, std::uint64_t number) const {
        std::size_t place = nodes_.empty() ? 0 : static_cast<std::size_t>(number - nodes_.front().number);
        if (place >= nodes_.size() || nodes_[place].number != number) {
            const auto found =
                std::lower_bound(nodes_.begin(), nodes_.end(), number,
                                 [](const Node& node, std::uint64_t n) { return node.number < n; });
            if (found == nodes_.end() || found->number != number) {
                fail(element.line,
                     fmt::format("element {}: node {}; must be the number of one of the {} GRIDs",
                                 element.number, number, nodes_.size()));
            }
            place = static_cast<std::size_t>(found - nodes_.begin());
        }
        return nodes_[place].point;
    }

    void refuse_twins() const {
        std::vector<std::pair<std::uint64_t, std::size_t>> numbers;
        numbers.reserve(elements_.size());
        for (const BdfElement& element : elements_) {
            numbers.emplace_back(element.number, element.line);
        }
        std::sort(numbers.begin(), numbers.end());
        for (std::size_t k = 1; k < numbers.size(); ++k) {
            if (numbers[k].first == numbers[k - 1].first) {
                fail(numbers[k].second,
                     fmt::format("element {} is in line {}, too", numbers[k].first, numbers[k - 1].second));
            }
        }
    }

    void add_faces() {
        sort_nodes();
        refuse_twins();
        faces_.reserve(elements_.size(), elements_.size());
        const std::uint32_t material = faces_.material("", 0);
        std::map<std::uint64_t, std::uint32_t> groups;
        for (const BdfElement& element : elements_) {
            std::array<Vec3, 4> corners{};
            for (std::uint32_t c = 0; c < element.count; ++c) {
                corners[c] = point_of(element, element.corners[c]);
            }
            auto found = groups.find(element.property);
            if (found == groups.end()) {
                const std::uint32_t group = faces_.group(fmt::format("PID {}", element.property));
                found = groups.emplace(element.property, group).first;
            }
            faces_.add({corners.data(), element.count}, found->second, material, {element.line, 0});
        }
    }

    void tell_left_out() const {
        for (const auto& [type, left] : left_out_) {
            diagnostics_.warn(
                fmt::format("{}:{}: {} {} left out, the first one here; surfaces are CTRIA3, CTRIA6, CTRIAR, "
                            "CQUAD4, CQUAD8 and CQUADR",
                            file_, left.second, plural(left.first, "element", "elements"), type));
        }
        if (curved_ > 0) {
            diagnostics_.warn(fmt::format("{}: {} of second order taken as plane between the corners", file_,
                                          plural(curved_, "element", "elements")));
        }
    }

    std::string file_;
    std::string text_;
    Lines lines_;
    std::string_view line_; ///< that comes next; empty at the end
    Diagnostics& diagnostics_;
    FaceBuilder faces_;
    std::vector<Node> nodes_;
    std::vector<BdfElement> elements_;
    std::map<std::string, std::pair<std::uint64_t, std::size_t>> left_out_; ///< by type: count, first line
    std::uint64_t curved_ = 0;
};

} // namespace

FaceMesh read_bdf_mesh(const std::filesystem::path& path, const SceneReaderOptions& options,
                       Diagnostics& diagnostics) {
    return BdfReader(path, options, diagnostics).read();
}

} // namespace hemi::io
