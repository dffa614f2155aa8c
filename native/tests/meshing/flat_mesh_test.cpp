// SPDX-License-Identifier: GPL-3.0-or-later
#include "meshing/flat_mesh.hpp"

#include <gtest/gtest.h>

#include <random>

#include "plan_mesh_checks.hpp"

namespace realmodel::meshing {
namespace {

/// Two triangles that fill the unit square; its border is fixed.
FlatMesh square() {
    FlatMesh mesh;
    mesh.points = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
    mesh.add_triangle({0, 1, 2});
    mesh.add_triangle({0, 2, 3});
    mesh.join({0, 2}, {1, 0});
    for (const HalfEdge edge : {HalfEdge(0, 0), HalfEdge(0, 1), HalfEdge(1, 1), HalfEdge(1, 2)})
        mesh.fix(edge);
    return mesh;
}

/// Neighbors name one another, share their ends, and agree on what is fixed; returns the area.
double checked_area(const FlatMesh& mesh) {
    PlanarMesh plain{mesh.points, {}};
    for (std::int32_t t = 0; t < static_cast<std::int32_t>(mesh.corners.size()); ++t) {
        if (mesh.is_dead(t)) continue;
        plain.triangles.push_back(mesh.corners[t]);
        EXPECT_GT(orient2d(mesh.points[mesh.corners[t][0]], mesh.points[mesh.corners[t][1]],
                           mesh.points[mesh.corners[t][2]]),
                  0);
        for (int i = 0; i < 3; ++i) {
            const HalfEdge edge(t, i), other = mesh.twin(edge);
            if (other.is_none()) continue;
            EXPECT_EQ(mesh.twin(other), edge);
            EXPECT_EQ(mesh.from(edge), mesh.to(other));
            EXPECT_EQ(mesh.to(edge), mesh.from(other));
            EXPECT_EQ(mesh.is_fixed(edge), mesh.is_fixed(other));
        }
    }
    return area_of(plain);
}

std::int32_t triangle_around(const FlatMesh& mesh, const PlanPoint& p) {
    for (std::int32_t t = 0; t < static_cast<std::int32_t>(mesh.corners.size()); ++t) {
        const auto [a, b, c] = mesh.corners[t];
        if (orient2d(mesh.points[a], mesh.points[b], p) > 0 &&
            orient2d(mesh.points[b], mesh.points[c], p) > 0 &&
            orient2d(mesh.points[c], mesh.points[a], p) > 0) {
            return t;
        }
    }
    return -1;
}

bool is_delaunay(const FlatMesh& mesh) {
    for (std::int32_t t = 0; t < static_cast<std::int32_t>(mesh.corners.size()); ++t)
        for (int i = 0; i < 3; ++i)
            if (!mesh.is_dead(t) && mesh.should_flip({t, i})) return false;
    return true;
}

FlatMesh filled(int count) {
    FlatMesh mesh = square();
    std::mt19937 random(8);
    while (static_cast<int>(mesh.points.size()) < count) {
        const PlanPoint p{static_cast<double>(random()) / 4294967296.0,
                          static_cast<double>(random()) / 4294967296.0};
        const std::int32_t t = triangle_around(mesh, p);
        if (t >= 0) mesh.insert_inside(t, p);
    }
    return mesh;
}

TEST(FlatMesh, FlippingTwiceTurnsADiagonalRound) {
    FlatMesh mesh = square();
    const HalfEdge other = mesh.flip({0, 2});
    EXPECT_EQ(std::minmax(mesh.from(other), mesh.to(other)), std::minmax(1, 3));
    EXPECT_DOUBLE_EQ(checked_area(mesh), 1);
    EXPECT_TRUE(mesh.is_fixed(other.next()));
    const HalfEdge again = mesh.flip(other);
    EXPECT_EQ(std::minmax(mesh.from(again), mesh.to(again)), std::minmax(0, 2));
    EXPECT_DOUBLE_EQ(checked_area(mesh), 1);
}

TEST(FlatMesh, VerticesAreAddedAndTheMeshStaysDelaunay) {
    const FlatMesh mesh = filled(200);
    EXPECT_NEAR(checked_area(mesh), 1, 1e-12);
    EXPECT_TRUE(is_delaunay(mesh));
    EXPECT_EQ(mesh.corners.size(), 2 * 200U - 4 - 2);
}

TEST(FlatMesh, VerticesOnSidesKeepThemFixed) {
    FlatMesh mesh = square();
    const HalfEdge leaving = mesh.insert_on({0, 0}, {0.5, 0});
    EXPECT_EQ(mesh.from(leaving), 4);
    int on_border = 0;
    for (std::int32_t t = 0; t < static_cast<std::int32_t>(mesh.corners.size()); ++t)
        for (int i = 0; i < 3; ++i)
            on_border += mesh.is_border({t, i}) && mesh.is_fixed({t, i});
    EXPECT_EQ(on_border, 5);
    const std::int32_t t = triangle_around(mesh, {0.6, 0.55});
    for (int i = 0; i < 3; ++i) {
        if (mesh.is_border({t, i})) continue;
        const PlanPoint &a = mesh.origin_point({t, i}), &b = mesh.target_point({t, i});
        mesh.insert_on({t, i}, {0.5 * (a[0] + b[0]), 0.5 * (a[1] + b[1])});
        break;
    }
    EXPECT_NEAR(checked_area(mesh), 1, 1e-12);
    EXPECT_TRUE(is_delaunay(mesh));
}

TEST(FlatMesh, TheBorderPassesByAVertexThatIsTakenOut) {
    FlatMesh mesh = square();
    mesh.insert_on({0, 0}, {0.5, 0});
    const auto taken = static_cast<std::int32_t>(mesh.points.size()) - 1;
    std::int32_t t = 0;
    while (mesh.is_dead(t) || mesh.corners[t][0] != taken)
        ++t;
    HalfEdge edge(t, 0);  // any of its edges; on to the one that leaves it on the border
    while (!mesh.is_border(edge))
        edge = mesh.rotate_cw(edge);
    std::size_t around = 0;
    for (const auto& corner : mesh.corners)
        around += std::count(corner.begin(), corner.end(), taken);
    if (around == 3) {  // flipped: two triangles only
        mesh.flip(edge.prev());
        edge = HalfEdge::none();
        for (t = 0; edge.is_none(); ++t)
            for (int i = 0; i < 3; ++i)
                if (mesh.from({t, i}) == taken && mesh.is_border({t, i})) edge = {t, i};
    }
    const std::size_t triangles = mesh.corners.size();
    const HalfEdge past = mesh.remove_from_border(edge);
    EXPECT_TRUE(mesh.is_border(past) && mesh.is_fixed(past));
    EXPECT_EQ(mesh.origin_point(past), (PlanPoint{0, 0}));
    EXPECT_EQ(mesh.target_point(past), (PlanPoint{1, 0}));
    EXPECT_DOUBLE_EQ(checked_area(mesh), 1);
    mesh.compact();
    EXPECT_EQ(mesh.corners.size(), triangles - 1);
    EXPECT_DOUBLE_EQ(checked_area(mesh), 1);
}

TEST(FlatMesh, CollapsedVerticesLeaveAMeshThatCanBeCompacted) {
    FlatMesh mesh = filled(60);
    int collapsed = 0;
    for (std::int32_t t = 0; t < static_cast<std::int32_t>(mesh.corners.size()); ++t) {
        for (int i = 0; i < 3 && !mesh.is_dead(t); ++i) {
            const HalfEdge edge(t, i);
            const std::int32_t v = mesh.from(edge);
            if (v < 4 || mesh.is_fixed(edge)) continue;
            // Nothing turns over where the star of the vertex sees the other end.
            bool fits = true;
            HalfEdge around = edge;
            do {
                const std::int32_t a = mesh.to(around), b = mesh.apex(around), u = mesh.to(edge);
                fits = fits && (a == u || b == u ||
                                orient2d(mesh.points[a], mesh.points[b], mesh.points[u]) > 0);
                around = mesh.rotate_ccw(around);
            } while (around != edge);
            if (!fits) continue;
            mesh.collapse(edge);
            ++collapsed;
            ASSERT_NEAR(checked_area(mesh), 1, 1e-12);
            break;
        }
    }
    EXPECT_GT(collapsed, 10);
    mesh.compact();
    EXPECT_EQ(mesh.corners.size(), 2 * (60U - collapsed) - 4 - 2);
    EXPECT_NEAR(checked_area(mesh), 1, 1e-12);
}

}  // namespace
}  // namespace realmodel::meshing
