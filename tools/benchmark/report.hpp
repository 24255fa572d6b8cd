#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace hemi::bench {

/// What the figures depend on.
struct Circumstances {
    std::string renderer;
    unsigned cores = 1;
    std::uint32_t workers = 1;
    std::uint64_t seed = 0;
    double run_seconds = 0.0;
    unsigned rounds = 0;
};

/// One line of the table. Rates in hemicubes/s.
struct Cell {
    std::string scene;
    std::uint32_t patches = 0;
    std::uint32_t resolution = 0;
    double one_core = 0.0; ///< one context of one thread, as naive has
    double one_worker = 0.0;
    double all_workers = 0.0;
    double naive = 0.0;
    double ratio = 0.0;       ///< one_core / naive
    double embree = 0.0;      ///< rays through the same texels, one core
    double monte_carlo = 0.0; ///< as many rays, one core
};

enum class Bound { none, at_least, at_most };

/// One line below the table.
struct Finding {
    std::string what;
    double value = 0.0;
    std::string unit;
    Bound bound = Bound::none;
    double limit = 0.0;

    [[nodiscard]] bool met() const {
        return bound == Bound::none || (bound == Bound::at_least ? value >= limit : value <= limit);
    }
};

/// Prints figures on standard output as they come, and keeps them.
class Report {
public:
    explicit Report(Circumstances circumstances);

    void table_head() const;
    /// @param naive,embree  how far their rows are from the engine's, of a row
    void scene(const std::string& name, std::uint32_t patches, std::size_t polygons, double naive,
               double embree);
    void cell(const Cell& cell);
    void findings_head() const;
    void finding(const Finding& finding);

    /// @throws IoError
    void write_json(const std::filesystem::path& file) const;

private:
    struct Agreement {
        std::string scene;
        std::uint32_t patches;
        double naive;
        double embree;
    };
    Circumstances circumstances_;
    std::vector<Agreement> agreements_;
    std::vector<Cell> cells_;
    std::vector<Finding> findings_;
};

} // namespace hemi::bench
