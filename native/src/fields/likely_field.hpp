// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>
#include <vector>

#include "fields/anisotropy.hpp"
#include "fields/known_data.hpp"
#include "realmodel/base/execution.hpp"

namespace realmodel::fields {

/// The kind of field that predicts data best that are left out.
struct LikelyField {
    Likely likely;
    std::vector<double> gaps;          ///< differences of the levels; none: they are free
    std::vector<double> plain_shares;  ///< as of Field
};

/// Levels are free, unless the field would be far steeper between some of them than between
/// others: it is smoothest where it is flat, so that rough surfaces can draw their levels together.
/// @param is_even  whether beds keep their thickness; none: if it predicts data better
/// @throws InputError wrong_order: a surface lies on the wrong side of the next
LikelyField likely_field(const KnownData& known, std::optional<bool> is_even,
                         const Execution& execution);

}  // namespace realmodel::fields
