#include "benchmark/report.hpp"

#include "hemi/core/error.hpp"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <cstdio>
#include <fstream>
#include <utility>

namespace hemi::bench {

namespace {

template <typename... Args>
void line(fmt::format_string<Args...> format, Args&&... arguments) {
    fmt::print(format, std::forward<Args>(arguments)...);
    std::putchar('\n');
    std::fflush(stdout);
}

std::string rate(double hemicubes) {
    return fmt::format("{:.{}f}", hemicubes, hemicubes < 100.0 ? 1 : 0);
}

double megapixels(const Cell& cell) {
    return 3e-6 * cell.resolution * cell.resolution * cell.all_workers;
}

std::string bound_text(const Finding& finding) {
    if (finding.bound == Bound::none) {
        return "";
    }
    return fmt::format("target {} {:g} {}", finding.bound == Bound::at_least ? ">=" : "<=", finding.limit,
                       finding.met() ? "met" : "MISSED");
}

nlohmann::json to_json(const Cell& cell) {
    return {{"scene", cell.scene},
            {"patches", cell.patches},
            {"resolution", cell.resolution},
            {"hemicubes_per_second",
             {{"one_core", cell.one_core},
              {"one_worker", cell.one_worker},
              {"all_workers", cell.all_workers},
              {"naive", cell.naive},
              {"embree", cell.embree},
              {"monte_carlo", cell.monte_carlo}}},
            {"megapixels_per_second", megapixels(cell)},
            {"ratio_to_naive", cell.ratio}};
}

nlohmann::json to_json(const Finding& finding) {
    nlohmann::json json{{"what", finding.what}, {"value", finding.value}, {"unit", finding.unit}};
    if (finding.bound != Bound::none) {
        json[finding.bound == Bound::at_least ? "at_least" : "at_most"] = finding.limit;
        json["met"] = finding.met();
    }
    return json;
}

} // namespace

Report::Report(Circumstances circumstances) : circumstances_(std::move(circumstances)) {
    line("renderer  {}", circumstances_.renderer);
    line("cores     {}", circumstances_.cores);
    line("compiler  {}, {}", HEMI_BENCH_COMPILER, HEMI_BENCH_BUILD_TYPE);
    line("settings  seed {}; medians of {} interleaved runs of {:g} s or more", circumstances_.seed,
         circumstances_.rounds, circumstances_.run_seconds);
}

void Report::table_head() const {
    line("");
    line("Hemicubes/s, sparse rows included. Naive draws all patches five times a row and reads five faces");
    line("back; one core: one context of one thread, as naive has; workers: with their processes' traffic.");
    line("Embree: 16 coherent rays at a time through the same texels, MC: as many random rays; one core "
         "each.");
    line("");
    line("{:16} {:>7} {:>4} {:>9} {:>9} {:>10} {:>9} {:>7} {:>9} {:>7} {:>7}", "scene", "patches", "res",
         "one core", "1 worker", fmt::format("{} workers", circumstances_.workers), "Mpixels/s", "naive",
         "x naive", "Embree", "MC");
}

void Report::scene(const std::string& name, std::uint32_t patches, std::size_t polygons, double naive,
                   double embree) {
    agreements_.push_back({name, patches, naive, embree});
    line("{}: {} patches on {} polygons; naive rows differ by {:.1e} of a row, Embree's by {:.1e}", name,
         patches, polygons, naive, embree);
}

void Report::cell(const Cell& cell) {
    cells_.push_back(cell);
    line("{:16} {:>7} {:>4} {:>9} {:>9} {:>10} {:>9.1f} {:>7} {:>9.1f} {:>7} {:>7}", cell.scene, cell.patches,
         cell.resolution, rate(cell.one_core), rate(cell.one_worker), rate(cell.all_workers),
         megapixels(cell), rate(cell.naive), cell.ratio, rate(cell.embree), rate(cell.monte_carlo));
}

void Report::findings_head() const {
    line("");
}

void Report::finding(const Finding& finding) {
    findings_.push_back(finding);
    const int digits = finding.value < 100.0 ? 2 : 0;
    line("{:68} {:>9.{}f} {:7} {}", finding.what, finding.value, digits, finding.unit, bound_text(finding));
}

void Report::write_json(const std::filesystem::path& file) const {
    nlohmann::json json{{"renderer", circumstances_.renderer},       {"cores", circumstances_.cores},
                        {"workers", circumstances_.workers},         {"compiler", HEMI_BENCH_COMPILER},
                        {"build_type", HEMI_BENCH_BUILD_TYPE},       {"seed", circumstances_.seed},
                        {"run_seconds", circumstances_.run_seconds}, {"rounds", circumstances_.rounds},
                        {"agreement", nlohmann::json::array()},      {"table", nlohmann::json::array()},
                        {"findings", nlohmann::json::array()}};
    for (const Agreement& agreement : agreements_) {
        json["agreement"].push_back({{"scene", agreement.scene},
                                     {"patches", agreement.patches},
                                     {"naive", agreement.naive},
                                     {"embree", agreement.embree}});
    }
    for (const Cell& one : cells_) {
        json["table"].push_back(to_json(one));
    }
    for (const Finding& one : findings_) {
        json["findings"].push_back(to_json(one));
    }
    std::ofstream stream(file);
    stream << json.dump(2) << '\n';
    stream.close();
    if (!stream) {
        throw IoError(fmt::format("{}: cannot be written", file.string()));
    }
}

} // namespace hemi::bench
