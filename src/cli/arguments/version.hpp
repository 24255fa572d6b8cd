#pragma once

#include <string>

namespace hemi::cli {

/// git's name of the sources, "-dirty" behind it where they were changed; "unknown" outside a repository.
extern const char* const source_revision;

/// What `--version` answers: version, revision, compiler, and what OpenGL it was built for.
[[nodiscard]] std::string version_text();

} // namespace hemi::cli
