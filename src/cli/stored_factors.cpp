#include "cli/stored_factors.hpp"

#include "cli/outputs.hpp"
#include "hemi/core/error.hpp"

#include <fmt/format.h>

namespace hemi::cli {

void write_factors(const std::filesystem::path& path, const io::FactorFile& file,
                   std::span<const double> emissivity) {
    const std::string extension = is_standard_output(path) ? ".csv" : extension_of(path);
    if (extension == ".hff") {
        io::write_hff(path, file);
    } else if (extension == ".mtx") {
        io::write_mtx(path, file.factors);
    } else if (extension == ".npz") {
        io::write_npz(path, file.factors);
    } else if (is_view3d_factor_file(path)) {
        io::write_view3d(path, file, extension == ".vf" ? io::View3dFormat::binary : io::View3dFormat::text,
                         emissivity);
    } else {
        io::write_csv(path, file.factors);
    }
}

FormFactorMatrix read_bare_factors(const std::filesystem::path& path) {
    const std::string extension = extension_of(path);
    if (extension == ".mtx") {
        return io::read_mtx(path);
    }
    if (extension == ".csv") {
        return io::read_csv(path);
    }
    if (extension == ".npz") {
        return io::read_npz(path);
    }
    throw InvalidArgument(fmt::format("{}: form factors end in .hff, .mtx, .csv or .npz", path.string()));
}

bool is_view3d_factor_file(const std::filesystem::path& path) {
    const std::string extension = extension_of(path);
    return extension == ".txt" || extension == ".vf";
}

bool is_bare_factor_file(const std::filesystem::path& path) {
    const std::string extension = extension_of(path);
    return extension == ".mtx" || extension == ".csv" || extension == ".npz";
}

} // namespace hemi::cli
