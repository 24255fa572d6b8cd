#pragma once

#include "hemi/core/geometry.hpp"
#include "io/formats/json_text.hpp"

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace hemi::io {

/// A value of a JSON document that knows its place, so that what is wrong can be said with file and path:
/// `room.json: surfaces[3].polygon: 2 vertices; a patch needs 3 or 4`.
/// A node refers to the node it came from, which must outlive it.
class JsonNode {
public:
    JsonNode(const Json& document, const std::string& file) : value_(document), file_(file) {}

    [[nodiscard]] const Json& value() const noexcept { return value_; }

    /// @throws InputError unless this is an object whose keys are all in `known`.
    void check_keys(const std::vector<std::string>& known) const;
    /// @throws InputError unless this is an object.
    void check_object() const;
    [[nodiscard]] bool has(std::string_view key) const { return value_.contains(key); }
    /// Member `key` of an object. @throws InputError if it is missing.
    [[nodiscard]] JsonNode member(std::string_view key) const&;
    JsonNode member(std::string_view key) const&& = delete;

    /// Number of elements. @throws InputError unless this is an array.
    [[nodiscard]] std::size_t size() const;
    [[nodiscard]] JsonNode element(std::size_t index) const&;
    JsonNode element(std::size_t index) const&& = delete;

    /// @throws InputError unless this is such a value.
    [[nodiscard]] double number() const;
    [[nodiscard]] double positive() const;
    [[nodiscard]] std::uint32_t count() const;                     ///< integer from 1 to a million
    [[nodiscard]] std::uint64_t integer(std::uint64_t most) const; ///< from 0
    [[nodiscard]] bool boolean() const;
    [[nodiscard]] std::string text() const;               ///< a string that is not empty
    [[nodiscard]] std::string any_text() const;           ///< any string
    [[nodiscard]] std::vector<std::string> texts() const; ///< array of any strings
    [[nodiscard]] std::vector<double> numbers() const;    ///< array of numbers
    [[nodiscard]] Vec3 point() const;                     ///< array of three numbers

    /// Where it is in the document: `surfaces[3].polygon`.
    [[nodiscard]] std::string path() const;

    /// @throws InputError "file: path: message"
    [[noreturn]] void fail(const std::string& message) const;
    /// @throws InputError "file: path: (what is there); must be (wanted)"
    [[noreturn]] void expect(const std::string& wanted) const;

private:
    JsonNode(const Json& value, const JsonNode& parent, std::string_view key, std::size_t index)
        : value_(value), file_(parent.file_), parent_(&parent), key_(key), index_(index) {}

    const Json& value_;
    const std::string& file_;
    const JsonNode* parent_ = nullptr;
    std::string_view key_;
    std::size_t index_ = 0;
};

} // namespace hemi::io
