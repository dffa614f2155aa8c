// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>

namespace realmodel::exact {

/// Which way the path a -> b -> c turns in the plane: 1 left, -1 right, 0 straight on. Exact for
/// any finite coordinates.
int orient2d(const std::array<double, 2>& a, const std::array<double, 2>& b,
             const std::array<double, 2>& c);

}  // namespace realmodel::exact
