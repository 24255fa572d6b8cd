#include "hemi/io/exchange_file.hpp"

#include "hemi/core/error.hpp"
#include "hemi/io/output_file.hpp"
#include "io/factors/npy.hpp"
#include "io/formats/text_output.hpp"
#include "io/formats/text_scan.hpp"
#include "io/formats/zip_writer.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <string_view>
#include <vector>

namespace hemi::io {

namespace {

void check_sizes(const ExchangeTables& tables) {
    const std::size_t groups = tables.groups.size();
    for (const std::span<const double> values : {tables.areas, tables.emissivity, tables.environment}) {
        if (values.size() != groups) {
            throw InvalidArgument(fmt::format("{} values for {} groups", values.size(), groups));
        }
    }
    for (const std::span<const double> values : {tables.gebhart, tables.script_f, tables.conductance}) {
        if (values.size() != groups * groups) {
            throw InvalidArgument(
                fmt::format("{} values for {} pairs of groups", values.size(), groups * groups));
        }
    }
}

/// Code points.
std::u32string code_points(std::string_view name) {
    std::u32string result;
    for (const char byte : to_utf8(name)) {
        const auto bits = static_cast<unsigned char>(byte);
        if ((bits & 0xC0u) == 0x80u) {
            result.back() = (result.back() << 6u) | (bits & 0x3Fu);
        } else {
            const unsigned mask = bits < 0x80u ? 0x7Fu : bits < 0xE0u ? 0x1Fu : bits < 0xF0u ? 0x0Fu : 0x07u;
            result.push_back(bits & mask);
        }
    }
    return result;
}

void add_bytes(ZipWriter& zip, const std::string& name, std::string_view type, std::string_view shape,
               std::span<const std::byte> bytes) {
    const std::string header = npy_header(type, shape);
    zip.add(name + ".npy", [&](const ZipWriter::Sink& sink) {
        sink(std::as_bytes(std::span(header)));
        sink(bytes);
    });
}

/// NumPy's text is of one length, filled up with zeros.
void add_names(ZipWriter& zip, std::span<const std::string> names) {
    std::vector<std::u32string> all;
    std::size_t longest = 1;
    for (const std::string& name : names) {
        all.push_back(code_points(name));
        longest = std::max(longest, all.back().size());
    }
    std::u32string text;
    for (std::u32string& name : all) {
        name.resize(longest, U'\0');
        text += name;
    }
    add_bytes(zip, "groups", fmt::format("<U{}", longest), fmt::format("({},)", names.size()),
              std::as_bytes(std::span(text)));
}

} // namespace

void write_exchange_npz(const std::filesystem::path& path, const ExchangeTables& tables) {
    check_sizes(tables);
    OutputFile file(path);
    ZipWriter zip(file);
    const std::size_t groups = tables.groups.size();
    const std::string vector = fmt::format("({},)", groups);
    const std::string matrix = fmt::format("({}, {})", groups, groups);
    add_names(zip, tables.groups);
    add_bytes(zip, "areas", "<f8", vector, std::as_bytes(tables.areas));
    add_bytes(zip, "emissivity", "<f8", vector, std::as_bytes(tables.emissivity));
    add_bytes(zip, "gebhart", "<f8", matrix, std::as_bytes(tables.gebhart));
    add_bytes(zip, "script_f", "<f8", matrix, std::as_bytes(tables.script_f));
    add_bytes(zip, "conductance", "<f8", matrix, std::as_bytes(tables.conductance));
    add_bytes(zip, "environment", "<f8", vector, std::as_bytes(tables.environment));
    zip.finish();
    file.commit();
}

void write_exchange_view3d(const std::filesystem::path& path, const ExchangeTables& tables) {
    check_sizes(tables);
    const std::size_t groups = tables.groups.size();
    TextOutput output(path);
    // Program, version, text, enclosure, reflection, N: filled up to 30 characters, as View3D's readers take
    // it.
    output.print(FMT_COMPILE("{:<30}\n"), fmt::format("hemi {} 0 {} 1 {}", HEMI_VERSION,
                                                      tables.enclosure == Enclosure::closed ? 1 : 0, groups));
    const auto line = [&output](std::span<const double> values) {
        for (std::size_t k = 0; k < values.size(); ++k) {
            output.print(FMT_COMPILE("{}{}"), k == 0 ? "" : " ", values[k]);
        }
        output.print(FMT_COMPILE("\n"));
    };
    line(tables.areas);
    for (std::size_t g = 0; g < groups; ++g) {
        line(tables.script_f.subspan(g * groups, groups));
    }
    line(tables.emissivity);
    output.commit();
}

} // namespace hemi::io
