// SPDX-License-Identifier: GPL-3.0-or-later
#include "realmodel/simulation/face_lists.hpp"

#include <gtest/gtest.h>

#include <vector>

#include "realmodel/base/errors.hpp"

namespace realmodel::simulation {
namespace {

using Wide = std::vector<std::int64_t>;

const Wide kOffsets{0, 3, 7};
const std::vector<std::int32_t> kVertices{5, 1, 3, 2, 1, 3, 4};

template <class Numbers>
Wide wide(const Numbers& numbers) {
    return {numbers.begin(), numbers.end()};
}

TEST(FaceListsTest, CellsAreDescribedWithTheirFacesSeenFromOutside) {
    const Wide begin{0, 2, 3}, sides{0, 3, 2};
    const CellDescriptions found = describe_cells({kOffsets, kVertices}, begin, sides);
    EXPECT_EQ(wide(found.faces), (Wide{2, 3, 5, 1, 3, 4, 4, 3, 1, 2, 1, 4, 2, 1, 3, 4}));
    EXPECT_EQ(wide(found.vertices), (Wide{1, 2, 3, 4, 5, 1, 2, 3, 4}));
    EXPECT_EQ(wide(found.counts), (Wide{5, 4}));
}

TEST(FaceListsTest, TurnedFacesKeepTheirFirstCorner) {
    const std::vector<std::uint8_t> turned{1, 0};
    const OrderedFaces found = ordered_faces({kOffsets, kVertices}, Wide{1, 0}, turned);
    EXPECT_EQ(wide(found.offsets), (Wide{0, 4, 7}));
    EXPECT_EQ(wide(found.vertices), (Wide{2, 4, 3, 1, 5, 1, 3}));
}

TEST(FaceListsTest, NumbersOfWhatIsNotThereAreRefused) {
    const FaceLoops faces{kOffsets, kVertices};
    EXPECT_THROW(describe_cells(faces, Wide{0, 1}, Wide{4}), InputError);
    EXPECT_THROW(describe_cells(faces, Wide{0, 1}, Wide{-2}), InputError);
    EXPECT_THROW(describe_cells(faces, Wide{0, 2}, Wide{0}), InputError);
    const std::vector<std::uint8_t> one{0}, none;
    EXPECT_THROW(ordered_faces(faces, Wide{2}, one), InputError);
    EXPECT_THROW(ordered_faces(faces, Wide{0}, none), InputError);
    const Wide beyond{0, 9};
    EXPECT_THROW(ordered_faces({beyond, kVertices}, Wide{0}, one), InputError);
}

}  // namespace
}  // namespace realmodel::simulation
