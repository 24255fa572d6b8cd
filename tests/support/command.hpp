#pragma once

#include "cli/program.hpp"

#include <cstdlib>
#include <string>
#include <sys/wait.h>
#include <vector>

namespace hemi::test {

/// What became of a program other than hemi itself.
struct CommandOutcome {
    int status = -1; ///< exit status; 128 + signal if it was killed; 127 if it was not found
    std::string out;
    std::string err;
};

/// Runs a program, found by path or in PATH, to its end.
inline CommandOutcome run_command(const std::vector<std::string>& words) {
    const cli_test::Directory directory;
    std::string line;
    for (const std::string& word : words) {
        line += "'";
        for (const char letter : word) {
            line += letter == '\'' ? std::string("'\\''") : std::string(1, letter);
        }
        line += "' ";
    }
    line += "</dev/null >'" + directory.path("out") + "' 2>'" + directory.path("err") + "'";
    const int status = std::system(line.c_str());
    return {WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status), directory.read("out"),
            directory.read("err")};
}

} // namespace hemi::test
