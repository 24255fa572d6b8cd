#include "cli/arguments/row_arguments.hpp"

#include "cli/arguments/arguments.hpp"
#include "cli/arguments/option_values.hpp"
#include "cli/arguments/options.hpp"
#include "hemi/core/error.hpp"
#include "hemi/engine/engine.hpp"

#include <fmt/format.h>

#include <limits>

namespace hemi::cli {

namespace {

using Words = std::vector<std::string>;

} // namespace

void add_device(CLI::App& app, std::string& device, bool rows) {
    Options(app, "Computing")
        .value("--device", "NAME",
               rows ? "auto, cpu, egl, egl:N or osmesa; see `hemi devices`"
                    : "auto, egl, egl:N or osmesa; see `hemi devices`",
               [&device, rows](const std::string& text) {
                   const bool numbered = text.starts_with("egl:");
                   if (numbered) {
                       (void)parse_whole("--device egl:", text.substr(4), 0, 1000);
                   } else {
                       (void)parse_choice("--device", text,
                                          rows ? Words{"auto", "cpu", "egl", "egl:N", "osmesa"}
                                               : Words{"auto", "egl", "egl:N", "osmesa"});
                       if (text == "egl:N") {
                           throw InvalidArgument("--device egl:N: N stands for a number, such as egl:0");
                       }
                   }
                   device = text;
               })
        ->type_name(rows ? "auto|cpu|egl|osmesa" : "auto|egl|osmesa");
}

void add_drawing(CLI::App& app, RowOptions& rows) {
    Options options(app, "Form factors");
    options.value(
        "--seed", "N", "seed of the rotation of every hemicube (0)", [&rows](const std::string& text) {
            rows.factors.seed = parse_whole("--seed", text, 0, std::numeric_limits<std::uint64_t>::max());
        });
    options.flag("--no-merge", rows.factors.merge_lattices,
                 "draw every patch separately, even in coplanar lattices", false);
    add_device(app, rows.factors.engine.device, true);
    Options(app, "Computing")
        .value("--jobs", "N", "threads on cpu, worker processes on OpenGL (one per core; on a GPU four)",
               [&rows](const std::string& text) {
                   rows.factors.engine.jobs = parse_index("--jobs", text, 1, 1024);
               });
}

void add_rows(CLI::App& app, RowOptions& rows) {
    Options options(app, "Form factors");
    options.choice<Preset>("--preset", "NAME",
                           "fast, default or exact: unoccluded factors times visibility; plain: the textbook "
                           "hemicube",
                           rows.factors.preset);
    options.choice<Method>("--method", "NAME",
                           "hemicube (the default); baseline methods, all slow: direct and contour (both "
                           "unoccluded), montecarlo, hemisphere",
                           rows.factors.method);
    options.value(
        "--rays", "N", "montecarlo: rays a patch, best a power of two (16384)",
        [&rows](const std::string& text) { rows.factors.rays = parse_index("--rays", text, 1, 1u << 31); });
    options.value("--eye-points", "K", "sample points per patch: 1, 4, 9 ... 64 (as the preset says)",
                  [&rows](const std::string& text) {
                      rows.factors.eye_points = parse_index("--eye-points", text, 1);
                      check_eye_points(*rows.factors.eye_points);
                  });
    options.value("--resolution", "R",
                  "texels along a full hemicube edge: even, 2 to 4096 (as the preset says; plain: 128)",
                  [&rows](const std::string& text) {
                      rows.factors.resolution = parse_index("--resolution", text, 2, 4096);
                      if (*rows.factors.resolution % 2 != 0) {
                          throw InvalidArgument(fmt::format("--resolution {}: must be even, for example {}",
                                                            text, *rows.factors.resolution + 1));
                      }
                  });
    options.value("--shadow-rays", "N",
                  "rays between patches that partly see each other, 0 to 4096 (as the preset says)",
                  [&rows](const std::string& text) {
                      rows.factors.shadow_rays = parse_index("--shadow-rays", text, 0, 4096);
                  });
    add_drawing(app, rows);
}

RowSelection parse_rows(const std::string& text) {
    const std::size_t mark = text.find_first_of(":/");
    if (mark == std::string::npos) {
        throw InvalidArgument(
            fmt::format("--rows {}: must be A:B, rows A to B - 1 from 0, or K/N, the K-th of "
                        "N shares",
                        text));
    }
    RowSelection rows;
    rows.shares = text[mark] == '/';
    rows.first = parse_index("--rows", text.substr(0, mark), rows.shares ? 1 : 0);
    rows.second = parse_index("--rows", text.substr(mark + 1), 1);
    if (rows.shares ? rows.first > rows.second : rows.first >= rows.second) {
        throw InvalidArgument(fmt::format("--rows {}: {} must be {} {}", text, rows.first,
                                          rows.shares ? "at most" : "below", rows.second));
    }
    return rows;
}

} // namespace hemi::cli
