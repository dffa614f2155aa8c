// SPDX-License-Identifier: GPL-3.0-or-later
#include "spatial/plan_tiles.hpp"

#include <algorithm>
#include <cmath>

namespace realmodel::spatial {

PlanTiles::PlanTiles(const PlanBox& frame, std::size_t count) : frame_(frame) {
    const double width = frame.width(), height = frame.height();
    const auto wanted = static_cast<double>(std::clamp<std::size_t>(count, 1, 1U << 26));
    const double shape = height > 0 ? std::clamp(width / height, 1.0 / wanted, wanted) : wanted;
    columns_ = std::max<std::int32_t>(1, static_cast<std::int32_t>(std::sqrt(wanted * shape)));
    rows_ = std::max<std::int32_t>(1, static_cast<std::int32_t>(std::sqrt(wanted / shape)));
    step_x_ = std::max(width / columns_, 1e-300);
    step_y_ = std::max(height / rows_, 1e-300);
}

}  // namespace realmodel::spatial
