#pragma once

#include "cli/arguments/arguments.hpp"

/// Runs by several processes at once, see hemi::Ranks.
namespace hemi::cli {

/// Shares out the memory of every machine among its ranks. Nothing happens where the process is alone.
/// @throws InvalidArgument for commands and options that one process alone can do
void prepare_for_ranks(Arguments& arguments);

} // namespace hemi::cli
