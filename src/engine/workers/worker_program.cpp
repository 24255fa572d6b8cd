#include "hemi/engine/engine.hpp"

#include <cstdlib>
#include <system_error>

#include <dlfcn.h>

namespace hemi {

namespace {

namespace fs = std::filesystem;

/// Folder of the program or the shared library that this code was linked into; empty if that is not known.
fs::path own_folder() {
    Dl_info info{};
    // A function's address as an object's: POSIX promises that dladdr can take it.
    if (dladdr(reinterpret_cast<const void*>(&find_worker_program), &info) == 0 ||
        info.dli_fname == nullptr) {
        return {};
    }
    std::error_code error;
    fs::path file = fs::read_symlink("/proc/self/exe", error);
    const fs::path named = info.dli_fname;
    // dladdr has a program by the word it was started with, which may be relative to another folder.
    if (error || named.extension() == ".so" || named.string().find(".so.") != std::string::npos) {
        file = fs::absolute(named, error);
    }
    return error ? fs::path() : file.parent_path();
}

bool is_file(const fs::path& path) {
    std::error_code ignored;
    return fs::is_regular_file(path, ignored);
}

} // namespace

fs::path find_worker_program() {
    if (const char* named = std::getenv("HEMI_WORKER"); named != nullptr && *named != '\0') {
        return named;
    }
    constexpr const char* name = "libexec/hemi/hemi-hemicube-worker";
    fs::path folder = own_folder();
    // Beside the program, as in a build; one folder up, as installed; two, for a module of Python in a build;
    // four, for one that is installed: lib/python3.11/dist-packages/hemi.
    for (int up = 0; up < 5 && !folder.empty(); ++up, folder = folder.parent_path()) {
        if (is_file(folder / name)) {
            return folder / name;
        }
    }
    return is_file(HEMI_WORKER_INSTALLED) ? fs::path(HEMI_WORKER_INSTALLED) : fs::path();
}

} // namespace hemi
