// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include "../complex_checks.hpp"
#include "strata/cells/exact_positions.hpp"
#include "strata/cells/volumes.hpp"

namespace realmodel::strata {
namespace {

/// Two surfaces on lattices of their own that cross, in multiples of 1/8 of `unit`, moved aside.
CellComplex model_at(double east, double north, double unit, CellKind cells) {
    const std::vector<OwnedSurface> surfaces{
        grid(6, 6, east, north, east + 12 * unit, north + 12 * unit,
             [=](double x, double y) { return (x - east) / 4 + (y - north) / 8; }),
        grid(
            5, 3, east, north, east + 10 * unit, north + 12 * unit,
            [=](double x, double y) { return 3 * unit - (x - east) / 8 + (y - north) / 4; }, true)};
    StackInput input;
    for (const OwnedSurface& surface : surfaces)
        input.surfaces.push_back(surface.view());
    input.base_elevation = -8 * unit;
    return build_stack(input, {2, nullptr}, cells);
}

/// Far from the origin crossings are rounded to 2^-30 here, and volumes are what they are near it.
TEST(PlanOffsets, VolumesDoNotDependOnWhereAModelIs) {
    for (const CellKind cells : {CellKind::kColumns, CellKind::kBlocks}) {
        const auto near = model_at(0, 0, 1, cells).volumes,
                   far = model_at(0x1p22, 3 * 0x1p20, 1, cells).volumes;
        ASSERT_EQ(near.size(), far.size());
        for (std::size_t b = 0; b < near.size(); ++b)
            EXPECT_NEAR(far[b], near[b], 1e-14 * near[b]);
    }
}

/// A model of a millimeter there is as its cells are: they are what is written.
TEST(PlanOffsets, VolumesAreThoseOfTheCellsWhereRoundingShows) {
    for (const CellKind cells : {CellKind::kColumns, CellKind::kBlocks}) {
        const CellComplex small = model_at(0x1p22, 3 * 0x1p20, 0x1p-14, cells);
        EXPECT_EQ(small.volumes, block_volumes(small, small.volumes.size(), {2, nullptr}));
    }
}

TEST(PlanOffsets, AreNoneNearTheOrigin) {
    PlanVertices vertices;
    vertices.position = Array<PlanPosition>(2);
    vertices.position[0] = {0, 0};
    vertices.position[1] = {1, 1};
    vertices.representative = Array<PointId>(2);
    const exact::PlanArrangement geometry;
    EXPECT_TRUE(find_plan_offsets(geometry, vertices, {1, nullptr}).empty());
}

TEST(PlanOffsets, GoWithTheVerticesThatAreLeft) {
    Array<PlanOffset> offsets(3);
    offsets[0] = {1, 2};
    offsets[1] = {3, 4};
    offsets[2] = {5, 6};
    renumber(offsets, {0, -1, 1});
    ASSERT_EQ(offsets.size(), 2U);
    EXPECT_EQ(offsets[1], (PlanOffset{5, 6}));
}

}  // namespace
}  // namespace realmodel::strata
