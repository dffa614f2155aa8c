// SPDX-License-Identifier: GPL-3.0-or-later
// What a MeshRequest asks for beside one edge length: meshers, local lengths, numbers, constraints.
#include <gtest/gtest.h>

#include <numbers>

#include "../sanitized.hpp"
#include "plan_mesh_checks.hpp"
#include "realmodel/meshing/region_mesh.hpp"

namespace realmodel::meshing {
namespace {

const std::vector<Ring> with_hole{rectangle(0, 0, 100, 100), rectangle(40, 30, 60, 50)};

MeshRequest by(Mesher mesher, double edge_length = 0) {
    MeshRequest request;
    request.mesher = mesher;
    request.edge_length = edge_length;
    return request;
}

double length_of(const PlanarMesh& mesh, const std::array<std::int32_t, 3>& t, int i) {
    const PlanPoint &a = mesh.vertices[t[i]], &b = mesh.vertices[t[(i + 1) % 3]];
    return std::hypot(b[0] - a[0], b[1] - a[1]);
}

double mean_ratio(const PlanarMesh& mesh) {
    double sum = 0;
    for (const auto& t : mesh.triangles) {
        double squares = 0;
        for (int i = 0; i < 3; ++i)
            squares += length_of(mesh, t, i) * length_of(mesh, t, i);
        const PlanPoint &a = mesh.vertices[t[0]], &b = mesh.vertices[t[1]],
                        &c = mesh.vertices[t[2]];
        const double twice = (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
        sum += 2 * std::numbers::sqrt3 * twice / squares;
    }
    return sum / static_cast<double>(mesh.triangles.size());
}

/// Mean edge of the triangles whose center lies within a distance of a place.
double mean_edge_near(const PlanarMesh& mesh, const PlanPoint& place, double distance) {
    double sum = 0;
    int count = 0;
    for (const auto& t : mesh.triangles) {
        PlanPoint center{};
        for (const std::int32_t v : t)
            for (int k = 0; k < 2; ++k)
                center[k] += mesh.vertices[v][k] / 3;
        if (std::hypot(center[0] - place[0], center[1] - place[1]) > distance) continue;
        for (int i = 0; i < 3; ++i)
            sum += length_of(mesh, t, i);
        count += 3;
    }
    return sum / count;
}

PlanarMesh made(const MeshRequest& request, const std::vector<Ring>& rings = with_hole) {
    PlanarMesh mesh = mesh_region(rings, request);
    expect_valid(mesh);
    const double area = area_of(triangulate_rings(rings));
    EXPECT_NEAR(area_of(mesh), area, 1e-12 * area);
    return mesh;
}

bool has_vertex(const PlanarMesh& mesh, const PlanPoint& p) {
    return std::find(mesh.vertices.begin(), mesh.vertices.end(), p) != mesh.vertices.end();
}

TEST(Meshers, FrontalIsBetterThanDelaunay) {
    const std::vector<Ring> rings{{{0, 0}, {100, 7}, {120, 60}, {60, 110}, {-10, 70}}};
    MeshRequest request;
    request.edge_length = 3;
    const double plain = mean_ratio(made(request, rings));
    request.mesher = Mesher::kFrontal;
    const double better = mean_ratio(made(request, rings));
    EXPECT_GT(better, plain);
    EXPECT_GT(better, 0.98);
}

TEST(Meshers, FrontalGradesToDetailOfTheBorder) {
    Ring coast{{100, 60}, {0, 60}};
    for (int i = 0; i < 100; ++i)
        coast.push_back({1.0 * i, i % 2 == 0 ? 0 : 0.8});
    MeshRequest request = by(Mesher::kFrontal, 8);
    EXPECT_GT(mean_ratio(made(request, {coast})), 0.93);
}

/// Of vertices inside; not counting those beside the border.
double share_with_six(const PlanarMesh& mesh) {
    std::vector<int> triangles(mesh.vertices.size(), 0);
    std::vector<bool> is_near(mesh.vertices.size(), false), is_border(mesh.vertices.size(), false);
    for (const auto& [v, next] : border_of(mesh))
        is_border[v] = is_near[v] = true;
    for (const auto& t : mesh.triangles) {
        const bool touches = is_border[t[0]] || is_border[t[1]] || is_border[t[2]];
        for (const std::int32_t v : t) {
            ++triangles[v];
            if (touches) is_near[v] = true;
        }
    }
    double all = 0, six = 0;
    for (std::size_t v = 0; v < triangles.size(); ++v) {
        if (is_near[v]) continue;
        ++all;
        six += triangles[v] == 6;
    }
    return six / all;
}

/// Rows must end where lengths grow, but no more often than that asks for.
TEST(Meshers, FrontalHasNoNeedlessEndsOfRows) {
    MeshRequest request = by(Mesher::kFrontal, 20);
    request.sizes = {{{}, 2, 0}};
    EXPECT_GT(share_with_six(made(request, {rectangle(0, 0, 500, 500)})), 0.88);
}

/// Needles have no room for vertices inside: nodes slide along their sides.
TEST(Meshers, FrontalFillsNeedlesWell) {
    std::vector<Ring> rings(1);
    for (int i = 0; i < 80; ++i) {
        const double radius = i % 2 == 0 ? 50 : 5, turn = i * std::numbers::pi / 40;
        rings[0].push_back({radius * std::cos(turn), radius * std::sin(turn)});
    }
    const PlanarMesh mesh = made(by(Mesher::kFrontal, 2), rings);
    EXPECT_GT(mean_ratio(mesh), 0.95);
    EXPECT_TRUE(std::equal(rings[0].begin(), rings[0].end(), mesh.vertices.begin()));
    // What was added on the border lies on the outline's edges, but for rounding.
    for (const auto& [v, next] : border_of(mesh)) {
        double least = 1;
        for (std::size_t i = 0; i < rings[0].size(); ++i) {
            const PlanPoint &a = rings[0][i], &b = rings[0][(i + 1) % rings[0].size()],
                            &p = mesh.vertices[v];
            const double ux = b[0] - a[0], uy = b[1] - a[1], length = std::hypot(ux, uy);
            const double along = ((p[0] - a[0]) * ux + (p[1] - a[1]) * uy) / length;
            if (along < -1e-12 || along > length + 1e-12) continue;
            least = std::min(least, std::abs((p[0] - a[0]) * uy - (p[1] - a[1]) * ux) / length);
        }
        EXPECT_LT(least, 1e-13);
    }
}

/// Where one length holds, edges that two regions share are cut alike.
TEST(Meshers, FrontalRegionsSideBySideMeetInTheSameVertices) {
    const auto on_seam = [](const Ring& ring) {
        std::vector<double> ys;
        for (const PlanPoint& p : made(by(Mesher::kFrontal, 7), {ring}).vertices)
            if (p[0] == 100) ys.push_back(p[1]);
        std::sort(ys.begin(), ys.end());
        return ys;
    };
    const std::vector<double> left = on_seam({{0, 0}, {100, 0}, {100, 100}, {0, 100}}),
                              right = on_seam({{250, 100}, {100, 100}, {100, 0}, {250, 0}});
    EXPECT_GT(left.size(), 10U);
    EXPECT_EQ(left, right);
}

TEST(Meshers, CombsOfManyTeethAreFollowed) {
    constexpr int kTeeth = kSanitized ? 500 : 2000;
    Ring comb{{0, -1}};
    for (int i = 0; i < kTeeth; ++i) {
        const double x = i;
        comb.insert(comb.end(), {{x, 0}, {x + 0.25, 2}, {x + 0.5, 0}});
    }
    comb.insert(comb.end(), {{kTeeth, 0}, {kTeeth, -1}});
    for (const Mesher mesher : {Mesher::kDelaunay, Mesher::kFrontal}) {
        const PlanarMesh mesh = made(by(mesher, 3), {comb});
        EXPECT_LT(mesh.triangles.size(), 30U * kTeeth);
    }
}

TEST(Meshers, TenThousandHoles) {
    constexpr int kAcross = kSanitized ? 30 : 100;
    constexpr std::size_t kHoles = kAcross * kAcross;
    std::vector<Ring> rings{rectangle(0, 0, 10 * kAcross, 10 * kAcross)};
    for (int i = 0; i < kAcross; ++i)
        for (int k = 0; k < kAcross; ++k)
            rings.push_back(rectangle(10 * i + 3, 10 * k + 3, 10 * i + 8, 10 * k + 7));
    for (const Mesher mesher : {Mesher::kDelaunay, Mesher::kFrontal}) {
        const PlanarMesh mesh = made(by(mesher, 8), rings);
        EXPECT_GT(mesh.triangles.size(), 4 * kHoles);
        EXPECT_LT(mesh.triangles.size(), 40 * kHoles);
    }
}

TEST(Meshers, AGridHasItsNodesAndNothingElseInside) {
    MeshRequest request = by(Mesher::kGrid, 5);
    const PlanarMesh mesh = made(request);
    EXPECT_EQ(mesh.vertices.size(), 21U * 21 - 3 * 3);
    for (const PlanPoint& p : mesh.vertices)
        for (int k = 0; k < 2; ++k)
            EXPECT_NEAR(p[k] / 5, std::round(p[k] / 5), 1e-12);
    EXPECT_EQ(mesh.triangles.size(), 2U * (20 * 20 - 4 * 4));
}

TEST(Meshers, AGridHasOneLength) {
    MeshRequest request = by(Mesher::kGrid, 5);
    request.sizes = {{{}, 1, 1}};
    EXPECT_EQ(refusal([&] { mesh_region(with_hole, request); }).kind, "size");
}

TEST(Meshers, LocalLengthsAtPlacesLinesAndTheOutline) {
    for (const Mesher mesher : {Mesher::kDelaunay, Mesher::kFrontal}) {
        MeshRequest request = by(mesher, 10);
        request.sizes = {{{{80, 80}}, 0.5, 3}, {{{10, 70}, {40, 90}}, 1, 2}};
        const PlanarMesh mesh = made(request);
        EXPECT_NEAR(mean_edge_near(mesh, {80, 80}, 2), 0.5, 0.1);
        EXPECT_NEAR(mean_edge_near(mesh, {25, 80}, 1), 1, 0.2);
        EXPECT_GT(mean_edge_near(mesh, {80, 15}, 15), 6);
        request.sizes = {{{}, 1, 0}};
        EXPECT_NEAR(mean_edge_near(made(request), {50, 0}, 1), 1, 0.3);
        EXPECT_GT(mean_edge_near(made(request), {20, 50}, 5), 3);
    }
}

TEST(Meshers, RefusesLengthsThatAreNone) {
    MeshRequest request = by(Mesher::kDelaunay, 10);
    for (const LocalLength& bad : {LocalLength{{}, 0, 1}, LocalLength{{}, 1, -1},
                                   LocalLength{{}, 10, 0}, LocalLength{{{0, NAN}}, 1, 0}}) {
        request.sizes = {{{}, 1, 1}, bad};
        const InputError error = refusal([&] { mesh_region(with_hole, request); });
        EXPECT_EQ(error.kind, "size");
        EXPECT_EQ(error.items, std::vector<std::int64_t>{1});
    }
}

TEST(Meshers, DensityOfPointsGivesTheLength) {
    MeshRequest request;
    for (int i = 0; i < 30; ++i)
        for (int k = 0; k < 30; ++k)
            request.density.push_back({50.0 + i, 60.0 + k});
    request.density.insert(request.density.end(), {{10, 10}, {90, 10}, {10, 90}, {30, 50}});
    const PlanarMesh mesh = made(request);
    EXPECT_NEAR(mean_edge_near(mesh, {65, 75}, 5), 0.5, 0.12);
    EXPECT_GT(mean_edge_near(mesh, {15, 15}, 5), 2);
    request.density = {{1, 1}, {1, 1}};
    EXPECT_EQ(refusal([&] { mesh_region(with_hole, request); }).kind, "density");
}

TEST(Meshers, NumbersOfTriangles) {
    for (const Mesher mesher : {Mesher::kDelaunay, Mesher::kFrontal, Mesher::kGrid}) {
        MeshRequest request = by(mesher);
        request.triangles = 3000;
        EXPECT_NEAR(static_cast<double>(made(request).triangles.size()), 3000, 150);
    }
    MeshRequest few;
    few.triangles = 3;  // with eight corners there are eight at least
    EXPECT_EQ(refusal([&] { mesh_region(with_hole, few); }).kind, "triangles");
}

TEST(Meshers, ConstraintsAreInTheMesh) {
    for (const Mesher mesher : {Mesher::kDelaunay, Mesher::kFrontal, Mesher::kGrid}) {
        MeshRequest request = by(mesher, 6);
        request.constraints.lines = {{{-10, 75}, {110, 75}}, {{20, 60}, {20, 90}}};
        request.constraints.points = {{81.25, 20.5}, {10, 75}};
        const PlanarMesh mesh = made(request);
        for (const PlanPoint& p : {PlanPoint{81.25, 20.5}, {10, 75}, {20, 75}, {0, 75}, {100, 75}})
            EXPECT_TRUE(has_vertex(mesh, p)) << p[0] << ", " << p[1];
        for (const auto& t : mesh.triangles) {
            double lowest = 100, highest = 0;
            for (const std::int32_t v : t) {
                lowest = std::min(lowest, mesh.vertices[v][1]);
                highest = std::max(highest, mesh.vertices[v][1]);
            }
            EXPECT_FALSE(lowest < 75 - 1e-9 && highest > 75 + 1e-9) << "a triangle lies across";
        }
    }
    MeshRequest request = by(Mesher::kDelaunay, 6);
    request.constraints.points = {{1, 1}, {50, 40}};  // in the hole
    const InputError error = refusal([&] { mesh_region(with_hole, request); });
    EXPECT_EQ(error.kind, "constraint_outside");
    EXPECT_EQ(error.items, std::vector<std::int64_t>{1});
}

TEST(Meshers, SameBytesEveryTime) {
    for (const Mesher mesher : {Mesher::kFrontal, Mesher::kGrid}) {
        const MeshRequest request = by(mesher, 2.5);
        const PlanarMesh first = mesh_region(with_hole, request),
                         second = mesh_region(with_hole, request);
        EXPECT_EQ(first.vertices, second.vertices);
        EXPECT_EQ(first.triangles, second.triangles);
    }
}

TEST(Meshers, EstimatesAreNearWhatIsMade) {
    for (const Mesher mesher : {Mesher::kDelaunay, Mesher::kFrontal}) {
        MeshRequest request = by(mesher, 8);
        request.sizes = {{{{80, 80}}, 0.4, 5}};
        const MeshEstimate told = estimate_region_mesh(with_hole, request);
        const auto count = static_cast<double>(made(request).triangles.size());
        EXPECT_NEAR(told.triangles, count, 0.2 * count);
        EXPECT_GT(told.bytes, 60 * count);
    }
}

}  // namespace
}  // namespace realmodel::meshing
