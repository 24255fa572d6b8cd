#include "hemi/core/error.hpp"
#include "hemi/core/interrupt.hpp"
#include "hemi/io/factor_file.hpp"
#include "hemi/io/output_file.hpp"

#include <fmt/format.h>
#include <hdf5.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <functional>
#include <utility>

namespace hemi::io {

namespace {

constexpr hsize_t chunk = 1 << 16; ///< elements
constexpr unsigned compression = 4;
constexpr std::size_t memory_step = std::size_t{1} << 20; ///< bytes by which a file in memory grows

template <class Number>
hid_t type_of();
template <>
hid_t type_of<float>() {
    return H5T_NATIVE_FLOAT;
}
template <>
hid_t type_of<double>() {
    return H5T_NATIVE_DOUBLE;
}
template <>
hid_t type_of<std::uint8_t>() {
    return H5T_NATIVE_UINT8;
}
template <>
hid_t type_of<std::uint32_t>() {
    return H5T_NATIVE_UINT32;
}
template <>
hid_t type_of<std::int64_t>() {
    return H5T_NATIVE_INT64;
}

/// The library prints its errors unless it is told not to; here they become exceptions.
class QuietErrors {
public:
    QuietErrors() {
        H5Eget_auto2(H5E_DEFAULT, &print_, &data_);
        H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
    }
    ~QuietErrors() { H5Eset_auto2(H5E_DEFAULT, print_, data_); }
    QuietErrors(const QuietErrors&) = delete;
    QuietErrors& operator=(const QuietErrors&) = delete;

private:
    H5E_auto2_t print_ = nullptr;
    void* data_ = nullptr;
};

/// Something that the library has open.
class Handle {
public:
    Handle(hid_t id, herr_t (*close_it)(hid_t)) : id_(id), close_(close_it) {}
    ~Handle() {
        if (id_ >= 0) {
            close_(id_);
        }
    }
    Handle(const Handle&) = delete;
    Handle& operator=(const Handle&) = delete;

    [[nodiscard]] hid_t id() const noexcept { return id_; }
    /// Closes now, to see whether what was kept back could be compressed and stored.
    [[nodiscard]] bool close() { return close_(std::exchange(id_, -1)) >= 0; }

private:
    hid_t id_;
    herr_t (*close_)(hid_t);
};

class H5Writer {
public:
    H5Writer(const std::filesystem::path& path, const FormFactors& file)
        : path_(path), file_(file), repair_(to_word(file.repair ? file.repair->repair : Repair::none)) {}

    void write() {
        OutputFile output(path_);
        // In memory: where the library cannot write a byte to a disk that is full, it cannot close the file
        // either, and crashes when the program ends.
        const Handle access(H5Pcreate(H5P_FILE_ACCESS), H5Pclose);
        check(access.id());
        check(H5Pset_fapl_core(access.id(), memory_step, false));
        const Handle h5(H5Fcreate(path_.c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, access.id()), H5Fclose);
        check(h5.id());
        write_head(h5.id());
        write_rows(h5.id());
        write_groups(h5.id());
        write_patches(h5.id());
        copy_to(output, h5.id());
        output.commit();
    }

private:
    /// Writes the file that is in memory, with all that the library still keeps back.
    void copy_to(OutputFile& output, hid_t h5) const {
        check(H5Fflush(h5, H5F_SCOPE_LOCAL));
        const auto size = static_cast<std::size_t>(check(H5Fget_file_image(h5, nullptr, 0)));
        void* bytes = nullptr;
        check(H5Fget_vfd_handle(h5, H5P_DEFAULT, &bytes)); // of this driver: where its pointer is
        output.write(*static_cast<void**>(bytes), size);
    }

    void write_head(hid_t at) {
        text(at, "schema", "hemi/factors-hdf5/1");
        text(at, "program", "hemi " HEMI_VERSION);
        text(at, "meaning",
             "F(i, j), row i and column j of /factors, is the share of what leaves patch i that arrives at "
             "patch j; "
             "sum_j F(i, j) + environment(i) + blocked(i) = 1");
        text(at, "repair", repair_);
        if (file_.group_of.empty()) {
            return; // rows from a file that knew no more
        }
        text(at, "preset", file_.provenance.preset ? std::string(to_word(*file_.provenance.preset)) : "none");
        text(at, "method", std::string(to_word(file_.provenance.method)));
        text(at, "renderer", file_.provenance.renderer);
        text(at, "enclosure", std::string(to_word(file_.enclosure)));
        text(at, "geometry_hash", fmt::format("{:016x}", file_.geometry_hash));
        number(at, "resolution", file_.provenance.resolution);
        number(at, "eye_points", file_.provenance.eye_points);
        number(at, "seed", file_.provenance.seed);
    }

