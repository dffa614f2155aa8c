// SPDX-License-Identifier: GPL-3.0-or-later
#include <cmath>

#include "complex_checks.hpp"
#include "realmodel/base/errors.hpp"

namespace realmodel::strata {
namespace {

OwnedSurface level(double x0, double x1, double y0, double y1, double z, int n = 1) {
    return grid(
        n, n, x0, y0, x1, y1, [z](double, double) { return z; }, n % 2 == 0);
}

struct OwnedRock {
    std::vector<OwnedSurface> surfaces;
    std::optional<double> base;
};

CellComplex build_rocks(const std::vector<OwnedRock>& rocks, CellKind cells = CellKind::kColumns) {
    std::vector<StackInput> input;
    for (const OwnedRock& rock : rocks) {
        StackInput one;
        for (const OwnedSurface& s : rock.surfaces)
            one.surfaces.push_back(s.view());
        one.base_elevation = rock.base;
        input.push_back(one);
    }
    return build_rock_masses(input, {2, nullptr}, cells);
}

/// Area of the vertical faces between cells of two rock masses, the second from surface `second`
/// on.
double shared_area(const CellComplex& c, std::int32_t second) {
    double area = 0;
    for (std::size_t f = 0; f < c.face_cells.size(); ++f) {
        const auto [a, b] = c.face_cells[f];
        if (b < 0) continue;
        const auto block = [&](std::int32_t cell) {
            return c.cell_block[static_cast<std::size_t>(cell)];
        };
        if ((block(a) < second) == (block(b) < second)) continue;
        EXPECT_EQ(c.face_surface[f], kWall);
        const auto vertex = [&](std::int64_t i) {
            return c
                .vertices[static_cast<std::size_t>(c.face_vertices[static_cast<std::size_t>(i)])];
        };
        const auto begin = c.face_offsets[f], end = c.face_offsets[f + 1];
        double twice = 0;  // in the plane x = constant
        for (auto i = begin; i < end; ++i) {
            const auto p = vertex(i), q = vertex(i + 1 < end ? i + 1 : begin);
            twice += p[1] * q[2] - q[1] * p[2];
        }
        area += std::abs(twice) / 2;
    }
    return area;
}

class RockMassesOf : public testing::TestWithParam<CellKind> {
protected:
    CellComplex built(const std::vector<OwnedRock>& rocks) const {
        const CellComplex c = build_rocks(rocks, GetParam());
        expect_valid(c, GetParam() == CellKind::kBlocks);
        return c;
    }
};
INSTANTIATE_TEST_SUITE_P(Cells, RockMassesOf,
                         testing::Values(CellKind::kColumns, CellKind::kBlocks));

TEST_P(RockMassesOf, ShareTheWallBetweenThem) {
    const auto c = built({{{level(0, 1, 0, 1, 0), level(0, 1, 0, 1, 2)}, {}},
                          {{level(1, 2, 0, 1, 1, 3), level(1, 2, 0, 1, 3, 2)}, {}}});
    EXPECT_DOUBLE_EQ(c.volumes[1], 2);
    EXPECT_DOUBLE_EQ(c.volumes[3], 2);
    EXPECT_DOUBLE_EQ(shared_area(c, 2), 1.0);
    if (GetParam() == CellKind::kBlocks) {
        EXPECT_EQ(cells_of_blocks(c), (std::vector<int>{0, 1, 0, 1}));
    }
}

TEST_P(RockMassesOf, WithBordersThatMeetOverAStretchOnly) {
    const auto c = built({{{level(0, 1, 0, 2, 0, 2), level(0, 1, 0, 2, 1, 3)}, -1.0},
                          {{level(1, 2, 1, 3, 0.5), level(1, 2, 1, 3, 2, 2)}, -0.5}});
    EXPECT_DOUBLE_EQ(c.volumes[0] + c.volumes[1] + c.volumes[2] + c.volumes[3], 4 + 5);
    EXPECT_DOUBLE_EQ(shared_area(c, 2), 1.5);
}

TEST_P(RockMassesOf, ABaseThatCrossesASurfaceInTheWallGetsAPointThere) {
    const auto slope = grid(1, 1, 0, 0, 1, 1, [](double, double y) { return 2 * y - 1; });
    const auto c = built(
        {{{slope, level(0, 1, 0, 1, 3)}, {}}, {{level(1, 2, 0, 1, 1), level(1, 2, 0, 1, 2)}, 0.0}});
    EXPECT_EQ(std::count(c.vertices.begin(), c.vertices.end(), std::array<double, 3>{1, 0.5, 0}),
              1);
    EXPECT_DOUBLE_EQ(shared_area(c, 2), 1.0 + 0.75);
}

TEST_P(RockMassesOf, ThatTouchInACornerShareAVertex) {
    const auto c = built({{{level(0, 1, 0, 1, 0), level(0, 1, 0, 1, 1)}, {}},
                          {{level(1, 2, 1, 2, 0), level(1, 2, 1, 2, 1)}, {}}});
    EXPECT_EQ(c.vertices.size(), 8u + 8u - 2u);
}

TEST_P(RockMassesOf, ThatOverlapAreRefusedWithBoth) {
    try {
        built({{{level(0, 1, 0, 1, 0), level(0, 1, 0, 1, 1)}, {}},
               {{level(0.5, 2, 0, 1, 5), level(0.5, 2, 0, 1, 6)}, {}}});
        FAIL();
    } catch (const InputError& e) {
        EXPECT_EQ(e.kind, "rocks_overlap");
        EXPECT_EQ(e.items, (std::vector<std::int64_t>{0, 1}));
        ASSERT_TRUE(e.place.has_value());
        EXPECT_GE((*e.place)[0], 0.5);
    }
}

TEST(RockMasses, NameTheirSurfacesThroughAll) {
    try {
        build_rocks({{{level(0, 1, 0, 1, 0), level(0, 1, 0, 1, 1)}, {}},
                     {{level(1, 2, 0, 1, 0), level(1, 2, 0, 1, 1)}, std::nan("")}});
        FAIL();
    } catch (const InputError& e) {
        EXPECT_EQ(e.kind, "not_finite");
        EXPECT_EQ(e.surface, 2);
    }
}

TEST(RockMasses, AreNamedByNumberWhereTheirBaseIsTooHigh) {
    try {
        build_rocks({{{level(0, 1, 0, 1, 0), level(0, 1, 0, 1, 1)}, {}},
                     {{level(1, 2, 0, 1, 0), level(1, 2, 0, 1, 1)}, 0.5}});
        FAIL();
    } catch (const InputError& e) {
        EXPECT_EQ(e.kind, "base_not_below");
        EXPECT_EQ(e.items, (std::vector<std::int64_t>{1}));
    }
}

}  // namespace
}  // namespace realmodel::strata
