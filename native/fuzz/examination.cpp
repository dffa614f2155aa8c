// SPDX-License-Identifier: GPL-3.0-or-later
#include "examination.hpp"

namespace realmodel::fuzz {

Examination examine(StackCase stack, const JudgeOptions& options) {
    Examination result;
    result.defects = make_valid(stack, result.usable);
    if (result.usable) result.defects = defects_of(stack, options);
    result.stack = std::move(stack);
    return result;
}

std::string least_kind(const std::vector<Defect>& defects) {
    std::string least;
    for (const Defect& defect : defects) {
        if (least.empty() || defect.kind < least) least = defect.kind;
    }
    return least;
}

}  // namespace realmodel::fuzz
