#include "io/formats/json_node.hpp"

#include "hemi/core/error.hpp"
#include "hemi/core/nearest_word.hpp"
#include "io/formats/text_scan.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace hemi::io {

namespace {

std::string described(const Json& value) {
    if (value.is_string()) {
        return in_quotes(value.get_ref<const std::string&>());
    }
    if (value.is_object()) {
        return "an object";
    }
    if (value.is_array()) {
        return fmt::format("an array of {}", value.size());
    }
    return value.dump();
}

} // namespace

void JsonNode::check_object() const {
    if (!value_.is_object()) {
        expect("an object");
    }
}

void JsonNode::check_keys(const std::vector<std::string>& known) const {
    check_object();
    for (const auto& [key, ignored] : value_.items()) {
        if (std::find(known.begin(), known.end(), key) == known.end()) {
            fail(fmt::format("unknown key {}{}", in_quotes(key), did_you_mean_or_list(key, known)));
        }
    }
}

JsonNode JsonNode::member(std::string_view key) const& {
    check_object();
    const auto found = value_.find(key);
    if (found == value_.end()) {
        fail(fmt::format("\"{}\" is missing", key));
    }
    return {*found, *this, key, 0};
}

std::size_t JsonNode::size() const {
    if (!value_.is_array()) {
        expect("an array");
    }
    return value_.size();
}

JsonNode JsonNode::element(std::size_t index) const& {
    return {value_[index], *this, {}, index};
}

double JsonNode::number() const {
    if (!value_.is_number()) {
        expect("a number");
    }
    return value_.get<double>();
}

double JsonNode::positive() const {
    if (!value_.is_number() || !(value_.get<double>() > 0.0)) {
        expect("a positive number");
    }
    return value_.get<double>();
}

std::uint32_t JsonNode::count() const {
    constexpr double most = 1e6;
    const double count = value_.is_number() ? value_.get<double>() : 0.0;
    if (!(count >= 1.0 && count <= most && count == std::floor(count))) {
        expect("a whole number from 1 to 1000000");
    }
    return static_cast<std::uint32_t>(count);
}

std::uint64_t JsonNode::integer(std::uint64_t most) const {
    if (!value_.is_number_unsigned() || value_.get<std::uint64_t>() > most) {
        expect(fmt::format("a whole number from 0 to {}", most));
    }
    return value_.get<std::uint64_t>();
}

bool JsonNode::boolean() const {
    if (!value_.is_boolean()) {
        expect("true or false");
    }
    return value_.get<bool>();
}

std::string JsonNode::text() const {
    if (!value_.is_string() || value_.get_ref<const std::string&>().empty()) {
        expect("a string that is not empty");
    }
    return any_text();
}

std::string JsonNode::any_text() const {
    if (!value_.is_string()) {
        expect("a string");
    }
    auto text = value_.get<std::string>();
    if (text.find('\0') != std::string::npos) {
        expect("a string without zero characters, which many formats cannot hold");
    }
    return text;
}

std::vector<std::string> JsonNode::texts() const {
    std::vector<std::string> result;
    for (std::size_t k = 0; k < size(); ++k) {
        result.push_back(element(k).any_text());
    }
    return result;
}

std::vector<double> JsonNode::numbers() const {
    std::vector<double> result;
    for (std::size_t k = 0; k < size(); ++k) {
        result.push_back(element(k).number());
    }
    return result;
}

Vec3 JsonNode::point() const {
    if (!value_.is_array() || value_.size() != 3) {
        expect("three numbers [x, y, z]");
    }
    return {element(0).number(), element(1).number(), element(2).number()};
}

void JsonNode::fail(const std::string& message) const {
    const std::string place = path();
    throw InputError(place.empty() ? fmt::format("{}: {}", file_, message)
                                   : fmt::format("{}: {}: {}", file_, place, message));
}

void JsonNode::expect(const std::string& wanted) const {
    fail(fmt::format("{}; must be {}", described(value_), wanted));
}

std::string JsonNode::path() const {
    if (parent_ == nullptr) {
        return {};
    }
    const std::string before = parent_->path();
    if (parent_->value_.is_array()) {
        return fmt::format("{}[{}]", before, index_);
    }
    return before.empty() ? std::string(key_) : fmt::format("{}.{}", before, key_);
}

} // namespace hemi::io
