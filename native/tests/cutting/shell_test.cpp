// SPDX-License-Identifier: GPL-3.0-or-later
#include "cutting/shell.hpp"

#include <gtest/gtest.h>

#include <vector>

namespace realmodel::cutting {
namespace {

/// The corners of a box by the bits of their numbers: x, y, z.
struct Corners {
    Position low, high;
    Position operator()(NodeId i) const {
        return {(i & 1) != 0 ? high[0] : low[0], (i & 2) != 0 ? high[1] : low[1],
                (i & 4) != 0 ? high[2] : low[2]};
    }
};

const std::vector<std::vector<NodeId>> kOutward{{0, 4, 6, 2}, {1, 3, 7, 5}, {0, 1, 5, 4},
                                                {2, 6, 7, 3}, {0, 2, 3, 1}, {4, 5, 7, 6}};

PartShell shell_of(const Corners& at, int sign) {
    PartShell shell;
    for (const auto& face : kOutward)
        shell.add(face, sign, at(0), at);
    return shell;
}

TEST(PartShell, HasTheVolumeAndTheBoxOfItsPolygons) {
    const PartShell shell = shell_of({{1, 2, 3}, {3, 5, 4}}, 1);
    EXPECT_DOUBLE_EQ(shell.sixfold_volume, 6 * 6.0);
    EXPECT_EQ(shell.box.low, (Position{1, 2, 3}));
    EXPECT_EQ(shell.box.high, (Position{3, 5, 4}));
}

TEST(PartShell, AroundAHollowItIsNegative) {
    EXPECT_DOUBLE_EQ(shell_of({{0, 0, 0}, {1, 1, 2}}, -1).sixfold_volume, -6 * 2.0);
}

}  // namespace
}  // namespace realmodel::cutting
