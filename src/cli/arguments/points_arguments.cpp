#include "cli/arguments/points_arguments.hpp"

#include "cli/arguments/arguments.hpp"
#include "cli/arguments/options.hpp"

namespace hemi::cli {

namespace {

double parse_absorptance(const std::string& text) {
    const double value = parse_positive("--absorptance", text);
    if (value > 1.0) {
        throw InvalidArgument(fmt::format("--absorptance {}: must be at most 1", text));
    }
    return value;
}

} // namespace

void add_point_options(CLI::App& app, PointsArguments& a) {
    a.rows.factors.estimate_error = false;
    a.scene.up_is_visible = true; // in the horizon
    Options points(app, "Points");
    auto* file = points.path("--points", "FILE.csv", a.points,
                             "columns x, y, z, and nx, ny, nz of planes; without a normal it is a sphere");
    app.add_option_function<std::vector<std::string>>(
           "--grid",
           [&a](const std::vector<std::string>& words) {
               a.grid = {words[0], parse_positive("--grid GROUP SPACING", words[1]),
                         parse_number("--grid GROUP SPACING HEIGHT", words[2])};
           },
           "a square grid above the faces of GROUP, along their normals; scene units")
        ->expected(3)
        ->option_text("GROUP SPACING HEIGHT")
        ->group("Points")
        ->excludes(file);
    points.flag("--spheres", a.spheres, "leave normals out: what small spheres get");
    points.flag("--daylight", a.daylight,
                "daylight factors, %: what the sky alone gives, over the horizontal illuminance outside");
    auto* person = points.choice<Posture>(
        "--person", "standing|seated",
        "mean radiant temperature of a person, by six planes (ISO 7726), in sun and sky, too", a.posture);
    points
        .value("--facing", "A",
               "azimuth that the person faces, degrees from +y towards +x (none: all sides alike)",
               [&a](const std::string& text) { a.facing = parse_number("--facing", text); })
        ->needs(person);
    points
        .value("--absorptance", "SHORT[,LONG]",
               "what a person absorbs of sun and sky, and of heat radiation (0.7,0.97)",
               [&a](const std::string& text) {
                   const std::vector<std::string> words = parse_list(text);
                   if (words.size() > 2) {
                       throw InvalidArgument(fmt::format(
                           "--absorptance {}: must be one number or two, such as 0.7,0.97", text));
                   }
                   a.body.short_wave = parse_absorptance(words[0]);
                   a.body.long_wave = words.size() > 1 ? parse_absorptance(words[1]) : a.body.long_wave;
               })
        ->needs(person);
    Options output(app, "Output");
    auto* out = output.path("-o,--output", "FILE", a.output,
                            "a line a point: .csv; for ParaView: .vtp; false colours of a grid: .png; - for "
                            ".csv on stdout");
    output.flag("--by-group", a.by_group, "factors to groups, too");
    output
        .value("--show", "COLUMN", "what the .png shows: a column of the .csv (the first irradiance)",
               [&a](const std::string& text) { a.show = text; })
        ->needs(out);
    output
        .value("--range", "A,B", "values of the darkest and the brightest colour (those that are there)",
               [&a](const std::string& text) {
                   const std::vector<std::string> words = parse_list(text);
                   if (words.size() != 2) {
                       throw InvalidArgument(
                           fmt::format("--range {}: must be two numbers, such as 0,500", text));
                   }
                   a.range = {parse_number("--range", words[0]), parse_number("--range", words[1])};
                   if (!(a.range->front() < a.range->back())) {
                       throw InvalidArgument(
                           fmt::format("--range {}: the first number must be below the second", text));
                   }
               })
        ->needs(out);
    output.flag("--no-legend", a.legend, "no legend below the .png", false);
    output.path("--factors", "FILE.hff", a.factors,
                "use these form factors if the file exists, else write them there");
    app.footer(
        "Examples:\n"
        "  hemi points scenes/office.json --grid floor 0.5 0.8 -o desk.csv\n"
        "  hemi points classroom.json --grid floor 0.5 0.8 --daylight --show daylight_factor -o df.png\n"
        "  hemi points room.hres --points sensors.csv --by-group");
}

} // namespace hemi::cli
