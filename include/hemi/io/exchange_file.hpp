#pragma once

#include "hemi/core/enclosure.hpp"

#include <filesystem>
#include <span>
#include <string>

namespace hemi::io {

/// Grey exchange between G groups, to be written. Arrays of G·G hold from g to h at [g·G + h].
struct ExchangeTables {
    std::span<const std::string> groups;        ///< names
    Enclosure enclosure = Enclosure::automatic; ///< of the scene
    std::span<const double> areas;              ///< m²
    std::span<const double> emissivity;         ///< means
    std::span<const double> gebhart;            ///< share of what g emits that h absorbs in the end
    std::span<const double> script_f;           ///< conductance over the area of g
    std::span<const double> conductance;        ///< m², symmetric
    std::span<const double> environment;        ///< script-F to the environment
};

/// A NumPy archive with an array of each member but the enclosure, by its name: `groups` of text, `gebhart`,
/// `script_f` and `conductance` of G by G doubles, the others of G.
/// @throws InvalidArgument for sizes that differ; IoError
void write_exchange_npz(const std::filesystem::path& path, const ExchangeTables& tables);

/// View3D's text table as it writes it with emit=1: areas, script-F, emissivities.
/// @throws InvalidArgument for sizes that differ; IoError
void write_exchange_view3d(const std::filesystem::path& path, const ExchangeTables& tables);

} // namespace hemi::io
