// SPDX-License-Identifier: GPL-3.0-or-later
#include "../halved_box.hpp"

namespace realmodel::cutting {
namespace {

TEST_F(AHalvedBox, PartsWithoutPolygonsAreNoMore) {
    cut_at(0.5);
    parts_.insert(parts_.begin(), HalfCell{0, kAbove});
    for (CutPiece& piece : pieces_.origins) {
        for (std::int32_t& part : piece.parts)
            part += part >= 0 ? 1 : 0;
    }
    RoundedParts parts = rounded_parts();
    drop_empty(parts);
    ASSERT_EQ(parts_.size(), 2U);
    EXPECT_EQ(parts_[0].side, kBelow);
    EXPECT_EQ(pieces_[0].parts, (std::array{0, -1}));
    EXPECT_EQ(pieces_[kCap].parts, (std::array{0, 1}));
}

}  // namespace
}  // namespace realmodel::cutting
