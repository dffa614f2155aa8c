// SPDX-License-Identifier: GPL-3.0-or-later
#include "realmodel/meshing/rings.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <numbers>

#include "plan_mesh_checks.hpp"

namespace realmodel::meshing {
namespace {

PlanarMesh triangulated(std::vector<Ring> rings) {
    PlanarMesh mesh = triangulate_rings(rings);
    expect_valid(mesh);
    return mesh;
}

InputError refused(std::vector<Ring> rings) {
    return refusal([&] { triangulate_rings(rings); });
}

TEST(Rings, ASquareIsTwoTriangles) {
    const PlanarMesh mesh = triangulated({rectangle(0, 0, 2, 2)});
    EXPECT_EQ(mesh.triangles.size(), 2U);
    EXPECT_EQ(mesh.vertices, rectangle(0, 0, 2, 2));
    EXPECT_EQ(area_of(mesh), 4);
}

TEST(Rings, OrientationRepetitionAndClosingDoNotMatter) {
    const Ring clockwise{{0, 0}, {0, 2}, {0, 2}, {2, 2}, {2, 0}, {2, 0}, {0, 0}};
    const PlanarMesh mesh = triangulated({clockwise});
    EXPECT_EQ(mesh.vertices.size(), 4U);
    EXPECT_EQ(area_of(mesh), 4);
}

TEST(Rings, HolesAndIslandsInHolesAlternate) {
    EXPECT_EQ(area_of(triangulated({rectangle(0, 0, 10, 10), rectangle(2, 2, 8, 8),
                                    rectangle(4, 4, 6, 6), rectangle(20, 0, 21, 1)})),
              100 - 36 + 4 + 1);
}

TEST(Rings, MayTouchInPoints) {
    // Hole with a corner in the middle of the outline's edge, one with a corner on its corner.
    EXPECT_EQ(area_of(triangulated(
                  {rectangle(0, 0, 10, 10), {{5, 0}, {6, 2}, {4, 2}}, {{10, 10}, {8, 9}, {9, 8}}})),
              100 - 2 - 1.5);
    // A ring that touches itself: two squares joined by a corner.
    EXPECT_EQ(
        area_of(triangulated({{{0, 0}, {1, 0}, {1, 1}, {2, 1}, {2, 2}, {1, 2}, {1, 1}, {0, 1}}})),
        2);
}

TEST(Rings, CollinearRunsStayVertices) {
    const PlanarMesh mesh = triangulated({{{0, 0}, {1, 0}, {2, 0}, {3, 0}, {3, 3}, {0, 3}}});
    EXPECT_EQ(mesh.triangles.size(), 4U);
    EXPECT_EQ(area_of(mesh), 9);
}

TEST(Rings, RefusesCrossing) {
    const InputError bow_tie = refused({{{0, 0}, {2, 2}, {2, 0}, {0, 2}}});
    EXPECT_EQ(bow_tie.kind, "outline_crosses");
    EXPECT_EQ(bow_tie.items, (std::vector<std::int64_t>{0, 0, 0, 2}));
    EXPECT_EQ(*bow_tie.place, (std::array<double, 3>{1, 1, 0}));

    const InputError hole_across = refused({rectangle(0, 0, 4, 4), rectangle(3, 1, 5, 2)});
    EXPECT_EQ(hole_across.kind, "outline_crosses");
    EXPECT_EQ(hole_across.items, (std::vector<std::int64_t>{0, 1, 1, 0}));
    EXPECT_EQ(*hole_across.place, (std::array<double, 3>{4, 1, 0}));
}

TEST(Rings, RefusesACrossingTooSmallForDoubles) {
    // The apex reaches over the long edge by less than the rounding of a determinant in doubles.
    const double up = std::nextafter(1.0, 2.0);
    EXPECT_EQ(refused({{{0, 0}, {3, 3}, {0, 3}}, {{2, 0}, {1, up}, {2, 0.5}}}).kind,
              "outline_crosses");
    EXPECT_EQ(area_of(triangulated({{{0, 0}, {3, 3}, {0, 3}}, {{2, 0}, {1, 1}, {2, 0.5}}})),
              4.5 + 0.25);
}

TEST(Rings, RefusesOverlap) {
    const InputError shared = refused({rectangle(0, 0, 4, 4), rectangle(4, 1, 5, 2)});
    EXPECT_EQ(shared.kind, "outline_overlaps");
    EXPECT_EQ(shared.items, (std::vector<std::int64_t>{0, 1, 1, 3}));
    EXPECT_EQ(*shared.place, (std::array<double, 3>{4, 1.5, 0}));
    // A spike without width.
    EXPECT_EQ(refused({{{0, 0}, {2, 0}, {5, 0}, {2, 0}, {2, 2}}}).kind, "outline_overlaps");
    EXPECT_EQ(refused({rectangle(0, 0, 1, 1), rectangle(0, 0, 1, 1)}).kind, "outline_overlaps");
}

TEST(Rings, RefusesWhatHasNoArea) {
    EXPECT_EQ(refused({}).kind, "no_outline");
    for (const Ring& ring : {Ring{}, Ring{{1, 1}}, Ring{{1, 1}, {2, 1}, {1, 1}},
                             Ring{{0, 0}, {1, 1}, {3, 3}}, Ring{{0, 0}, {0, 0}, {0, 0}, {1, 0}}}) {
        const InputError error = refused({rectangle(0, 0, 9, 9), ring});
        EXPECT_EQ(error.kind, "outline_degenerate");
        EXPECT_EQ(error.items, (std::vector<std::int64_t>{1}));
    }
}

TEST(Rings, RefusesWhatIsNotFinite) {
    for (const double bad : {std::nan(""), std::numeric_limits<double>::infinity()}) {
        const InputError error = refused({rectangle(0, 0, 9, 9), {{1, 1}, {2, 1}, {bad, 2}}});
        EXPECT_EQ(error.kind, "not_finite");
        EXPECT_EQ(error.items, (std::vector<std::int64_t>{1, 2}));
    }
}

TEST(Rings, AHundredThousandCornersAreDivided) {
    constexpr int corners = 100'000;
    Ring star;
    for (int i = 0; i < corners; ++i) {
        const double turn = 2 * std::numbers::pi * i / corners;
        const double radius = i % 2 == 0 ? 1000 : 990;
        star.push_back({radius * std::cos(turn), radius * std::sin(turn)});
    }
    EXPECT_EQ(triangulate_rings(std::vector<Ring>{star}).triangles.size(), corners - 2U);
}

}  // namespace
}  // namespace realmodel::meshing
