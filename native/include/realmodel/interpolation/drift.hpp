// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

namespace realmodel::interpolation {

/// The trend about which heights vary: a polynomial in x and y whose coefficients are not known.
enum class Drift {
    kConstant,   ///< 1
    kLinear,     ///< 1, x, y
    kQuadratic,  ///< 1, x, y, x^2, x y, y^2
};

}  // namespace realmodel::interpolation
