#include "io/factors/provenance_json.hpp"

#include <string_view>

namespace hemi::io {

namespace {

constexpr std::string_view no_preset = "none"; // of baseline methods

} // namespace

void add_provenance(Json& head, const Provenance& provenance) {
    head["preset"] = provenance.preset ? to_word(*provenance.preset) : no_preset;
    head["method"] = to_word(provenance.method);
    head["resolution"] = provenance.resolution;
    head["eye_points"] = provenance.eye_points;
    head["near_eye_points"] = provenance.near_eye_points;
    head["shadow_rays"] = provenance.shadow_rays;
    head["exchange_rule"] = to_word(provenance.exchange_rule);
    head["seed"] = provenance.seed;
    head["renderer"] = provenance.renderer;
}

Provenance read_provenance(const JsonNode& head) {
    Provenance provenance;
    if (head.member("preset").any_text() == no_preset) {
        provenance.preset.reset();
    } else {
        provenance.preset = read_word<Preset>(head.member("preset"));
    }
    provenance.method = read_word<Method>(head.member("method"));
    provenance.resolution = integer32(head.member("resolution"));
    provenance.eye_points = integer32(head.member("eye_points"));
    provenance.shadow_rays = integer32(head.member("shadow_rays"));
    provenance.seed = head.member("seed").integer(std::numeric_limits<std::uint64_t>::max());
    provenance.renderer = head.member("renderer").any_text();
    if (head.has("exchange_rule")) {
        provenance.exchange_rule = read_word<ExchangeRule>(head.member("exchange_rule"));
        provenance.near_eye_points = integer32(head.member("near_eye_points"));
    } else { // files of before: the rule was the preset's
        provenance.exchange_rule =
            provenance.preset == Preset::exact ? ExchangeRule::exact : ExchangeRule::standard;
    }
    return provenance;
}

} // namespace hemi::io
