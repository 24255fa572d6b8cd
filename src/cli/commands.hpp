#pragma once

#include "cli/arguments/arguments.hpp"
#include "cli/exit_status.hpp"
#include "cli/terminal.hpp"

/// The commands, each in its own file: data to stdout, messages to the terminal, errors as exceptions.
namespace hemi::cli {

[[nodiscard]] ExitStatus run(const SolveArguments& arguments, const Terminal& terminal);
[[nodiscard]] ExitStatus run(const FactorsArguments& arguments, const Terminal& terminal);
[[nodiscard]] ExitStatus run(const CheckArguments& arguments, const Terminal& terminal);
[[nodiscard]] ExitStatus run(const TradeArguments& arguments, const Terminal& terminal);
[[nodiscard]] ExitStatus run(const HeatArguments& arguments, const Terminal& terminal);
[[nodiscard]] ExitStatus run(const ExchangeArguments& arguments, const Terminal& terminal);
[[nodiscard]] ExitStatus run(const PointsArguments& arguments, const Terminal& terminal);
[[nodiscard]] ExitStatus run(const RenderArguments& arguments, const Terminal& terminal);
[[nodiscard]] ExitStatus run(const DiffArguments& arguments, const Terminal& terminal);
[[nodiscard]] ExitStatus run(const ViewArguments& arguments, const Terminal& terminal);
[[nodiscard]] ExitStatus run(const BakeArguments& arguments, const Terminal& terminal);
[[nodiscard]] ExitStatus run(const MergeArguments& arguments, const Terminal& terminal);
[[nodiscard]] ExitStatus run(const ConvertArguments& arguments, const Terminal& terminal);
[[nodiscard]] ExitStatus run(const InfoArguments& arguments, const Terminal& terminal);
[[nodiscard]] ExitStatus run(const DevicesArguments& arguments, const Terminal& terminal);

} // namespace hemi::cli
