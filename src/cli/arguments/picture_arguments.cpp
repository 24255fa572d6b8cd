#include "cli/arguments/picture_arguments.hpp"

#include "cli/arguments/arguments.hpp"
#include "cli/arguments/options.hpp"
#include "hemi/core/error.hpp"

#include <fmt/format.h>

#include <string>
#include <utility>
#include <vector>

namespace hemi::cli {

namespace {

/// Size, camera and what is drawn beside the patches.
/// @param scene  whose sky `--up` is of, too; may be none
/// @return all of them, but for `--up` of a scene, which does without a picture
std::vector<CLI::Option*> add_drawn(CLI::App& app, PictureOptions& picture, SceneOptions* scene) {
    std::vector<CLI::Option*> added;
    Options options(app, "Picture");
    added.push_back(options.value(
        "--size", "WxH",
        fmt::format("size in pixels, or HD, or 4K ({}x{})", picture.size[0], picture.size[1]),
        [&picture](const std::string& text) { picture.size = parse_picture_size("--size", text); }));
    added.push_back(options.value(
        "--camera", "EYE:TARGET[:UP][:FOV]", "camera, such as 0,-3,1:0,0,1:0,0,1:40 (scene units, degrees)",
        [&picture](const std::string& text) { picture.camera = parse_camera("--camera", text); }));
    CLI::Option* const up = options.choice<UpAxis>(
        "--up", "y|z",
        fmt::format("axis that points upwards {}(glTF: y; OBJ: by its faces; others: z)",
                    scene != nullptr ? "in the picture and the sky " : "in the picture "),
        [&picture, scene](UpAxis axis) {
            picture.up = axis;
            if (scene != nullptr) {
                scene->reader.up = axis;
            }
        });
    if (scene == nullptr) {
        added.push_back(up);
    }
    options.flag("--orthographic", picture.orthographic, "parallel rays, at the scale of the target's depth");
    options.flag("--outlines", picture.outlines, "draw outlines of patches");
    options.flag("--backs", picture.backs, "show the backs of one-sided surfaces, striped");
    options.groups("--hide", picture.hidden_groups,
                   "leave GROUP out of the picture, not out of the light; repeatable");
    options.groups("--outlines-of", picture.outlined_groups,
                   "draw of GROUP only the outlines of its patches; repeatable");
    for (const char* name : {"--orthographic", "--outlines", "--backs", "--hide", "--outlines-of"}) {
        added.push_back(app.get_option(name));
    }
    added.push_back(options.value("--clip", "PLANE",
                                  "show only one side of a plane, such as 'x<1.5', 'z>0' or '0.6,0.8,0<1.5'",
                                  [&picture](const std::string& text) {
                                      try {
                                          picture.clip = parse_clip_plane(text);
                                      } catch (const InvalidArgument& error) {
                                          throw InvalidArgument(fmt::format("--clip {}", error.what()));
                                      }
                                  }));
    added.push_back(
        options.value("--background", "COLOUR",
                      "where no surface is: environment (the default), black, white, grey or #RRGGBB",
                      [&picture](const std::string& text) {
                          picture.background.reset();
                          if (text != "environment") {
                              picture.background = parse_colour("--background", text);
                          }
                      }));
    added.push_back(options.value("--samples", "N", "supersamples along each edge of a pixel, 1 to 8 (4)",
                                  [&picture](const std::string& text) {
                                      picture.samples =
                                          static_cast<std::uint32_t>(parse_whole("--samples", text, 1, 8));
                                  }));
    return added;
}

/// @param known  whether a quantity is one of them
std::vector<std::string> quantity_words(bool (*known)(Quantity)) {
    std::vector<std::string> words;
    for (const auto& [quantity, word] : Names<Quantity>::table) {
        if (known(quantity)) {
            words.emplace_back(word);
        }
    }
    return words;
}

bool is_of_light(Quantity quantity) {
    return !is_of_heat(quantity);
}

bool is_any(Quantity) {
    return true;
}

/// `heat` estimates errors of groups, not of patches.
bool is_known_of_heat(Quantity quantity) {
    return !is_error(quantity);
}

/// How quantities are shown in false colours. @return all of them
std::vector<CLI::Option*> add_quantities(CLI::App& app, PictureOptions& picture, bool logarithmic = true) {
    std::vector<CLI::Option*> added;
    Options options(app, "Picture");
    const auto given = [&picture](const char* name) { picture.of_quantities.emplace_back(name); };
    added.push_back(options.value("--channel", "NAME",
                                  "of a quantity: a channel, mean (the default), sum or luminance",
                                  [&picture, given](const std::string& text) {
                                      picture.channel = text;
                                      given("--channel");
                                  }));
    added.push_back(options.value(
        "--range", "A,B", "values of the first and the last colour",
        [&picture, given](const std::string& text) {
            const std::vector<std::string> ends = parse_list(text);
            if (ends.size() != 2) {
                throw InvalidArgument(fmt::format("--range {}: must be two numbers, such as 0,500", text));
            }
            picture.range = {parse_number("--range", ends[0]), parse_number("--range", ends[1])};
            given("--range");
        }));
    added.push_back(options.choice<ColourMap>(
        "--map", "NAME", fmt::format("viridis, inferno, turbo, cool-warm or grey ({})", to_word(picture.map)),
        [&picture, given](ColourMap map) {
            picture.map = map;
            given("--map");
        }));
    added.push_back(options.value("--bands", "N", "colours in N equal steps, 2 to 32, instead of smooth ones",
                                  [&picture, given](const std::string& text) {
                                      picture.bands =
                                          static_cast<std::uint32_t>(parse_whole("--bands", text, 2, 32));
                                      given("--bands");
                                  }));
    options.flag("--iso-lines", picture.iso_lines,
                 "lines of equal values: where bands end, or else at round values");
    added.push_back(app.get_option("--iso-lines"));
    if (logarithmic) {
        options.flag("--log", picture.logarithmic, "equal steps of colour are equal ratios");
        added.push_back(app.get_option("--log"));
    }
    options.flag("--no-legend", picture.legend, "no legend in the picture", false);
    added.push_back(app.get_option("--no-legend"));
    return added;
}

CLI::Option* add_celsius(CLI::App& app, PictureOptions& picture) {
    Options(app, "Picture")
        .flag("--celsius", picture.celsius,
              "temperatures of the picture's legend and range in °C instead of K");
    return app.get_option("--celsius");
}

} // namespace

std::vector<CLI::Option*> add_shown(CLI::App& app, PictureOptions& picture, bool quantities, bool heat) {
    Options options(app, "Picture");
    std::vector<CLI::Option*> added;
    added.push_back(options.value(
        "--show", quantities ? "A,B,C|QUANTITY" : "A,B,C",
        quantities
            ? fmt::format("channels shown as red, green, blue; or one, as grey; or in false colours: {}",
                          fmt::join(quantity_words(heat ? is_any : is_of_light), ", "))
            : "channels shown as red, green, blue; or one, as grey",
        [&picture, quantities](const std::string& text) {
            picture.show = parse_list(text);
            picture.quantity = quantities ? from_word<Quantity>(text) : std::nullopt;
        }));
    options.flag("--flat", picture.flat, "one colour a patch instead of smooth shading");
    added.push_back(app.get_option("--flat"));
    added.push_back(options.value("--exposure", "X", "factor on radiosity, or auto (the default)",
                                  [&picture](const std::string& text) {
                                      picture.exposure.reset();
                                      if (text != "auto") {
                                          picture.exposure = parse_positive("--exposure", text);
                                      }
                                  }));
    return added;
}

void add_dots(CLI::App& app, DotOptions& dots) {
    Options options(app, "Points");
    auto* points = options.path("--points", "FILE.csv", dots.points,
                                "points as coloured dots: columns x, y, z, and those of a quantity, as `hemi "
                                "points -o FILE.csv` writes them");
    options
        .value("--column", "NAME", "column that the dots show (the first beside the positions and normals)",
               [&dots](const std::string& text) { dots.column = text; })
        ->needs(points);
}

void add_gather(CLI::App& app, Gather& gather) {
    Options(app, "Picture")
        .choice<Gather>("--gather", "auto|on|off",
                        "radiosity at vertices by rows of their own: crisp shadows", gather);
}

void add_picture(CLI::App& app, PictureOptions& picture, CLI::Option* output, bool quantities,
                 SceneOptions* scene) {
    const bool stored = scene == nullptr;
    std::vector<CLI::Option*> added = add_shown(app, picture, quantities, stored);
    const std::vector<CLI::Option*> drawn = add_drawn(app, picture, scene);
    added.insert(added.end(), drawn.begin(), drawn.end());
    if (quantities) {
        const std::vector<CLI::Option*> of_them = add_quantities(app, picture);
        added.insert(added.end(), of_them.begin(), of_them.end());
        if (stored) {
            add_celsius(app, picture);
        }
    }
    added.push_back(Options(app, "Picture")
                        .choice<ToneMapping>("--tone-mapping", "NAME", "filmic (the default) or linear",
                                             [&picture](ToneMapping value) {
                                                 picture.tone_mapping = value;
                                                 picture.tone_mapping_given = true;
                                             }));
    for (CLI::Option* option : added) {
        if (output != nullptr) {
            option->needs(output);
        }
    }
    if (scene != nullptr) {
        app.parse_complete_callback([&picture, scene, output] {
            scene->up_is_visible = output == nullptr || picture.output.has_value();
        });
    }
}

void add_difference_picture(CLI::App& app, PictureOptions& picture, CLI::Option* output) {
    picture.quantity = Quantity::radiosity;
    picture.map = ColourMap::cool_warm;
    const std::vector<std::string> known = quantity_words(is_any);
    Options(app, "Picture")
        .value("--show", "QUANTITY",
               fmt::format("quantity that is compared (radiosity): {}", fmt::join(known, ", ")),
               [&picture, known](const std::string& text) {
                   picture.quantity = from_word<Quantity>(known[parse_choice("--show", text, known)]);
               })
        ->type_name(fmt::format("{}", fmt::join(known, "|")));
    std::vector<CLI::Option*> added = add_drawn(app, picture, nullptr);
    const std::vector<CLI::Option*> of_quantities = add_quantities(app, picture, false);
    added.insert(added.end(), of_quantities.begin(), of_quantities.end());
    for (CLI::Option* option : added) {
        if (option->get_name() != "--channel") {
            option->needs(output);
        }
    }
}

std::vector<std::string> add_heat_picture(CLI::App& app, HeatPicture& picture, CLI::Option* output,
                                          SceneOptions& scene) {
    Options options(app, "Picture");
    std::vector<CLI::Option*> added = add_drawn(app, picture.picture, &scene);
    picture.picture.quantity = Quantity::temperature;
    const std::vector<std::string> known = quantity_words(is_known_of_heat);
    added.push_back(options.value(
        "--show", "QUANTITY",
        fmt::format("temperature (the default), flux (net, leaving positive), or another of: {}",
                    fmt::join(known, ", ")),
        [&picture, known](const std::string& text) {
            picture.picture.quantity = from_word<Quantity>(known[parse_choice("--show", text, known)]);
        }));
    added.back()->type_name(fmt::format("{}", fmt::join(known, "|")));
    const std::vector<CLI::Option*> of_quantities = add_quantities(app, picture.picture);
    added.insert(added.end(), of_quantities.begin(), of_quantities.end());
    added.push_back(add_celsius(app, picture.picture));
    std::vector<std::string> names;
    for (CLI::Option* option : added) {
        option->needs(output);
        names.push_back(option->get_name());
    }
    return names;
}

} // namespace hemi::cli
