#include "cli/arguments/heat_arguments.hpp"

#include "cli/arguments/arguments.hpp"
#include "cli/arguments/options.hpp"
#include "cli/arguments/picture_arguments.hpp"
#include "hemi/core/black_body.hpp"

namespace hemi::cli {

namespace {

using Values = std::vector<std::pair<std::string, double>>;

double parse_kelvin(const std::string& option, const std::string& text) {
    const auto kelvin = parse_temperature(text);
    if (!kelvin) {
        throw InvalidArgument(
            fmt::format("{} '{}': must be kelvin, or with a unit such as 20C or 300K", option, text));
    }
    if (*kelvin < 0.0) {
        throw InvalidArgument(fmt::format("{} '{}': {} K; must not be below 0 K", option, text, *kelvin));
    }
    return *kelvin;
}

/// A repeatable GROUP=VALUE. The name may have "=" in it, the value not.
template <class Parse>
void add_values(CLI::App& app, const std::string& name, const std::string& form, const std::string& help,
                Values& target, const Parse& parse) {
    app.add_option_function<std::vector<std::string>>(
           name,
           [name, form, parse, &target](const std::vector<std::string>& all) {
               for (const std::string& text : all) {
                   const std::size_t equals = text.rfind('=');
                   if (equals == std::string::npos || equals == 0) {
                       throw InvalidArgument(fmt::format("{} '{}': must be {}", name, text, form));
                   }
                   target.emplace_back(text.substr(0, equals), parse(name, text.substr(equals + 1)));
               }
           },
           help)
        ->allow_extra_args(false)
        ->option_text(form)
        ->group("Heat");
}

} // namespace

void add_heat_options(CLI::App& app, HeatOptions& heat, bool conditions) {
    Options options(app, "Heat");
    if (conditions) {
        add_values(app, "--temperature", "GROUP=T", "temperature of a group, K or such as 20C; repeatable",
                   heat.temperature, parse_kelvin);
    }
    add_values(app, "--emissivity", "GROUP=E", "emissivity of a group, above 0 and at most 1; repeatable",
               heat.emissivity, [](const std::string& option, const std::string& text) {
                   const double value = parse_number(option, text);
                   if (!(value > 0.0 && value <= 1.0)) {
                       throw InvalidArgument(
                           fmt::format("{} '{}': must be above 0 and at most 1", option, text));
                   }
                   return value;
               });
    const auto number = [](const std::string& option, const std::string& text) {
        return parse_number(option, text);
    };
    if (conditions) {
        add_values(app, "--heat-flux", "GROUP=Q",
                   "net flux of a group, W/m², leaving positive; 0: adiabatic; repeatable", heat.heat_flux,
                   number);
        add_values(app, "--power", "GROUP=P", "net power of a group, W; repeatable", heat.power, number);
        options.value("--environment-temperature", "T",
                      "temperature of the environment, K or such as 20C; overrides the scene",
                      [&heat](const std::string& text) {
                          heat.environment = parse_kelvin("--environment-temperature", text);
                      });
    }
    options.path("--groups", "FILE.csv", heat.table,
                 conditions
                     ? "the same from a table: columns group, emissivity, temperature, heat_flux, power"
                     : "the same from a table: columns group, emissivity");
}

CLI::Option* add_factor_input(CLI::App& app, FactorInput& input) {
    Options options(app, "Form factors");
    auto* factors = options.path(
        "--factors", "FILE", input.factors,
        "use these form factors: .hff (written if it does not exist), or of any program .mtx .csv .npz .dat "
        ".bin .txt .vf with the scene's patches in their order");
    options
        .path("--areas", "FILE.csv", input.areas,
              "with --factors: areas of the patches in place of the scene's, column \"area\"")
        ->needs(factors);
    return factors;
}

void add_heat_output(CLI::App& app, HeatArguments& a) {
    Options output(app, "Output");
    auto* file = output.path("-o,--output", "FILE", a.output,
                             "temperature, fluxes, irradiation and radiosity of every patch, for ParaView: "
                             ".vtp; or a picture: .png; with --series what comes of its lines: .csv");
    output.path("--fluxes", "FILE.csv", a.fluxes, "the same as a table; - for stdout");
    output.path("--result", "FILE.hres", a.result,
                "the whole solution, for info, render, diff, view and points");
    output.path("--series", "FILE.csv", a.series,
                "solve for every line of this table: a time, and a column of temperatures (or fluxes, or "
                "powers, where the scene has these) for every group named in its first line");
    a.picture.options = add_heat_picture(app, a.picture, file, a.scene);
    app.parse_complete_callback(
        [&a] { a.scene.up_is_visible = a.output && a.output->extension() == ".png"; });
}

void add_exchange_output(CLI::App& app, ExchangeArguments& a) {
    Options output(app, "Output");
    output.path("-o,--output", "FILE", a.output,
                "Gebhart factor, script-F and conductance of every pair: .csv, NumPy's .npz; script-F in "
                "View3D's .txt; - for .csv on stdout");
    output.value("--min", "M2",
                 "leave out conductances below this, m², and give what they carried to the others",
                 [&a](const std::string& text) { a.min = parse_positive("--min", text); });
}

} // namespace hemi::cli
