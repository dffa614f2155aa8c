// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <span>

#include "realmodel/interpolation/variogram.hpp"

namespace realmodel::interpolation {

/// Surfaces that are estimated together, by a linear model of coregionalization (Chiles and
/// Delfiner 2012, "Geostatistics", section 5.6.4): the height of a sheet is a field that all of
/// them share, plus the thicknesses between it and the lowest one, fields of their own that do not
/// depend on one another. So two heights covary as the shared field and as the thicknesses under
/// both of them.
struct Sheets {
    std::span<const std::int32_t> of_points;  ///< the sheet of each point, from 0
    std::span<const std::int32_t> of_dips;    ///< of each dip
    /// Of each sheet the variance of its thickness above the lowest one, in units of the sill of
    /// the shared field: ascending. Empty: there is one surface, and nothing else here counts.
    std::span<const double> variances;
    Variogram thickness{};   ///< of all thicknesses, in its own units; it has no nugget
    std::int32_t asked = 0;  ///< the sheet whose heights the nodes get
};

}  // namespace realmodel::interpolation
