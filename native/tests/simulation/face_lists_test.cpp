// SPDX-License-Identifier: GPL-3.0-or-later
#include "realmodel/simulation/face_lists.hpp"

#include <gtest/gtest.h>

#include <array>
#include <vector>

#include "realmodel/base/errors.hpp"

namespace realmodel::simulation {
namespace {

using Wide = std::vector<std::int64_t>;
using Sides = std::vector<std::uint32_t>;

const Wide kOffsets{0, 3, 7};
const std::vector<std::int32_t> kVertices{5, 1, 3, 2, 1, 3, 4};

template <class Numbers>
Wide wide(const Numbers& numbers) {
    return {numbers.begin(), numbers.end()};
}

TEST(FaceListsTest, CellsAreDescribedWithTheirFacesSeenFromOutside) {
    const Sides begin{0, 2, 3}, sides{0, 3, 2};
    const CellDescriptions found = describe_cells({kOffsets, kVertices}, begin, sides);
    EXPECT_EQ(wide(found.faces), (Wide{2, 3, 5, 1, 3, 4, 4, 3, 1, 2, 1, 4, 2, 1, 3, 4}));
    EXPECT_EQ(wide(found.vertices), (Wide{1, 2, 3, 4, 5, 1, 2, 3, 4}));
    EXPECT_EQ(wide(found.counts), (Wide{5, 4}));
    EXPECT_EQ(wide(found.lengths), (Wide{10, 6}));
}

TEST(FaceListsTest, CornersOfLargeCellsStandOnceToo) {
    std::vector<std::int32_t> vertices;
    for (std::int32_t i = 0; i < 100; ++i)
        vertices.push_back((i * 37) % 50);
    const Wide offsets{0, 100};
    const CellDescriptions found = describe_cells({offsets, vertices}, Sides{0, 1}, Sides{0});
    ASSERT_EQ(found.vertices.size(), 50u);
    for (std::int64_t i = 0; i < 50; ++i)
        EXPECT_EQ(found.vertices[static_cast<std::size_t>(i)], i);
}

using Pairs = std::vector<std::array<std::int32_t, 2>>;

TEST(FaceListsTest, TurnedFacesKeepTheirFirstCorner) {
    const OrderedFaces found =
        ordered_faces({kOffsets, kVertices}, Pairs{{3, -1}, {2, 1}}, Wide{1, 0});
    EXPECT_EQ(wide(found.offsets), (Wide{0, 4, 7}));
    EXPECT_EQ(wide(found.vertices), (Wide{2, 4, 3, 1, 5, 1, 3}));
    EXPECT_EQ(wide(found.owner), (Wide{1, 3}));
    EXPECT_EQ(wide(found.neighbor), (Wide{2, -1}));
    EXPECT_EQ(wide(found.turned), (Wide{1, 0}));
}

TEST(FaceListsTest, InnerFacesComeByTheirLowerCell) {
    const Pairs cells{{2, 3}, {1, -1}, {3, 0}, {2, 0}, {0, 1}, {1, 0}};
    EXPECT_EQ(wide(inner_faces(cells, 4)), (Wide{4, 5, 3, 2, 0}));
    EXPECT_THROW(inner_faces(cells, 3), InputError);
    EXPECT_THROW(inner_faces(Pairs{{-1, -1}}, 3), InputError);
}

TEST(FaceListsTest, NumbersOfWhatIsNotThereAreRefused) {
    const FaceLoops faces{kOffsets, kVertices};
    EXPECT_THROW(describe_cells(faces, Sides{0, 1}, Sides{4}), InputError);
    EXPECT_THROW(describe_cells(faces, Sides{1, 0}, Sides{0}), InputError);
    EXPECT_THROW(describe_cells(faces, Sides{0, 2}, Sides{0}), InputError);
    const Pairs one{{0, -1}}, two{{0, -1}, {0, -1}};
    EXPECT_THROW(ordered_faces(faces, two, Wide{2}), InputError);
    EXPECT_THROW(ordered_faces(faces, one, Wide{0}), InputError);
    const Wide beyond{0, 9};
    EXPECT_THROW(ordered_faces({beyond, kVertices}, one, Wide{0}), InputError);
}

}  // namespace
}  // namespace realmodel::simulation
