// SPDX-License-Identifier: GPL-3.0-or-later
#include "spatial/hilbert_order.hpp"

#include <gtest/gtest.h>

namespace realmodel::spatial {
namespace {

TEST(HilbertOrder, GoesFromCellToNeighboringCell) {
    std::vector<PlanPosition> nodes;
    for (int i = 0; i < 64; ++i) {
        for (int j = 0; j < 64; ++j)
            nodes.push_back({3.0 * j, 3.0 * i});
    }
    const std::vector<std::uint32_t> order = along_hilbert_curve(nodes);
    std::vector<bool> seen(nodes.size(), false);
    double length = 0;
    for (std::size_t k = 0; k < order.size(); ++k) {
        ASSERT_FALSE(seen[order[k]]);
        seen[order[k]] = true;
        if (k == 0) continue;
        const PlanPosition &a = nodes[order[k - 1]], &b = nodes[order[k]];
        length += std::abs(a[0] - b[0]) + std::abs(a[1] - b[1]);
    }
    // The cells of the curve are not quite those of the grid: a few steps are of two cells.
    EXPECT_LT(length, 1.05 * 3 * static_cast<double>(nodes.size()));
    EXPECT_TRUE(along_hilbert_curve({}).empty());
    EXPECT_EQ(along_hilbert_curve(std::vector<PlanPosition>{{1, 1}, {1, 1}}),
              (std::vector<std::uint32_t>{0, 1}));
}

}  // namespace
}  // namespace realmodel::spatial
