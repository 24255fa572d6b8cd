#pragma once

#include "cli/report/report.hpp"
#include "hemi/io/table_file.hpp"
#include "hemi/pipeline/points.hpp"

#include <optional>
#include <span>
#include <string>
#include <vector>

/// Report of points.
namespace hemi::cli {

/// Values of points under names, as columns of a table.
struct PointColumns {
    std::vector<std::string> names;
    std::vector<std::vector<double>> values; ///< of every column, P; not a number: does not apply
};

/// What is told of points.
struct PointsAsked {
    std::vector<std::string> channels; ///< names
    std::vector<std::string> groups;   ///< names; empty: factors are not wanted
    bool heat = false;                 ///< whether the radiation is that of temperatures
    std::optional<Posture> posture;
    bool faces = false;             ///< whether the person faces front
    BodyAbsorption body{};          ///< of the person
    std::vector<double> horizontal; ///< irradiance outside, channels; empty: no daylight factors are wanted
};

/// Irradiances, shares, radiant temperatures, factors.
[[nodiscard]] PointColumns point_columns(std::span<const Receiver> points, const PointValues& values,
                                         const PointsAsked& asked);
/// Positions, normals where there are some, and columns; what does not apply is an empty cell.
[[nodiscard]] io::TextTable point_table(std::span<const Receiver> points, const PointColumns& columns);
/// Keys of the JSON object.
[[nodiscard]] Json points_json(std::span<const Receiver> points, const PointValues& values,
                               const PointsAsked& asked);

} // namespace hemi::cli
