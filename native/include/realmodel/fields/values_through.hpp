// SPDX-License-Identifier: GPL-3.0-or-later
// Values of a field with which its level sets pass through contacts (docs/dev/series.md).
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "realmodel/base/execution.hpp"

namespace realmodel::fields {

/// How a field is at contacts: the corners of the tetrahedron of each, by the places of their
/// values, the weights of these, and the level that the field is to have there.
struct LevelsAtContacts {
    std::span<const std::array<std::int64_t, 4>> corners;
    std::span<const std::array<double, 4>> weights;
    std::span<const double> levels;
};

/// Values near those given, and what contacts still miss their levels by: less in each round.
struct ValuesThrough {
    std::vector<double> values;
    std::vector<double> missed;
};

/// Values near those given with which a field has its levels at contacts, as far as these do not
/// pull at the same corners: in rounds A^T y is added, where A has the weights of the contacts and
/// (A A^T + loose) y is what they miss their levels by (iterated regularization of A. N. Tikhonov;
/// H. W. Engl 1987), by a sparse Cholesky factor. In one thread: the sums are always the same.
/// @throws InputError  kind option: corners that are no values; Cancelled
ValuesThrough values_through(std::span<const double> initial, const LevelsAtContacts& at,
                             int rounds, const Execution& execution);

}  // namespace realmodel::fields
