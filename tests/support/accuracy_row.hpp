#pragma once

#include <string>

namespace hemi::test {

/// A row of a table of tools/doxygen/pages/accuracy.md, filled by the tests that assert its limits.
///
/// A check is an assertion like CHECK. If the environment variable HEMI_ACCURACY_REPORT names a file, it also
/// appends a line to that file: table, row, column, quantity, comparison, limit and measured value, separated
/// by tabs. `tools/figures accuracy` runs the test cases tagged [accuracy] and makes the tables from these
/// lines; a cell that is checked several times shows the worst value.
class AccuracyRow {
public:
    /// @param table  as in the marker on the page: `<!-- table: single factors -->`
    /// @param name   first cell of the row
    AccuracyRow(std::string table, std::string name);

    /// Asserts measured < limit.
    /// @param column    heading of the column
    /// @param quantity  what is measured, where a cell has several: "rms"; or empty
    void check_below(const std::string& column, const std::string& quantity, double measured,
                     double limit) const;
    /// Asserts measured > limit.
    void check_above(const std::string& column, const std::string& quantity, double measured,
                     double limit) const;

private:
    std::string table_;
    std::string name_;
};

} // namespace hemi::test
