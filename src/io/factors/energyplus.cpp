#include "hemi/core/error.hpp"
#include "hemi/io/factor_file.hpp"
#include "hemi/matrix/balance.hpp"
#include "io/factors/triples.hpp"
#include "io/formats/text_output.hpp"
#include "io/formats/text_scan.hpp"

#include <algorithm>
#include <cmath>
#include <map>

namespace hemi::io {

namespace {

constexpr std::size_t longest_name = 100; // EnergyPlus' own limit
constexpr double complete = 1e-3;         // what a row may lose without a warning

/// @param what  the name is of, for the message
void check_name(const std::string& name, const std::string& what) {
    if (name.empty() || name.size() > longest_name || name.find_first_of(",;!\r\n") != std::string::npos ||
        trim(name) != name) {
        throw InvalidArgument(
            fmt::format("{} {}: EnergyPlus' names have 1 to {} characters without , ; ! and "
                        "line ends, and no outer blanks; rename it",
                        what, in_quotes(name), longest_name));
    }
}

void check_groups(const std::vector<std::string>& groups) {
    std::map<std::string, std::string> seen;
    for (const std::string& name : groups) {
        check_name(name, "group");
        std::string lower = name;
        std::transform(lower.begin(), lower.end(), lower.begin(),
                       [](char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c; });
        const auto [entry, is_new] = seen.emplace(lower, name);
        if (!is_new) {
            throw InvalidArgument(fmt::format("groups {} and {} are one name to EnergyPlus; rename one",
                                              in_quotes(entry->second), in_quotes(name)));
        }
    }
}

/// Groups without patches have no factors, and no place in the file.
std::vector<std::uint32_t> groups_with_patches(const GroupFactors& groups) {
    std::vector<std::uint32_t> used;
    for (std::uint32_t g = 0; g < groups.groups; ++g) {
        if (groups.areas[g] > 0.0) {
            used.push_back(g);
        }
    }
    return used;
}

/// @param used  groups that are in the file
void warn_of_open_rows(const GroupFactors& groups, const std::vector<std::uint32_t>& used,
                       const std::vector<std::string>& names, Diagnostics& diagnostics) {
    std::uint32_t open = 0;
    std::uint32_t worst = used.empty() ? 0 : used[0];
    const auto lost = [&groups](std::uint32_t g) { return groups.environment[g] + groups.blocked[g]; };
    for (const std::uint32_t g : used) {
        open += lost(g) > complete ? 1 : 0;
        worst = lost(g) > lost(worst) ? g : worst;
    }
    if (open > 0) {
        diagnostics.warn(
            fmt::format("EnergyPlus takes a zone for closed and changes rows that do not sum to 1: "
                        "{} groups do not, {} loses {:.3g}",
                        open, in_quotes(names[worst]), lost(worst)));
    }
}

} // namespace

void write_energyplus(const std::filesystem::path& path, const FormFactors& file, Diagnostics& diagnostics,
                      const std::string& zone_name) {
    require_all_known(file.matrix, "an EnergyPlus file");
    const std::string zone = zone_name.empty() ? to_utf8(path.stem().string()) : zone_name;
    check_name(zone, "zone");
    check_groups(file.groups);
    const GroupFactors groups =
        group_factors(file.matrix, file.areas, file.group_of, static_cast<std::uint32_t>(file.groups.size()));
    const std::vector<std::uint32_t> used = groups_with_patches(groups);
    warn_of_open_rows(groups, used, file.groups, diagnostics);
    TextOutput output(path);
    output.print(
        FMT_COMPILE("! View factors by hemi {}: from surface, to surface, share of what leaves the first "
                    "that arrives at the second.\n"
                    "ZoneProperty:UserViewFactors:BySurfaceName,\n  {},  !- Zone Name\n"),
        HEMI_VERSION, zone);
    for (const std::uint32_t from : used) {
        for (const std::uint32_t to : used) {
            const bool last = from == used.back() && to == used.back();
            output.print(FMT_COMPILE("  {},{},{:.9g}{}\n"), file.groups[from], file.groups[to],
                         groups.factors[std::size_t{from} * groups.groups + to], last ? ';' : ',');
        }
    }
    output.commit();
}

} // namespace hemi::io
