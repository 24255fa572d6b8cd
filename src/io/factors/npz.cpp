#include "hemi/core/error.hpp"
#include "hemi/io/factor_file.hpp"
#include "hemi/io/output_file.hpp"
#include "io/factors/npy.hpp"
#include "io/factors/rows_builder.hpp"
#include "io/factors/triples.hpp"
#include "io/formats/text_scan.hpp"
#include "io/formats/zip_writer.hpp"

#include <fmt/format.h>
#include <zip.h>

#include <algorithm>
#include <limits>
#include <memory>
#include <utility>

namespace hemi::io {

namespace {

/// Adds an array that a function hands over in pieces.
void add_array(ZipWriter& zip, const std::string& name, std::string_view type, std::string_view shape,
               const ZipWriter::Source& data) {
    const std::string header = npy_header(type, shape);
    zip.add(name, [&](const ZipWriter::Sink& sink) {
        sink(std::as_bytes(std::span(header)));
        data(sink);
    });
}

std::string shape_of(std::uint64_t size) {
    return fmt::format("({},)", size);
}

/// Offsets of all rows, in the order of the blocks.
void row_offsets(const FormFactorMatrix& factors, const ZipWriter::Sink& sink) {
    const std::int64_t zero = 0;
    sink(std::as_bytes(std::span(&zero, 1)));
    std::uint64_t before = 0;
    std::vector<std::int64_t> offsets;
    for (const RowBlock& block : factors.blocks()) {
        offsets.clear();
        for (std::size_t row = 1; row < block.begin.size(); ++row) {
            offsets.push_back(static_cast<std::int64_t>(before + block.begin[row]));
        }
        before += block.columns.size();
        sink(std::as_bytes(std::span(offsets)));
    }
}

class NpzReader {
public:
    explicit NpzReader(const std::filesystem::path& path)
        : file_(path.string()), archive_(nullptr, &zip_discard) {
        std::error_code ignored;
        if (std::filesystem::is_directory(path, ignored)) {
            fail("cannot be read: Is a directory");
        }
        int code = 0;
        archive_.reset(zip_open(path.c_str(), ZIP_RDONLY, &code));
        if (!archive_) {
            zip_error_t error;
            zip_error_init_with_code(&error, code);
            const std::string reason = zip_error_strerror(&error);
            zip_error_fini(&error);
            fail(fmt::format("cannot be read as a ZIP archive: {}", reason));
        }
    }

    FormFactorMatrix read() {
        const NpyArray format = member("format.npy");
        if (format.text() != "csr") {
            format.fail(fmt::format("sparse format {}; must be \"csr\" (tocsr() makes it)",
                                    in_quotes(format.text())));
        }
        const NpyArray shape = member("shape.npy");
        const auto sizes = shape.integers();
        if (sizes.size() != 2 || sizes[0] != sizes[1] ||
            sizes[0] > std::numeric_limits<std::int32_t>::max()) {
            shape.fail(
                fmt::format("a shape of ({}); must be two equal numbers below 2^31", fmt::join(sizes, ", ")));
        }
        const auto offsets = read_offsets(sizes[0]);
        const auto columns = member("indices.npy").integers();
        const NpyArray data = member("data.npy");
        const auto values = data.numbers();
        if (columns.size() != offsets.back() || values.size() != offsets.back()) {
            fail(fmt::format("{} indices and {} values; indptr.npy says {}", columns.size(), values.size(),
                             offsets.back()));
        }
        const auto size = static_cast<std::uint32_t>(sizes[0]);
        RowsBuilder rows(size);
        for (std::uint32_t row = 0; row < size; ++row) {
            for (std::uint64_t k = offsets[row]; k < offsets[row + 1]; ++k) {
                check_entry(row, columns[k], values[k], size);
                rows.add(static_cast<std::uint32_t>(columns[k]), static_cast<float>(values[k]));
            }
            if (const auto twice = rows.end_row()) {
                fail(fmt::format("row {}: column {} is there twice", row, *twice));
            }
        }
        return rows.take();
    }

private:
    std::vector<std::uint64_t> read_offsets(std::uint64_t rows) {
        const NpyArray array = member("indptr.npy");
        auto offsets = array.integers();
        if (offsets.size() != rows + 1 || offsets[0] != 0 ||
            !std::is_sorted(offsets.begin(), offsets.end())) {
            array.fail(fmt::format("must be {} offsets that ascend from 0", rows + 1));
        }
        return offsets;
    }

