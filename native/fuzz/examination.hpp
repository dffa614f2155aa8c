// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "judge.hpp"

namespace realmodel::fuzz {

/// What became of one case.
struct Examination {
    bool usable = false;  ///< something was left to build
    StackCase stack;      ///< as it was built
    std::vector<Defect> defects;
};

/// Makes a case valid and judges it, in this process.
Examination examine(StackCase stack, const JudgeOptions& options);

/// Judges a case as it is in a process of its own: a crash and a hang are defects too. The caller
/// must not have used several threads before.
std::vector<Defect> examine_apart(const StackCase& stack, const JudgeOptions& options,
                                  double seconds);

/// The least kind, or "" where there is no defect.
std::string least_kind(const std::vector<Defect>& defects);

}  // namespace realmodel::fuzz
