#include "cli/several_ranks.hpp"

#include "hemi/core/error.hpp"
#include "hemi/core/ranks.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <span>
#include <string_view>
#include <type_traits>
#include <variant>

namespace hemi::cli {

namespace {

[[noreturn]] void refuse(std::string_view what, std::string_view why) {
    throw InvalidArgument(
        fmt::format("{} by {} ranks: {}; start a single process", what, ranks().size(), why));
}

/// Where the clock or the memory of a machine decides, ranks might decide differently.
void check(const RowOptions& rows) {
    if (rows.error_target) {
        refuse("--error-target", "the time that settings take decides about them");
    }
}

void check(const SolveArguments& arguments) {
    if (arguments.refines()) {
        refuse("--error-target and --refine", "patches are cut by one process");
    }
    check(arguments.rows);
}

void check(const FactorsArguments& arguments) {
    if (arguments.selection) {
        refuse("--rows", "ranks share all rows");
    }
    check(arguments.rows);
}

void check(const HeatArguments& arguments) {
    check(arguments.rows);
}

/// All decide alike by the least memory that one of them may take.
void share_memory(FactorSettings& settings) {
    if (!settings.max_memory) {
        const std::uint64_t own = memory_limit(settings) / ranks().on_machine();
        const std::vector<std::uint64_t> all = gather_values(ranks(), std::span(&own, 1));
        settings.max_memory = *std::min_element(all.begin(), all.end());
    }
}

} // namespace

void prepare_for_ranks(Arguments& arguments) {
    if (ranks().size() == 1) {
        return;
    }
    std::visit(
        [](auto& command) {
            using Command = std::remove_reference_t<decltype(command)>;
            if constexpr (std::is_same_v<Command, SolveArguments> ||
                          std::is_same_v<Command, FactorsArguments> ||
                          std::is_same_v<Command, HeatArguments>) {
                check(command);
                share_memory(command.rows.factors);
            } else {
                refuse("this command", "only factors, solve and heat are shared out among ranks");
            }
        },
        arguments);
}

} // namespace hemi::cli
