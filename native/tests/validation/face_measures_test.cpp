// SPDX-License-Identifier: GPL-3.0-or-later
#include "validation/face_measures.hpp"

#include <gtest/gtest.h>

#include "small_complex.hpp"

namespace realmodel::validation {
namespace {

/// What the faces of each cell add up to.
std::vector<double> volumes(const ComplexView& model) {
    const SidesByCell sides(model, {1, nullptr});
    const FaceMeasures faces(model, sides, {1, nullptr});
    std::vector<double> sums(model.cell_count(), 0);
    for (std::size_t c = 0; c < sums.size(); ++c) {
        for (const Side side : sides[c])
            sums[c] += faces[face_of(side)].volume[is_reversed(side) ? 1 : 0];
    }
    return sums;
}

TEST(FaceMeasures, AddUpToTheVolumesOfCells) {
    auto cubes = two_cubes();
    for (auto& v : cubes.vertices) {
        if (v[2] == 2) v[2] = 4;
    }
    EXPECT_EQ(volumes(cubes.view()), (std::vector<double>{1, 3}));
}

TEST(FaceMeasures, AreMeasuredFromACornerOfEachCell) {
    auto cubes = two_cubes();
    for (auto& v : cubes.vertices)
        v[2] += 100;
    std::swap(cubes.loops[1], cubes.loops[2]);  // now the top comes first of the upper cube
    std::swap(cubes.cells[1], cubes.cells[2]);
    const ComplexView model = cubes.view();
    const FaceMeasures faces(model, SidesByCell(model, {1, nullptr}), {1, nullptr});
    EXPECT_EQ(faces[0].volume[0], 0);
    EXPECT_EQ(faces[1].volume[0], 0);
    EXPECT_DOUBLE_EQ(faces[2].volume[0], 1.0 / 3);  // above the base, and below the top
    EXPECT_DOUBLE_EQ(faces[2].volume[1], 1.0 / 3);
}

TEST(FaceMeasures, OfACellInsideOutAreNegative) {
    auto cubes = two_cubes();
    for (auto& loop : cubes.loops)
        std::reverse(loop.begin(), loop.end());
    EXPECT_EQ(volumes(cubes.view()), (std::vector<double>{-1, -1}));
}

TEST(FaceMeasures, RoundingIsWhatAStepOfEveryCornerSweeps) {
    auto cubes = two_cubes();
    const ComplexView model = cubes.view();
    const FaceMeasures faces(model, SidesByCell(model, {1, nullptr}), {1, nullptr});
    EXPECT_EQ(faces[0].rounding, 2 * 0x1p-52);  // an area of 1, heights up to 2
    EXPECT_EQ(faces[3].rounding, 0x1p-52);      // a wall along x, y up to 1
}

TEST(FaceMeasures, FaultsAreFoundUnderTheNumberOfTheFace) {
    auto cubes = two_cubes();
    cubes.loops[2] = {8, 9, 11, 10};
    const ComplexView model = cubes.view();
    FaceMeasures faces(model, SidesByCell(model, {1, nullptr}), {1, nullptr});
    EXPECT_EQ(faces.findings().examined, 11);
    ASSERT_EQ(faces.findings().failed, 1);
    EXPECT_EQ(faces.findings().first[0].text, "face 2 crosses itself");
    EXPECT_EQ(faces.findings().first[0].cell, 1);
    EXPECT_EQ(faces.findings().first[0].place, (std::array<double, 3>{0, 0, 2}));
}

}  // namespace
}  // namespace realmodel::validation
