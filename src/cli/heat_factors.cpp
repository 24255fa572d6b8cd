#include "cli/heat_factors.hpp"

#include "cli/factor_source.hpp"
#include "cli/output_paths.hpp"
#include "hemi/core/black_body.hpp"
#include "hemi/core/error.hpp"
#include "hemi/core/nearest_word.hpp"
#include "hemi/core/stopwatch.hpp"
#include "hemi/io/factor_file.hpp"
#include "hemi/io/scene_reader.hpp"
#include "hemi/io/table_file.hpp"
#include "hemi/matrix/repair.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>

namespace hemi::cli {

namespace {

bool is_own(const std::filesystem::path& path) {
    return extension_of(path) == ".hff";
}

std::uint32_t group_of_option(const Scene& scene, std::string_view option, const std::string& name) {
    const auto found = std::find(scene.groups.begin(), scene.groups.end(), name);
    if (found == scene.groups.end()) {
        throw InvalidArgument(fmt::format("{} {}: the scene has no such group{}", option, name,
                                          did_you_mean_or_list(name, scene.groups)));
    }
    return static_cast<std::uint32_t>(found - scene.groups.begin());
}

/// Names, each of which can be given once.
class Once {
public:
    /// Whether it is the first time.
    [[nodiscard]] bool add(const std::string& name) { return names_.insert(name).second; }

private:
    std::set<std::string> names_;
};

constexpr const char* repeated_condition =
    "this group is given a temperature, heat flux or power already; one follows from the other";
constexpr const char* repeated_emissivity = "this group is given an emissivity already";

void refuse_repeat(Once& once, std::string_view option, const std::string& name, const char* message) {
    if (!once.add(name)) {
        throw InvalidArgument(fmt::format("{} {}: {}", option, name, message));
    }
}

[[noreturn]] void fail_covered(const std::string& name, double power) {
    throw InputError(
        fmt::format("group {}: a power of {:.6g} W cannot leave: other faces cover all of it", name, power));
}

/// A condition for all of a group in place of those that it has. What is isothermal stays so by another power
/// or flux.
void set_condition(Scene& scene, std::string_view option, const std::string& name, HeatCondition condition) {
    const std::uint32_t group = group_of_option(scene, option, name);
    std::vector<HeatCondition>& conditions = scene.thermal->conditions;
    const auto index = static_cast<std::uint32_t>(conditions.size());
    bool covered = true;
    for (Surface& surface : scene.surfaces) {
        if (surface.group == group) {
            const bool was = surface.heat != no_heat && conditions[surface.heat].isothermal;
            condition.isothermal = !condition.temperature && (condition.isothermal || was);
            surface.heat = index;
            covered = false;
        }
    }
    conditions.push_back(condition);
    if (covered && condition.power.value_or(0.0) != 0.0) {
        fail_covered(name, *condition.power);
    }
}

/// Refuses powers of faces of which nothing is left where others touch them.
/// @param others  groups of which a table or an option says something else
void refuse_covered_powers(const LoadedScene& loaded, const std::set<std::string>& others) {
    std::set<std::uint32_t> left;
    for (const Surface& surface : loaded.scene.surfaces) {
        left.insert(surface.heat);
    }
    for (const Surface& surface : loaded.uncut().surfaces) {
        if (surface.heat == no_heat || left.contains(surface.heat)) {
            continue;
        }
        const double power = loaded.scene.thermal->conditions[surface.heat].power.value_or(0.0);
        const std::string& name = loaded.uncut().groups[surface.group];
        if (power != 0.0 && !others.contains(name)) {
            fail_covered(name, power);
        }
    }
}

void set_emissivity(Scene& scene, const std::string& name, double emissivity) {
    const std::uint32_t group = group_of_option(scene, "--emissivity", name);
    std::vector<std::uint32_t> copies(scene.materials.size(), no_heat);
    for (Surface& surface : scene.surfaces) {
        if (surface.group != group) {
            continue;
        }
        std::uint32_t& copy = copies[surface.material];
        if (copy == no_heat) {
            copy = static_cast<std::uint32_t>(scene.materials.size());
            Material material = scene.materials[surface.material];
            material.reflectance.assign(scene.channels.size(), 1.0 - emissivity);
            material.emissivity_table.clear();
            scene.materials.push_back(std::move(material));
        }
        surface.material = copy;
    }
}

/// What a table says of groups.
struct GroupTable {
    HeatOptions heat;
    std::vector<std::pair<std::string, std::size_t>> names; // with their lines
};

/// @param conditions  whether it may say something of temperatures and fluxes
GroupTable read_groups(const std::filesystem::path& path, bool conditions) {
    const io::TextTable table = io::read_table(path);
    GroupTable groups;
    HeatOptions& heat = groups.heat;
    Once columns;
    Once with_condition;
    Once with_emissivity;
    std::vector<std::string> known{"group", "emissivity"};
    if (conditions) {
        known.insert(known.end(), {"temperature", "heat_flux", "power"});
    }
    for (const std::string& column : table.columns) {
        if (std::find(known.begin(), known.end(), column) == known.end()) {
            throw InputError(fmt::format("{}: unknown column \"{}\"{}", path.string(), column,
                                         did_you_mean_or_list(column, known)));
        }
        if (!columns.add(column)) {
            throw InputError(fmt::format("{}: two columns \"{}\"", path.string(), column));
        }
    }
    const auto group = table.column("group");
    if (!group) {
        throw InputError(fmt::format("{}: no column \"group\"", path.string()));
    }
    for (std::size_t row = 0; row < table.rows.size(); ++row) {
        const std::string& name = table.rows[row][*group];
        groups.names.emplace_back(name, table.lines[row]);
        for (std::size_t c = 0; c < table.columns.size(); ++c) {
            const std::string& column = table.columns[c];
            if (c == *group || table.rows[row][c].empty()) {
                continue;
            }
            const double value = parse_cell(path, table, row, c, column == "temperature");
            if (column == "emissivity" && !(value > 0.0 && value <= 1.0)) {
                throw ParseError(path.string(), table.lines[row], 0,
                                 fmt::format("emissivity {}; must be above 0 and at most 1", value));
            }
            const bool of_emissivity = column == "emissivity";
            if (!(of_emissivity ? with_emissivity : with_condition).add(name)) {
                throw ParseError(
                    path.string(), table.lines[row], 0,
                    fmt::format("{}: {}", name, of_emissivity ? repeated_emissivity : repeated_condition));
            }
            (column == "temperature"  ? heat.temperature
             : column == "emissivity" ? heat.emissivity
             : column == "power"      ? heat.power
                                      : heat.heat_flux)
                .emplace_back(name, value);
        }
    }
    return groups;
}

/// What a table or the command line says, in place of what the scene has.
void set_properties(Scene& scene, const HeatOptions& heat) {
    Once with_condition;
    Once with_emissivity;
    const auto set = [&](const char* option, const auto& values, auto HeatCondition::*member) {
        for (const auto& [name, value] : values) {
            HeatCondition condition;
            condition.*member = value;
            refuse_repeat(with_condition, option, name, repeated_condition);
            set_condition(scene, option, name, condition);
        }
    };
    set("--temperature", heat.temperature, &HeatCondition::temperature);
    set("--heat-flux", heat.heat_flux, &HeatCondition::heat_flux);
    set("--power", heat.power, &HeatCondition::power);
    for (const auto& [name, value] : heat.emissivity) {
        refuse_repeat(with_emissivity, "--emissivity", name, repeated_emissivity);
        set_emissivity(scene, name, value);
    }
}

double parse_area(const std::filesystem::path& path, const io::TextTable& table, std::size_t row,
                  std::size_t column) {
    const std::string& text = table.rows[row][column];
    double value = 0.0;
    try {
        value = parse_number("area", text);
    } catch (const InvalidArgument&) {
        value = 0.0;
    }
    if (!(value > 0.0)) {
        throw ParseError(path.string(), table.lines[row], 0,
                         fmt::format("area '{}'; must be a number above 0", text));
    }
    return value;
}

/// Areas of all patches, from a table.
std::vector<double> read_areas(const std::filesystem::path& path, std::size_t patches) {
    const io::TextTable table = io::read_table(path);
    const auto column = table.column("area");
    if (!column) {
        throw InputError(fmt::format("{}: no column \"area\"{}", path.string(),
                                     did_you_mean_or_list("area", table.columns)));
    }
    if (table.rows.size() != patches) {
        throw InputError(fmt::format("{}: {}; the scene has {}", path.string(),
                                     plural(table.rows.size(), "area", "areas"),
                                     plural(patches, "patch", "patches")));
    }
    std::vector<double> areas;
    for (std::size_t row = 0; row < table.rows.size(); ++row) {
        areas.push_back(parse_area(path, table, row, *column));
    }
    return areas;
}

/// What rows of a file without balance lack goes to the environment, unless it is as good as nothing.
/// @throws InputError where a row has more than there is to see
void add_environment_shares(FormFactorMatrix& matrix, double max_row_error,
                            const std::filesystem::path& path) {
    std::vector<RowBlock> blocks = matrix.take_blocks();
    for (RowBlock& block : blocks) {
        for (std::uint32_t r = 0; r < block.rows(); ++r) {
            double sum = block.blocked[r];
            for (std::uint64_t k = block.begin[r]; k < block.begin[r + 1]; ++k) {
                sum += static_cast<double>(block.values[k]);
            }
            if (sum > 1.0 + max_row_error) {
                throw InputError(fmt::format("{}: the factors of row {} add up to {:.6g}; must be at most 1, "
                                             "or what --max-row-error allows above it",
                                             path.string(), block.first_row + r, sum));
            }
            block.environment[r] = 1.0 - sum > max_row_error ? 1.0 - sum : 0.0;
        }
        matrix.set_block(std::move(block));
    }
}

/// Form factors of another program.
FormFactors read_foreign(const FactorInput& input, const LoadedScene& loaded, double max_row_error) {
    const std::filesystem::path& path = *input.factors;
    FormFactors factors = io::read_factors(path);
    if (factors.matrix.size() != loaded.mesh.size()) {
        throw InputError(fmt::format(
            "{}: {}; the scene has {}, and these must be the same, in the same order", path.string(),
            plural(factors.matrix.size(), "row", "rows"), plural(loaded.mesh.size(), "patch", "patches")));
    }
    const std::span<const double> areas = loaded.mesh.areas();
    factors.areas.assign(areas.begin(), areas.end());
    factors.groups = loaded.mesh.groups();
    factors.group_of = loaded.group_of;
    factors.enclosure = loaded.scene.enclosure;
    factors.provenance.renderer = path.string();
    factors.work.from_file = true;
    add_environment_shares(factors.matrix, max_row_error, path);
    return factors;
}

FormFactors find_raw_rows(const CommonOptions& common, const RowOptions& rows, const FactorInput& input,
                          const LoadedScene& loaded, Observer& observer, const Terminal& terminal) {
    if (input.factors && !is_own(*input.factors)) {
        static const std::vector<std::string> of_rows{
            "--preset", "--method",     "--rays",     "--eye-points", "--shadow-rays",  "--seed",
            "--resume", "--resolution", "--no-merge", "--clusters",   "--cluster-error"};
        for (const std::string& option : common.given) {
            if (std::find(of_rows.begin(), of_rows.end(), option) != of_rows.end()) {
                throw InvalidArgument(
                    fmt::format("{} does not apply to --factors {}, which holds the rows of "
                                "another program",
                                option, input.factors->string()));
            }
        }
        return read_foreign(input, loaded, rows.max_row_error);
    }
    SolveArguments arguments; // as `solve` takes rows from a file, or writes them there
    arguments.common = common;
    arguments.rows = rows;
    arguments.factors = input.factors;
    const std::vector<std::uint32_t> patches = all_patches(loaded.mesh.size());
    FormFactors factors =
        with_checkpoint(input.factors, rows.resume, terminal, [&](RowCheckpoint* checkpoint) {
            return find_rows(arguments, loaded, patches, observer, terminal, checkpoint);
        });
    if (!factors.matrix.all_known()) {
        throw InputError(
            fmt::format("{}: rows are missing; those of all patches are needed", input.factors->string()));
    }
    return factors;
}

} // namespace

double parse_cell(const std::filesystem::path& path, const io::TextTable& table, std::size_t row,
                  std::size_t column, bool temperature) {
    const std::string& text = table.rows[row][column];
    const auto fail = [&](const char* wanted) {
        throw ParseError(path.string(), table.lines[row], 0,
                         fmt::format("{} '{}'; must be {}", table.columns[column], text, wanted));
    };
    const std::optional<double> value = parse_temperature(text);
    const bool bare = text.find_first_of("KC") == std::string::npos;
    if (!value || !(temperature || bare)) {
        fail(temperature ? "kelvin, or with a unit such as 20C" : "a number");
    }
    if (temperature && *value < 0.0) {
        fail("at least 0 K");
    }
    return *value;
}

LoadedScene load_thermal_scene(std::string_view command, SceneOptions options, const FactorInput& input,
                               const HeatOptions& heat, bool conditions, const Terminal& terminal) {
    if (!io::is_scene_file(options.path)) {
        throw InvalidArgument(
            fmt::format("{}: {} needs a scene ({})", options.path.string(), command, io::scene_extensions()));
    }
    GroupTable table;
    if (heat.table) {
        table = read_groups(*heat.table, conditions);
    }
    options.imprint = options.imprint && (!input.factors || is_own(*input.factors));
    LoadedScene loaded = load_scene(options, terminal);
    if (input.factors && is_own(*input.factors)) {
        adopt_mesh_of_rows(loaded, options, *input.factors);
    }
    Scene& scene = loaded.scene;
    if (!scene.thermal) {
        scene.thermal.emplace();
    }
    for (const auto& [name, line] : table.names) {
        if (std::find(scene.groups.begin(), scene.groups.end(), name) == scene.groups.end()) {
            throw ParseError(heat.table->string(), line, 0,
                             fmt::format("{}: the scene has no such group{}", name,
                                         did_you_mean_or_list(name, scene.groups)));
        }
    }
    if (conditions) {
        std::set<std::string> others;
        for (const HeatOptions* said : {&std::as_const(table.heat), &heat}) {
            for (const auto* values : {&said->temperature, &said->heat_flux, &said->power}) {
                for (const auto& [name, value] : *values) {
                    others.insert(name);
                }
            }
        }
        refuse_covered_powers(loaded, others);
    }
    set_properties(scene, table.heat);
    set_properties(scene, heat); // over those of the table
    if (heat.environment) {
        scene.thermal->environment_temperature = heat.environment;
    }
    return loaded;
}

FormFactors find_heat_rows(const CommonOptions& common, const RowOptions& rows, const FactorInput& input,
                           const LoadedScene& loaded, Observer& observer, const Terminal& terminal,
                           Seconds& seconds) {
    const Stopwatch rows_watch;
    FormFactors factors = find_raw_rows(common, rows, input, loaded, observer, terminal);
    seconds["estimate"] = factors.work.reference_seconds;
    seconds["factors"] = rows_watch.seconds() - factors.work.reference_seconds;
    const Stopwatch repair_watch;
    if (input.areas) {
        factors.areas = read_areas(*input.areas, loaded.mesh.size());
    }
    prepare_form_factors(factors, rows.factors.repair, observer);
    if (factors.matrix.clusters() != nullptr) { // whose exchange is made symmetric as it is
        seconds["repair"] = repair_watch.seconds();
        return factors;
    }
    const Reciprocity pairs = reciprocity(factors.matrix, factors.areas);
    if (!is_reciprocal(pairs)) {
        if (rows.factors.repair == Repair::none) {
            throw InvalidArgument(
                fmt::format("--repair none: heat exchange needs reciprocal rows, and F of "
                            "patches {} and {} differs by {:.3g} after weighting with their "
                            "areas; use --repair reciprocity or closure",
                            pairs.worst_i, pairs.worst_j, pairs.max));
        }
        terminal.warn(
            fmt::format("the rows are not reciprocal (F of patches {} and {} differs by {:.3g} after "
                        "weighting with their areas): both directions are averaged; --repair closure "
                        "closes the rows too",
                        pairs.worst_i, pairs.worst_j, pairs.max));
        factors.repair.reset();
        prepare_form_factors(factors, Repair::reciprocity);
    }
    seconds["repair"] = repair_watch.seconds();
    return factors;
}

void check_factor_input(Outputs& outputs, const FactorInput& input) {
    if (input.factors) {
        std::error_code unknown; // a name that no file can have
        if (!is_own(*input.factors)) {
            if (!io::factor_content(*input.factors)) {
                throw InvalidArgument(
                    fmt::format("--factors {}: must be a file of form factors, such as .hff, "
                                ".npz, .mtx or .csv",
                                input.factors->string()));
            }
            outputs.keep(*input.factors);
        } else if (std::filesystem::is_regular_file(*input.factors, unknown)) {
            outputs.keep(*input.factors);
        } else {
            outputs.add("--factors", *input.factors, {".hff"});
        }
    }
    if (input.areas) {
        if (!input.factors || is_own(*input.factors)) {
            throw InvalidArgument("--areas is for form factors of other programs; .hff files have areas");
        }
        outputs.keep(*input.areas);
    }
}

} // namespace hemi::cli
