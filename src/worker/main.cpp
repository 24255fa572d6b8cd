/// The program in which software OpenGL draws hemicubes: the library starts one for every core. It is of no
/// use otherwise.
#include "hemi/core/error.hpp"
#include "hemi/engine/engine.hpp"

#include <cstdio>

int main() {
    try {
        return hemi::run_hemicube_worker();
    } catch (const hemi::InvalidArgument& error) {
        std::fprintf(stderr, "hemi-hemicube-worker: %s\n", error.what());
        return 2;
    }
}
