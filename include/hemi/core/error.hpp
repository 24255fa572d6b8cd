#pragma once

#include <cstddef>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

namespace hemi {

/// Base of everything that hemi throws. what() is one sentence for a person: the file and the place, the
/// value, and what would be right.
class Error : public std::runtime_error {
public:
    /// @param message   one sentence
    /// @param settings  names of settings (as in "max-memory") that would help; a program may say how they
    /// are spelled
    explicit Error(const std::string& message, std::vector<std::string> settings = {})
        : std::runtime_error(message), settings_(std::move(settings)) {}

    /// Settings that would help, such as "max-memory"; empty where there is none.
    [[nodiscard]] const std::vector<std::string>& settings() const noexcept { return settings_; }

private:
    std::vector<std::string> settings_;
};

/// A function was called with an argument outside its documented range.
class InvalidArgument : public Error {
public:
    using Error::Error;
};

/// A scene, a mesh or a stored file cannot be used as it is: what it says is wrong, or it cannot be read.
class InputError : public Error {
public:
    using Error::Error;
};

/// Text that does not parse. what() begins with "file:line:column: " as far as these are known.
class ParseError : public InputError {
public:
    /// @param file         as the user named it
    /// @param line,column  from 1; 0 where unknown
    /// @param message      value and what would be right, without the place
    ParseError(const std::string& file, std::size_t line, std::size_t column, const std::string& message);

    /// The file that does not parse.
    [[nodiscard]] const std::string& file() const noexcept { return file_; }
    /// From 1; 0 where unknown.
    [[nodiscard]] std::size_t line() const noexcept { return line_; }
    /// From 1; 0 where unknown.
    [[nodiscard]] std::size_t column() const noexcept { return column_; }

private:
    std::string file_;
    std::size_t line_;
    std::size_t column_;
};

/// A file cannot be written.
class IoError : public Error {
public:
    using Error::Error;
};

/// OpenGL refused something.
class GlError : public Error {
public:
    using Error::Error;
};

/// There is no OpenGL device (or no display) of the kind asked for.
class NoDevice : public GlError {
public:
    using GlError::GlError;
};

/// The work would need more memory than allowed.
class OutOfMemory : public Error {
public:
    using Error::Error;
};

/// A solver did not reach its tolerance.
class NotConverged : public Error {
public:
    using Error::Error;
};

/// The caller asked, through a progress callback, to stop.
class Cancelled : public Error {
public:
    Cancelled() : Error("interrupted") {}
};

} // namespace hemi
