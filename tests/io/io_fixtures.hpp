#pragma once

#include "hemi/core/error.hpp"
#include "hemi/io/factor_file.hpp"
#include "hemi/io/output_file.hpp"

#include <catch2/catch.hpp>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <random>
#include <string>
#include <typeinfo>
#include <unistd.h>
#include <vector>

namespace hemi::io_test {

/// A new directory, removed with all in it at the end.
class Folder {
public:
    Folder() {
        std::string name = (std::filesystem::temp_directory_path() / "hemi-io-XXXXXX").string();
        REQUIRE(::mkdtemp(name.data()) != nullptr);
        path_ = name;
    }
    ~Folder() {
        std::error_code ignored;
        std::filesystem::remove_all(path_, ignored);
    }
    Folder(const Folder&) = delete;
    Folder& operator=(const Folder&) = delete;

    std::filesystem::path operator/(const std::string& name) const { return path_ / name; }

    std::filesystem::path write(const std::string& name, const std::string& text) const {
        std::ofstream(path_ / name, std::ios::binary) << text;
        return path_ / name;
    }
    [[nodiscard]] std::size_t files() const {
        return static_cast<std::size_t>(
            std::distance(std::filesystem::directory_iterator(path_), std::filesystem::directory_iterator()));
    }

private:
    std::filesystem::path path_;
};

/// The message of the `Expected` that `work` throws. Other exceptions, and none, fail the test.
template <class Expected, class Work>
std::string message_of(const Work& work) {
    try {
        work();
    } catch (const Expected& error) {
        return error.what();
    } catch (const std::exception& error) {
        FAIL("another exception than expected, " << typeid(error).name() << ": " << error.what());
    }
    FAIL("no exception");
    return {};
}

inline void require_parts(const std::string& message, const std::vector<std::string>& parts) {
    for (const std::string& part : parts) {
        INFO("message: " << message);
        INFO("wanted:  " << part);
        REQUIRE(message.find(part) != std::string::npos);
    }
}

/// Rows of 0 to 40 entries in random columns, over many magnitudes; with row balance, and with unknown rows
/// and visibility if asked.
inline FormFactorMatrix random_matrix(std::uint32_t size, bool all_known, bool with_visibility = false) {
    std::mt19937 random(size);
    const auto uniform = [&random] { return static_cast<double>(random()) / 4294967296.0; };
    FormFactorMatrix matrix(size);
    for (std::uint32_t first = 0; first < size; first += FormFactorMatrix::block_rows) {
        RowBlock block;
        block.first_row = first;
        block.begin = {0};
        for (std::uint32_t i = first; i < std::min(size, first + FormFactorMatrix::block_rows); ++i) {
            const bool known = all_known || uniform() < 0.7;
            for (std::uint32_t j = 0; known && j < size; ++j) {
                if (uniform() < 20.0 / size) {
                    block.columns.push_back(j);
                    block.values.push_back(static_cast<float>(std::exp(-60.0 * uniform() * uniform())));
                    if (with_visibility) {
                        block.visibility.push_back(static_cast<std::uint8_t>(256.0 * uniform()));
                    }
                }
            }
            block.begin.push_back(block.columns.size());
            block.known.push_back(known ? 1 : 0);
            block.environment.push_back(known ? uniform() / 3.0 : 0.0);
            block.blocked.push_back(known ? uniform() / 7.0 : 0.0);
        }
        matrix.set_block(std::move(block));
    }
    return matrix;
}

/// Bit for bit the same entries.
inline void require_same_entries(const FormFactorMatrix& a, const FormFactorMatrix& b) {
    REQUIRE(a.size() == b.size());
    for (std::size_t k = 0; k < a.blocks().size(); ++k) {
        const RowBlock one = a.block(k);
        const RowBlock other = b.block(k);
        REQUIRE(one.begin == other.begin);
        REQUIRE(one.columns == other.columns);
        REQUIRE(one.values == other.values);
        REQUIRE(one.visibility == other.visibility);
    }
}

} // namespace hemi::io_test
