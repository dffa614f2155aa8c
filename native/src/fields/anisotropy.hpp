// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>

#include "fields/functional.hpp"
#include "realmodel/base/execution.hpp"
#include "realmodel/fields/field.hpp"

namespace realmodel::fields {

inline constexpr Anisotropy kIsotropic{{{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}}, {1, 1, 1}};

/// Scales space by the ratios along the axes.
Map3 map_of(const Anisotropy& anisotropy);

/// The anisotropy under which what is known is most likely: along the fold axis, to which the
/// normals are most nearly perpendicular, or where they show none along the best of some
/// directions; then along a direction across it.
Anisotropy likely_anisotropy(std::span<const Functional> known, std::span<const Vec3> normals,
                             const Execution& execution);

}  // namespace realmodel::fields
