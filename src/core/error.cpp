#include "hemi/core/error.hpp"

#include <fmt/format.h>

namespace hemi {

namespace {

std::string place(const std::string& file, std::size_t line, std::size_t column) {
    if (line == 0) {
        return file;
    }
    return column == 0 ? fmt::format("{}:{}", file, line) : fmt::format("{}:{}:{}", file, line, column);
}

} // namespace

ParseError::ParseError(const std::string& file, std::size_t line, std::size_t column,
                       const std::string& message)
    : InputError(place(file, line, column) + ": " + message), file_(file), line_(line), column_(column) {}

} // namespace hemi
