// SPDX-License-Identifier: GPL-3.0-or-later
#include "../halved_box.hpp"
#include "base/floating_point.hpp"

namespace realmodel::cutting {
namespace {

TEST_F(AHalvedBox, AFlatPartGetsAUnitOfThickness) {
    cut_at(0);
    RoundedParts parts = rounded_parts();
    widen_flat_parts(parts);
    EXPECT_EQ(new_[1], (Position{1, 0, ulp(0)}));  // the first of its polygons
    for (const std::size_t i : {0U, 2U, 3U})
        EXPECT_EQ(new_[i][2], 0);
}

TEST_F(AHalvedBox, AWallWithoutExtentInPlanGetsAUnit) {
    cut_at(0.5);
    new_[1] = {0, 0, 0.25};
    add(2, kBelow, {8, 9, 0});
    RoundedParts parts = rounded_parts();
    widen_flat_parts(parts);
    EXPECT_EQ(new_[0], (Position{ulp(0), 0, 0.5}));
    EXPECT_EQ(new_[1], (Position{0, 0, 0.25}));
}

}  // namespace
}  // namespace realmodel::cutting
