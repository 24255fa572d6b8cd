#include "io/formats/json_text.hpp"

#include "hemi/core/error.hpp"
#include "io/formats/text_scan.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <utility>
#include <vector>

namespace hemi::io {

namespace {

/// Builds the document from the parser's events: the library's own builder keeps the last of duplicate keys
/// and knows no position for numbers that overflow.
class Builder : public nlohmann::json_sax<Json> {
public:
    Builder(std::string_view text, const std::string& file) : text_(text), file_(file) {}

    [[nodiscard]] Json take() { return std::move(root_); }

    bool null() override { return add(nullptr); }
    bool boolean(bool value) override { return add(value); }
    bool number_integer(number_integer_t value) override { return add(value); }
    bool number_unsigned(number_unsigned_t value) override { return add(value); }
    bool number_float(number_float_t value, const string_t&) override { return add(value); }
    bool string(string_t& value) override { return add(std::move(value)); }
    bool binary(binary_t&) override { return false; }
    bool start_object(std::size_t) override { return open(Json::object()); }
    bool start_array(std::size_t) override { return open(Json::array()); }
    bool end_object() override { return close(); }
    bool end_array() override { return close(); }

    bool key(string_t& value) override {
        if (open_.back()->contains(value)) {
            throw InputError(fmt::format("{}: {}key {} is given twice", file_, path(), in_quotes(value)));
        }
        key_ = std::move(value);
        return true;
    }

    bool parse_error(std::size_t position, const std::string& token, const Json::exception& error) override {
        const std::string_view before =
            text_.substr(0, std::min(position > 0 ? position - 1 : 0, text_.size()));
        const auto line = static_cast<std::size_t>(std::count(before.begin(), before.end(), '\n')) + 1;
        const std::size_t line_start =
            before.rfind('\n') == std::string_view::npos ? 0 : before.rfind('\n') + 1;
        throw ParseError(file_, line, before.size() - line_start + 1,
                         reason(token, error, position > text_.size()));
    }

private:
    template <class Value>
    bool add(Value&& value) {
        place(Json(std::forward<Value>(value)));
        return true;
    }

    bool open(Json&& container) {
        constexpr std::size_t deepest = 64;
        if (open_.size() == deepest) {
            throw InputError(fmt::format("{}: brackets nested deeper than {} levels", file_, deepest));
        }
        open_.push_back(&place(std::move(container)));
        return true;
    }

    bool close() {
        open_.pop_back();
        return true;
    }

    Json& place(Json&& value) {
        if (open_.empty()) {
            root_ = std::move(value);
            return root_;
        }
        Json& parent = *open_.back();
        if (parent.is_array()) {
            parent.push_back(std::move(value));
            return parent.back();
        }
        return parent.emplace(std::move(key_), std::move(value)).first.value();
    }

    /// `surfaces[3]: ` of the innermost open bracket.
    [[nodiscard]] std::string path() const {
        std::string result;
        for (std::size_t k = 1; k < open_.size(); ++k) {
            const Json& parent = *open_[k - 1];
            result += parent.is_array() ? fmt::format("[{}]", parent.size() - 1)
                                        : fmt::format("{}{}", result.empty() ? "" : ".", last_key(parent));
        }
        return result.empty() ? result : result + ": ";
    }

    static std::string last_key(const Json& object) { return std::prev(object.end()).key(); }

    /// The library's message without its own error number and position.
    static std::string reason(const std::string& token, const Json::exception& error, bool at_end) {
        constexpr int number_overflow = 406;
        if (error.id == number_overflow) {
            return fmt::format("{}; no number can be as large", token);
        }
        return at_end || token.empty()
                   ? "the text ends here; no sound JSON does"
                   : fmt::format("unexpected {}; this is no sound JSON", in_quotes(to_utf8(token)));
    }

    std::string_view text_;
    const std::string& file_;
    Json root_;
    std::vector<Json*> open_; ///< containers whose end is yet to come, outermost first
    std::string key_;
};

} // namespace

Json parse_json(std::string_view text, const std::string& file) {
    Builder builder(text, file);
    constexpr bool whole = true;
    constexpr bool ignore_comments = true;
    Json::sax_parse(text.begin(), text.end(), &builder, nlohmann::detail::input_format_t::json, whole,
                    ignore_comments);
    return builder.take();
}

std::string json_text(const Json& document) {
    return document.dump(-1, ' ', false, Json::error_handler_t::replace);
}

} // namespace hemi::io
