#include "support/accuracy_row.hpp"

#include <catch2/catch.hpp>

#include <cstdlib>
#include <fstream>
#include <limits>
#include <utility>

namespace hemi::test {

namespace {

void append_to_report(const std::string& cell, const char* comparison, double limit, double measured) {
    const char* report = std::getenv("HEMI_ACCURACY_REPORT");
    if (report == nullptr) {
        return;
    }
    std::ofstream file(report, std::ios::app);
    file.precision(std::numeric_limits<double>::max_digits10);
    file << cell << '\t' << comparison << '\t' << limit << '\t' << measured << '\n';
    file.close();
    REQUIRE(file);
}

} // namespace

AccuracyRow::AccuracyRow(std::string table, std::string name)
    : table_(std::move(table)), name_(std::move(name)) {}

void AccuracyRow::check_below(const std::string& column, const std::string& quantity, double measured,
                              double limit) const {
    INFO(table_ << ": " << name_ << ": " << column << " " << quantity);
    CHECK(measured < limit);
    append_to_report(table_ + '\t' + name_ + '\t' + column + '\t' + quantity, "<", limit, measured);
}

void AccuracyRow::check_above(const std::string& column, const std::string& quantity, double measured,
                              double limit) const {
    INFO(table_ << ": " << name_ << ": " << column << " " << quantity);
    CHECK(measured > limit);
    append_to_report(table_ + '\t' + name_ + '\t' + column + '\t' + quantity, ">", limit, measured);
}

} // namespace hemi::test
