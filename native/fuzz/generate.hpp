// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <vector>

#include "random_source.hpp"
#include "stack_case.hpp"

namespace realmodel::fuzz {

/// Kinds of stacks, each leaning on one kind of degenerate position: tests/core/stacks/generate.py
/// has the same for the tests in Python.
std::vector<std::string> families();

/// A stack of a family, on a lattice of `smallest` to `largest` squares a side. It may have to be
/// repaired (repair.hpp) before the builder accepts it.
StackCase make_stack(RandomSource& random, std::size_t family, int smallest, int largest);

/// Two to four rock masses whose regions share borders; the same holds.
StackCase make_rock_masses(RandomSource& random, int largest);

}  // namespace realmodel::fuzz
