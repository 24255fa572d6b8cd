#pragma once

#include <CLI/CLI.hpp>

#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

/// What the command line says of heat.
namespace hemi::cli {

struct ExchangeArguments;
struct HeatArguments;

/// Properties of groups over those of the scene: pairs of name and value, as given.
struct HeatOptions {
    std::vector<std::pair<std::string, double>> temperature; ///< K
    std::vector<std::pair<std::string, double>> emissivity;
    std::vector<std::pair<std::string, double>> heat_flux; ///< W/m²
    std::vector<std::pair<std::string, double>> power;     ///< W
    std::optional<std::filesystem::path> table;            ///< .csv with the same by group
    std::optional<double> environment;                     ///< temperature, K
};

/// Rows from a file in place of computed ones.
struct FactorInput {
    std::optional<std::filesystem::path> factors;
    std::optional<std::filesystem::path> areas; ///< of the patches, over those of the scene
};

/// `--emissivity` and `--unit`; `--temperature` and others with `conditions`.
void add_heat_options(CLI::App& app, HeatOptions& heat, bool conditions);
/// `-o`, `--fluxes`, `--series`.
void add_heat_output(CLI::App& app, HeatArguments& a);
/// `-o` and `--min`.
void add_exchange_output(CLI::App& app, ExchangeArguments& a);
/// `--factors` and `--areas`. @return the first
CLI::Option* add_factor_input(CLI::App& app, FactorInput& input);

} // namespace hemi::cli
