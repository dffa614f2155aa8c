// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>
#include <string>
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

/// Calls `work` in a process of its own and returns what it returns: a crash and a hang are defects
/// too. A hang takes so many seconds of processors, or ten times as many without an answer. Where
/// `work` uses several threads the caller must not have done so before.
std::vector<Defect> in_a_process(const std::function<std::vector<Defect>()>& work, double seconds);

/// The defects of a case, judged in a process of its own.
std::vector<Defect> examine_apart(const StackCase& stack, const JudgeOptions& options,
                                  double seconds);

/// The least kind, or "" where there is no defect.
std::string least_kind(const std::vector<Defect>& defects);

}  // namespace realmodel::fuzz
