// SPDX-License-Identifier: GPL-3.0-or-later
#include "strata/repair/plan_snapping.hpp"

#include <random>

#include "../complex_checks.hpp"
#include "realmodel/base/errors.hpp"

namespace realmodel::strata {
namespace {

double above(double v) {
    return std::nextafter(v, HUGE_VAL);
}

OwnedSurface box(double x0, double x1, double z, int n) {
    return grid(
        n, n, x0, 0.1, x1, 0.9, [z](double, double) { return z; }, n % 2 == 0);
}

TEST(PlanSnapping, BordersAUnitApartInTheLastPlaceAreOne) {
    const auto c = build({box(0.3, 1.7, 0, 2), box(above(0.3), above(1.7), 1, 3)});
    expect_valid(c);
    std::set<double> x;
    for (const auto& v : c.vertices)
        x.insert(v[0]);
    EXPECT_EQ(x.count(0.3) + x.count(1.7), 0u);  // the finer surface has more vertices there
    EXPECT_EQ(*x.begin(), above(0.3));
    for (std::size_t f = 0; f < c.face_cells.size(); ++f) {
        if (c.face_surface[f] != kWall) continue;
        EXPECT_GE(c.face_offsets[f + 1] - c.face_offsets[f], 4);
    }
}

TEST(PlanSnapping, TheValueOfMostVerticesStands) {
    OwnedSurface s = box(0, 1, 0, 1);
    s.vertices[0] = 0x1p-53;  // one corner beside x = 0
    const OwnedSurface other = box(0, 1, 1, 2);
    const StackInput input{{s.view(), other.view()}, {}, {}, {}, {}, {}};
    const auto snapping = find_snapping({&input, 1});
    EXPECT_EQ(snapping.x(0x1p-53), 0.0);
    EXPECT_EQ(snapping.x(0.0), 0.0);
    EXPECT_EQ(snapping.x(1.0), 1.0);
    EXPECT_TRUE(snapping.y.empty());
}

TEST(PlanSnapping, ANeedleOfThatWidthStaysANeedle) {
    OwnedSurface needle;
    needle.triangle(needle.vertex(1, 0, 1), needle.vertex(above(1), 0, 1), needle.vertex(1, 1, 1));
    const auto floor = grid(1, 1, 0, 0, 2, 1, [](double, double) { return 0; });
    const StackInput input{{floor.view(), needle.view()}, {}, {}, {}, {}, {}};
    EXPECT_TRUE(find_snapping({&input, 1}).empty());
    const auto c = build({floor, needle});
    expect_valid(c);
    EXPECT_EQ(cells_of_blocks(c)[1], 1);
}

TEST(PlanSnapping, SurfacesOnOnePlanMeshAreLeftAlone) {
    OwnedSurface lower = box(0, 1, 0, 2), upper = box(0, 1, 1, 2);
    lower.vertices[3] = upper.vertices[3] = 0x1p-53;  // beside x = 0 in both
    const StackInput input{{lower.view(), upper.view()}, {}, {}, {}, {}, {}};
    EXPECT_TRUE(share_one_plan({&input, 1}));
    EXPECT_TRUE(build({lower, upper}).warnings.empty());
    upper.vertices[3] = 0.0;
    EXPECT_FALSE(share_one_plan({&input, 1}));
}

TEST(PlanSnapping, HeightsAreLeftAlone) {
    const auto c = build({box(0, 1, 0.1, 1), box(0, 1, above(0.1), 1)});
    EXPECT_EQ(cells_of_blocks(c)[1], 2);
}

TEST(PlanSnapping, WhatIsWrongIsSaidOfTheInputAsGiven) {
    OwnedSurface s = box(0.3, 1.7, 0, 1);
    const auto a = s.vertex(above(0.3), 0.2, 5), b = s.vertex(1.5, 0.2, 5),
               d = s.vertex(1.5, 0.8, 5);
    s.triangle(a, b, d);
    EXPECT_THROW(build({s}), InputError);
}

TEST(PlanSnapping, ATriangleWithoutAreaDoesNotBecomeAnUprightOne) {
    // Its corners lie in one line of space; were the middle one moved, they would not.
    OwnedSurface flat = box(0.1, 2, 0, 1);
    flat.triangle(flat.vertex(0.5, 0.5, 0.5), flat.vertex(1, 0.5, 1), flat.vertex(1.5, 0.5, 1.5));
    OwnedSurface other = box(0.1, 2, 9, 2);
    for (int i = 0; i < 3; ++i) {
        const auto a = other.vertex(above(1), 0.3 + 0.1 * i, 9);
        other.triangle(a, a, a);
    }
    const StackInput input{{flat.view(), other.view()}, {}, {}, {}, {}, {}};
    EXPECT_TRUE(find_snapping({&input, 1}).x.empty());
    EXPECT_NO_THROW(build({flat, other}));
}

/// Positions as a surface without triangles.
StackInput of_positions(const std::vector<double>& vertices) {
    return {{{vertices, {}}}, {}, {}, {}, {}, {}};
}

void expect_same(const AxisSnapping& one, const AxisSnapping& other,
                 const std::vector<double>& values) {
    EXPECT_EQ(one.size(), other.size());
    for (const double value : values)
        EXPECT_EQ(one(value), other(value));
}

TEST(PlanSnapping, InSlicesItIsTheSame) {
    std::mt19937_64 random(7);
    const auto below = [&](int count) { return static_cast<int>(random() % std::uint64_t(count)); };
    for (const double extent : {1e-3, 10.0, 4e6, 1e200}) {
        // most of them around a few values, and one far from all others
        std::vector<double> centers{0.0, extent * 1e9};
        for (int i = 0; i < 30; ++i)
            centers.push_back(extent * (below(4000) - 2000) / 1000.0);
        std::vector<double> vertices;
        for (int i = 0; i < 3000; ++i) {
            for (int axis = 0; axis < 2; ++axis) {
                double value = centers[i == 0 ? 1 : static_cast<std::size_t>(below(31) + 1) % 31];
                if (axis == 0 && value == centers[1] && i > 0) value = -0.0;
                for (int steps = below(3) * below(4); steps > 0; --steps)
                    value = above(value);
                vertices.push_back(value);
            }
            vertices.push_back(i);
        }
        // x is not so large that all else were rounding; of y hardly anything is apart
        vertices[0] = 3 * extent;
        const StackInput input = of_positions(vertices);
        const PlanSnapping whole = find_snapping({&input, 1});
        EXPECT_GT(whole.x.size(), 30U);
        for (const std::size_t at_once : {1, 2, 7, 100, 2999}) {
            const PlanSnapping slices = find_snapping({&input, 1}, {1, nullptr}, at_once);
            expect_same(slices.x, whole.x, vertices);
            expect_same(slices.y, whole.y, vertices);
        }
    }
}

TEST(PlanSnapping, ARunGoesOnInTheNextSlices) {
    std::vector<double> vertices{0, 0, 0, 8, 0, 0};
    double x = 1;
    for (int i = 0; i < 50; ++i) {
        vertices.insert(vertices.end(), {x, 0, 0});
        if (i == 40) vertices.insert(vertices.end(), {x, 0, 0});
        x = above(x);
    }
    const StackInput input = of_positions(vertices);
    for (const std::size_t at_once : {2, 3, 10, 1000}) {
        const PlanSnapping found = find_snapping({&input, 1}, {2, nullptr}, at_once);
        EXPECT_EQ(found.x.size(), 49U);
        EXPECT_EQ(found.x(1), 1 + 40 * 0x1p-52);
        EXPECT_EQ(found.x(x), x);
        EXPECT_TRUE(found.y.empty());
    }
}

}  // namespace
}  // namespace realmodel::strata