    void write_rows(hid_t at) {
        const Handle group = make_group(at, "factors");
        const FormFactorMatrix& factors = file_.matrix;
        text(group.id(), "format", "csr");
        const std::array<hsize_t, 1> two{2};
        const Handle space(H5Screate_simple(1, two.data(), nullptr), H5Sclose);
        const Handle shape(
            H5Acreate2(group.id(), "shape", H5T_STD_I64LE, check(space.id()), H5P_DEFAULT, H5P_DEFAULT),
            H5Aclose);
        const std::array<std::int64_t, 2> sizes{factors.size(), factors.size()};
        check(H5Awrite(check(shape.id()), H5T_NATIVE_INT64, sizes.data()));
        blocks<float>(group.id(), "data", H5T_IEEE_F32LE, "1", &RowBlock::values);
        blocks<std::uint32_t>(group.id(), "indices", H5T_STD_U32LE, "", &RowBlock::columns);
        std::vector<std::int64_t> offsets{0};
        for (const RowBlock& block : factors.blocks()) {
            const std::int64_t before = offsets.back();
            for (std::size_t row = 1; row < block.begin.size(); ++row) {
                offsets.push_back(before + static_cast<std::int64_t>(block.begin[row]));
            }
        }
        column<std::int64_t>(group.id(), "indptr", H5T_STD_I64LE, "", offsets);
    }

    void write_groups(hid_t at) {
        if (file_.group_of.empty()) {
            return;
        }
        const Handle group = make_group(at, "groups");
        const Handle type = string_type();
        std::vector<const char*> names;
        for (const std::string& name : file_.groups) {
            names.push_back(name.c_str());
        }
        const std::array<hsize_t, 1> size{names.size()};
        const Handle space(H5Screate_simple(1, size.data(), nullptr), H5Sclose);
        const Handle set(H5Dcreate2(group.id(), "name", type.id(), check(space.id()), H5P_DEFAULT,
                                    H5P_DEFAULT, H5P_DEFAULT),
                         H5Dclose);
        check(set.id());
        if (!names.empty()) {
            check(H5Dwrite(set.id(), type.id(), H5S_ALL, H5S_ALL, H5P_DEFAULT, names.data()));
        }
    }

    void write_patches(hid_t at) {
        if (file_.areas.empty()) {
            return;
        }
        const Handle group = make_group(at, "patches");
        const FormFactorMatrix& factors = file_.matrix;
        std::vector<double> sums;
        std::vector<double> environment;
        std::vector<double> blocked;
        std::vector<std::uint8_t> known;
        for (std::uint32_t i = 0; i < factors.size(); ++i) {
            const RowView row = factors.row(i);
            sums.push_back(row.sum());
            environment.push_back(row.environment);
            blocked.push_back(row.blocked);
            known.push_back(factors.known(i) ? 1 : 0);
        }
        column<double>(group.id(), "area", H5T_IEEE_F64LE, "scene unit^2", file_.areas);
        if (file_.group_of.empty()) {
            return;
        }
        column<std::uint32_t>(group.id(), "group", H5T_STD_U32LE, "", file_.group_of);
        column<double>(group.id(), "row_sum", H5T_IEEE_F64LE, "1", sums);
        column<double>(group.id(), "environment", H5T_IEEE_F64LE, "1", environment);
        column<double>(group.id(), "blocked", H5T_IEEE_F64LE, "1", blocked);
        column<std::uint8_t>(group.id(), "known", H5T_STD_U8LE, "", known);
        if (file_.error) {
            column<double>(group.id(), "row_error", H5T_IEEE_F64LE, "1", file_.error->rows);
        }
    }

    [[nodiscard]] Handle make_group(hid_t at, const char* name) const {
        return {check(H5Gcreate2(at, name, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT)), H5Gclose};
    }

    /// An array of one number an entry, from all row blocks.
    template <class Number>
    void blocks(hid_t at, const char* name, hid_t type, const char* units,
                RowArray<Number> RowBlock::*values) {
        write_array<Number>(at, name, type, units, file_.matrix.entries(), [&](const auto& sink) {
            for (const RowBlock& block : file_.matrix.blocks()) {
                sink(std::span<const Number>(block.*values));
            }
        });
    }

    template <class Number>
    void column(hid_t at, const char* name, hid_t type, const char* units,
                const std::vector<Number>& numbers) {
        write_array<Number>(at, name, type, units, numbers.size(),
                            [&](const auto& sink) { sink(std::span<const Number>(numbers)); });
    }

