// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "fields/known_data.hpp"

namespace realmodel::fields {

/// The cube of some size that a contact lies in, and its surface.
using Cube = std::array<std::int64_t, 4>;
Cube cube_of(const KnownData& known, std::size_t contact, double size);

/// At most about `most` of some contacts: of each surface one in each of equal cubes.
std::vector<std::size_t> thinned(const KnownData& known, std::size_t most);

/// A part of the data that likelihoods are compared by: about `most` contacts that are spread, and
/// those nearest to them, without the references.
std::vector<std::size_t> spread_pairs(const KnownData& known, std::size_t most);

/// About how far each surface is from the next: a tenth of the contacts, of `most`, have one of the
/// next nearer to them.
std::vector<double> distances_between(const KnownData& known, std::size_t most);

/// Whether the nearest dips have the attitude of one, but the other polarity, and none a little
/// farther away agrees with it, as one on the same limb of a tight fold would.
bool is_against_neighbors(const KnownData& known, std::size_t dip);

}  // namespace realmodel::fields
