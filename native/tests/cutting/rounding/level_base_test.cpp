// SPDX-License-Identifier: GPL-3.0-or-later
#include "../halved_box.hpp"

namespace realmodel::cutting {
namespace {

TEST_F(AHalvedBox, NewNodesOfTheBaseGetItsHeight) {
    surfaces_[0] = kBase;
    cut_at(0.5);
    new_[0] = {0.25, 0.25, 0x1p-60};
    add(0, kBelow, {0, 2, 8});
    RoundedParts parts = rounded_parts();
    level_base(parts);
    EXPECT_EQ(new_[0], (Position{0.25, 0.25, 0}));
    EXPECT_EQ(new_[1], (Position{1, 0, 0.5}));
}

}  // namespace
}  // namespace realmodel::cutting