    void check_entry(std::uint32_t row, std::uint64_t column, double value, std::uint32_t size) const {
        if (column >= size) {
            fail(fmt::format("row {}: column {}; must be below {}", row, column, size));
        }
        if (!(value >= 0.0 && value <= std::numeric_limits<float>::max())) {
            fail(fmt::format("F({}, {}) = {}; must be finite and not negative", row, column, value));
        }
    }

    NpyArray member(const char* name) {
        zip_stat_t status;
        zip_stat_init(&status);
        if (zip_stat(archive_.get(), name, 0, &status) != 0) {
            fail(fmt::format("has no member {}, so it is not a sparse matrix of SciPy", name));
        }
        // Deflate cannot shrink more than 1032 times: a larger promise is a lie, and no memory is spent on
        // it. How much there is to expand can be a lie as well; the file's own length is none.
        constexpr std::uint64_t most = 1032;
        std::error_code error;
        const std::uint64_t file_size = std::filesystem::file_size(file_, error);
        if (status.size / most > std::min<std::uint64_t>(status.comp_size, error ? 0 : file_size) + 64) {
            fail(fmt::format("{}: {} bytes from {} compressed ones; that cannot be", name, status.size,
                             status.comp_size));
        }
        const std::unique_ptr<zip_file_t, int (*)(zip_file_t*)> stream(zip_fopen(archive_.get(), name, 0),
                                                                       &zip_fclose);
        if (!stream) {
            fail(fmt::format("{}: {}", name, zip_strerror(archive_.get())));
        }
        return {read_all(*stream, name, status.size), fmt::format("{}: {}", file_, name)};
    }

    std::string read_all(zip_file_t& stream, const char* name, std::uint64_t size) const {
        std::string bytes(size + 1, '\0'); // one more: the checksum is tested at the end only
        std::size_t used = 0;
        for (;;) {
            const zip_int64_t got = zip_fread(&stream, bytes.data() + used, bytes.size() - used);
            if (got < 0) {
                fail(fmt::format("{}: {}", name, zip_error_strerror(zip_file_get_error(&stream))));
            }
            used += static_cast<std::size_t>(got);
            if (got == 0 || used > size) {
                break;
            }
        }
        if (used != size) {
            fail(fmt::format("{}: not the {} bytes that the archive promises", name, size));
        }
        bytes.resize(size);
        return bytes;
    }

    [[noreturn]] void fail(const std::string& message) const {
        throw InputError(fmt::format("{}: {}", file_, message));
    }

    std::string file_;
    std::unique_ptr<zip_t, void (*)(zip_t*)> archive_;
};

} // namespace

void write_npz(const std::filesystem::path& path, const FormFactorMatrix& factors) {
    require_all_known(factors, "an .npz file");
    const std::uint64_t rows = factors.size();
    OutputFile file(path);
    ZipWriter zip(file);
    add_array(zip, "indices.npy", "<i4", shape_of(factors.entries()), [&](const ZipWriter::Sink& sink) {
        for (const RowBlock& block : factors.blocks()) {
            sink(std::as_bytes(std::span(block.columns)));
        }
    });
    add_array(zip, "indptr.npy", "<i8", shape_of(rows + 1),
              [&](const ZipWriter::Sink& sink) { row_offsets(factors, sink); });
    add_array(zip, "format.npy", "|S3", "()",
              [](const ZipWriter::Sink& sink) { sink(std::as_bytes(std::span("csr", 3))); });
    const std::int64_t shape[2] = {static_cast<std::int64_t>(rows), static_cast<std::int64_t>(rows)};
    add_array(zip, "shape.npy", "<i8", "(2,)",
              [&](const ZipWriter::Sink& sink) { sink(std::as_bytes(std::span(shape))); });
    add_array(zip, "data.npy", "<f4", shape_of(factors.entries()), [&](const ZipWriter::Sink& sink) {
        for (const RowBlock& block : factors.blocks()) {
            sink(std::as_bytes(std::span(block.values)));
        }
    });
    zip.finish();
    file.commit();
}

FormFactorMatrix read_npz(const std::filesystem::path& path) {
    return NpzReader(path).read();
}

} // namespace hemi::io
