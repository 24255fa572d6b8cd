#include "cli/report/report.hpp"

#include <utility>

namespace hemi::cli {

void Report::add(std::string_view name, std::string_view line, const Json& keys) {
    text += summary_line(name, line);
    json.update(keys);
}

void Report::add(const Report& more) {
    text += more.text;
    json.update(more.json);
}

void Report::select(std::string_view schema, std::initializer_list<const char*> keys) {
    Json object{{"schema", schema}};
    for (const char* const key : keys) {
        object[key] = std::move(json.at(key));
    }
    json = std::move(object);
}

void show(const Report& report, bool json) {
    if (json) {
        print_json(report.json);
    } else {
        print(report.text);
    }
}

} // namespace hemi::cli
