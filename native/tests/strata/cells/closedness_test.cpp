// SPDX-License-Identifier: GPL-3.0-or-later
#include "../complex_checks.hpp"
#include "strata/cells/assembly.hpp"

namespace realmodel::strata {
namespace {

TEST(Closedness, OfColumnsAndWhereAFaceIsMissing) {
    const auto level = [](double z) {
        return grid(1, 1, 0, 0, 1, 1, [z](double, double) { return z; });
    };
    CellComplex c = build({level(0), level(1)});
    EXPECT_TRUE(are_closed(c));
    c.face_offsets.pop_back();
    c.face_cells.pop_back();
    EXPECT_FALSE(are_closed(c));
}

}  // namespace
}  // namespace realmodel::strata
