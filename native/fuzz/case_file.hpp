// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "stack_case.hpp"

namespace realmodel::fuzz {

/// Reads a file of the corpus tests/data/stacks, which the Python tests read too: JSON; of one rock
/// mass its rules, base_elevation, region {vertices, triangles} and surfaces [{vertices,
/// triangles}], or "rocks": a list of such. Numbers are integers or doubles in hexadecimal, as
/// strings.
/// @throws std::runtime_error where it cannot be read or is no such file
StackCase read_case(const std::filesystem::path& file);

/// Writes such a file; `why` says what is wrong with the case, or was.
/// @throws std::runtime_error where it cannot be written
void write_case(const StackCase& stack, const std::filesystem::path& file, const std::string& why);

/// All files of a folder in the order of their names; none where there is no such folder.
std::vector<std::filesystem::path> case_files(const std::filesystem::path& folder);

}  // namespace realmodel::fuzz
