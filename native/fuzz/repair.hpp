// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>
#include <string>

#include "realmodel/base/errors.hpp"
#include "stack_case.hpp"

namespace realmodel::fuzz {

/// Takes out of a case what the builder refused, and only that: the second of two triangles that
/// overlap, an upright triangle, a base that is too high, the second of two rock masses that
/// overlap. Returns false where nothing is left to build or the refusal is of another kind.
bool repair(StackCase& stack, const InputError& refusal);

/// What is wrong with a refusal: that the triangles it names do not overlap, say; exact. Nothing
/// where it is just.
std::optional<std::string> unjust(const StackCase& stack, const InputError& refusal);

}  // namespace realmodel::fuzz
