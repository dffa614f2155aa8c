// SPDX-License-Identifier: GPL-3.0-or-later
#include "simulation/cleaning/editable_complex.hpp"

#include <gtest/gtest.h>

#include "towers.hpp"

namespace realmodel::simulation {
namespace {

using Numbers = std::vector<std::int32_t>;

Numbers list(std::span<const std::int32_t> numbers) {
    return {numbers.begin(), numbers.end()};
}

TEST(ListPoolTest, ListsGrowAndShrink) {
    const std::vector<std::int64_t> offsets{0, 2, 3};
    ListPool pool(std::span<const std::int64_t>(offsets), {7, 8, 9});
    pool.push(0, 5);
    pool.push(1, 6);
    pool.erase(0, 8);
    EXPECT_EQ(list(pool[0]), (Numbers{7, 5}));
    EXPECT_EQ(list(pool[1]), (Numbers{9, 6}));
    const std::int32_t added = pool.add_list();
    EXPECT_EQ(added, 2);
    pool.set(added, Numbers{1, 2, 3});
    EXPECT_EQ(list(pool[2]), (Numbers{1, 2, 3}));
}

TEST(EditableComplexTest, NeighborsInALoop) {
    const Numbers loop{4, 6, 9};
    EXPECT_EQ(beside(loop, 4), (std::array{6, 9}));
    EXPECT_EQ(beside(loop, 9), (std::array{4, 6}));
    EXPECT_FALSE(beside(loop, 5).has_value());
}

TEST(EditableComplexTest, ALoopThatMeetsItselfIsTakenApart) {
    Change change;
    change.add(Numbers{0, 1, 2, 3, 1, 4}, 7, {0, -1}, 5);
    ASSERT_EQ(change.added.size(), 2u);
    EXPECT_EQ(list(change.loop(change.added[0])), (Numbers{1, 2, 3}));
    EXPECT_EQ(list(change.loop(change.added[1])), (Numbers{0, 1, 4}));
}

TEST(EditableComplexTest, ShapesOfFacesAndCells) {
    const Tower tower({0, 5, 9});
    const EditableComplex complex(tower.view, {1, nullptr});
    EXPECT_EQ(complex.shape(0).area, (Vec3{0, 0, -60}));
    EXPECT_EQ(complex.shape(0).center,
              (Vec3{0, 0, -4.5}));  // the middle of the model is the origin
    EXPECT_DOUBLE_EQ(complex.cell(0).volume, 300);
    EXPECT_DOUBLE_EQ(complex.cell(0).area, 2 * 60 + 2 * 30 + 2 * 50);
    EXPECT_EQ(complex.cell(0).turned_faces, 0);
    const ComplexCounts counts = complex.counts();
    EXPECT_EQ(counts.edges, 20u);
    EXPECT_EQ(counts.faces, 11u);
    EXPECT_EQ(counts.cells, 2u);
}

/// The change that divides a face along one of its diagonals.
Change division(const EditableComplex& complex, std::int32_t face) {
    const auto loop = complex.corners(face);
    Change change;
    change.removed = {face};
    change.add(Numbers{loop[0], loop[1], loop[2]}, face, complex.cells(face),
               complex.surface(face));
    change.add(Numbers{loop[2], loop[3], loop[0]}, face, complex.cells(face),
               complex.surface(face));
    return change;
}

TEST(ChangeCheckTest, ADividedFaceIsFineAndIsApplied) {
    const Tower tower({0, 5, 9});
    EditableComplex complex(tower.view, {1, nullptr});
    ChangeCheck check(complex, {});
    Change change = division(complex, 5);
    ASSERT_TRUE(check.settle(change, complex.corners(5)[0]));
    EXPECT_EQ(check.volume_change(), 0);
    complex.apply(change);
    EXPECT_EQ(complex.counts().faces, 12u);
    EXPECT_EQ(complex.cell_faces(0).size(), 7u);
    EXPECT_DOUBLE_EQ(complex.cell(0).volume, 300);
}

TEST(ChangeCheckTest, AFaceThatTurnsOverIsRefused) {
    const Tower tower({0, 5, 9});
    const EditableComplex complex(tower.view, {1, nullptr});
    ChangeCheck check(complex, {});
    const auto loop = complex.corners(5);
    Change change;
    change.removed = {5};
    change.add(Numbers{loop[3], loop[2], loop[1], loop[0]}, 5, complex.cells(5), 0);
    EXPECT_FALSE(check.settle(change, -1));
}

}  // namespace
}  // namespace realmodel::simulation
