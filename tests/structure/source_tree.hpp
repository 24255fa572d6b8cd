#pragma once

#include "support/places.hpp"

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

/// The project's own sources, read as text.
namespace hemi::structure_test {

struct SourceFile {
    std::string path; ///< from the project's root, for example "src/io/hff.cpp"
    std::string text;
};

inline std::string read_text(const std::filesystem::path& path) {
    std::ifstream file(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(file), {}};
}

/// All regular files below the given directories of the project, sorted by path.
inline std::vector<SourceFile> source_files(const std::vector<std::string>& directories) {
    const std::filesystem::path root(HEMI_SOURCE_DIR);
    std::vector<SourceFile> files;
    for (const std::string& directory : directories) {
        for (const auto& entry : std::filesystem::recursive_directory_iterator(root / directory)) {
            if (entry.is_regular_file()) {
                files.push_back({entry.path().lexically_relative(root).generic_string(), read_text(entry)});
            }
        }
    }
    std::sort(files.begin(), files.end(),
              [](const SourceFile& a, const SourceFile& b) { return a.path < b.path; });
    return files;
}

inline std::vector<std::string> lines_of(const std::string& text) {
    std::vector<std::string> lines;
    for (std::size_t begin = 0; begin < text.size();) {
        const std::size_t end = std::min(text.find('\n', begin), text.size());
        lines.push_back(text.substr(begin, end - begin));
        begin = end + 1;
    }
    return lines;
}

/// One #include line.
struct Include {
    std::size_t line; ///< from 1
    bool quoted;      ///< "…" rather than <…>
    std::string name;
};

inline std::vector<Include> includes_of(const std::string& text) {
    std::vector<Include> includes;
    const auto lines = lines_of(text);
    for (std::size_t i = 0; i < lines.size(); ++i) {
        const std::string& line = lines[i];
        std::size_t at = line.find_first_not_of(" \t");
        if (at == std::string::npos || line[at] != '#') {
            continue;
        }
        at = line.find_first_not_of(" \t", at + 1);
        if (at == std::string::npos || line.compare(at, 7, "include") != 0) {
            continue;
        }
        const std::size_t open = line.find_first_of("\"<", at + 7);
        const std::size_t close = open == std::string::npos ? open : line.find_first_of("\">", open + 1);
        if (close != std::string::npos) {
            includes.push_back({i + 1, line[open] == '"', line.substr(open + 1, close - open - 1)});
        }
    }
    return includes;
}

} // namespace hemi::structure_test