    /// A chunked, compressed array. `source` hands its numbers over in pieces of any size.
    template <class Number, class Source>
    void write_array(hid_t at, const char* name, hid_t type, const char* units, hsize_t size,
                     const Source& source) {
        const Handle space(H5Screate_simple(1, &size, nullptr), H5Sclose);
        const Handle settings(H5Pcreate(H5P_DATASET_CREATE), H5Pclose);
        check(space.id());
        check(settings.id());
        if (size > 0) {
            const hsize_t piece = std::min(size, chunk);
            check(H5Pset_chunk(settings.id(), 1, &piece));
            check(H5Pset_shuffle(settings.id()));
            check(H5Pset_deflate(settings.id(), compression));
        }
        Handle set(H5Dcreate2(at, name, type, space.id(), H5P_DEFAULT, settings.id(), H5P_DEFAULT), H5Dclose);
        check(set.id());
        if (*units != '\0') {
            text(set.id(), "units", units);
        }
        hsize_t written = 0;
        std::vector<Number> buffer; // whole chunks, so that each is compressed once
        const auto flush = [&] {
            const hsize_t count = buffer.size();
            check(H5Sselect_hyperslab(space.id(), H5S_SELECT_SET, &written, nullptr, &count, nullptr));
            const Handle memory(H5Screate_simple(1, &count, nullptr), H5Sclose);
            check(H5Dwrite(set.id(), type_of<Number>(), check(memory.id()), space.id(), H5P_DEFAULT,
                           buffer.data()));
            written += count;
            buffer.clear();
        };
        source([&](std::span<const Number> numbers) {
            stop_if_interrupted();
            while (!numbers.empty()) {
                const std::size_t part = std::min(numbers.size(), std::size_t{chunk} - buffer.size());
                buffer.insert(buffer.end(), numbers.begin(),
                              numbers.begin() + static_cast<std::ptrdiff_t>(part));
                numbers = numbers.subspan(part);
                if (buffer.size() == chunk) {
                    flush();
                }
            }
        });
        if (!buffer.empty()) {
            flush();
        }
        if (!set.close()) {
            fail();
        }
    }

    void text(hid_t at, const char* name, const std::string& value) const {
        const Handle type = string_type();
        const Handle space(H5Screate(H5S_SCALAR), H5Sclose);
        const Handle attribute(H5Acreate2(at, name, type.id(), check(space.id()), H5P_DEFAULT, H5P_DEFAULT),
                               H5Aclose);
        const char* const words = value.c_str();
        check(H5Awrite(check(attribute.id()), type.id(), &words));
    }

    /// UTF-8 of any length.
    [[nodiscard]] Handle string_type() const {
        const hid_t type = check(H5Tcopy(H5T_C_S1));
        check(H5Tset_size(type, H5T_VARIABLE));
        check(H5Tset_cset(type, H5T_CSET_UTF8));
        return {type, H5Tclose};
    }

    void number(hid_t at, const char* name, std::uint64_t value) const {
        const Handle space(H5Screate(H5S_SCALAR), H5Sclose);
        const Handle attribute(
            H5Acreate2(at, name, H5T_STD_U64LE, check(space.id()), H5P_DEFAULT, H5P_DEFAULT), H5Aclose);
        check(H5Awrite(check(attribute.id()), H5T_NATIVE_UINT64, &value));
    }

    /// `result` itself unless it says that something failed.
    template <class Result>
    Result check(Result result) const {
        if (result < 0) {
            fail();
        }
        return result;
    }

    /// @throws IoError with the first reason that the library gives: the innermost.
    [[noreturn]] void fail() const {
        std::string reason;
        H5Ewalk2(
            H5E_DEFAULT, H5E_WALK_UPWARD,
            [](unsigned depth, const H5E_error2_t* error, void* target) -> herr_t {
                if (depth == 0 && error->desc != nullptr) {
                    *static_cast<std::string*>(target) = error->desc;
                }
                return 0;
            },
            &reason);
        throw IoError(fmt::format("{}: cannot be written: HDF5: {}", path_.string(),
                                  reason.empty() ? "unknown error" : reason));
    }

    const std::filesystem::path& path_;
    const FormFactors& file_;
    std::string repair_;
};

} // namespace

void write_h5(const std::filesystem::path& path, const FormFactors& file) {
    const std::size_t size = file.matrix.size();
    const auto fits = [size](std::size_t length) { return length == 0 || length == size; };
    if (!fits(file.areas.size()) || !fits(file.group_of.size()) ||
        (file.error && file.error->rows.size() != size)) {
        throw InvalidArgument(fmt::format("{} areas and {} groups of patches for {} rows", file.areas.size(),
                                          file.group_of.size(), size));
    }
    const QuietErrors quiet;
    H5Writer(path, file).write();
}

} // namespace hemi::io
