// SPDX-License-Identifier: GPL-3.0-or-later
#include "realmodel/meshing/region_mesh.hpp"

#include <gtest/gtest.h>
#if defined(_OPENMP)
#include <omp.h>
#endif

#include <atomic>
#include <numbers>
#include <random>
#include <thread>

#include "plan_mesh_checks.hpp"
#include "realmodel/base/progress.hpp"
#include "realmodel/meshing/rings.hpp"

namespace realmodel::meshing {
namespace {

double degrees(double radians) {
    return radians * 180 / std::numbers::pi;
}

double angle_at(const PlanPoint& p, const PlanPoint& a, const PlanPoint& b) {
    const double ux = a[0] - p[0], uy = a[1] - p[1], vx = b[0] - p[0], vy = b[1] - p[1];
    return degrees(std::atan2(std::abs(ux * vy - uy * vx), ux * vx + uy * vy));
}

/// Least angle over all corners that do not lie between two border edges.
double least_free_angle(const PlanarMesh& mesh) {
    const auto border = border_of(mesh);
    const auto on_border = [&](std::int32_t a, std::int32_t b) {
        const auto at = border.find(a);
        return at != border.end() &&
               std::find(at->second.begin(), at->second.end(), b) != at->second.end();
    };
    double least = 180;
    for (const auto& t : mesh.triangles) {
        for (int i = 0; i < 3; ++i) {
            const std::int32_t p = t[i], q = t[(i + 1) % 3], r = t[(i + 2) % 3];
            if (on_border(p, q) && on_border(r, p)) continue;
            least = std::min(least, angle_at(mesh.vertices[p], mesh.vertices[q], mesh.vertices[r]));
        }
    }
    return least;
}

double mean_edge(const PlanarMesh& mesh) {
    double sum = 0;
    for (const auto& t : mesh.triangles) {
        for (int i = 0; i < 3; ++i) {
            const PlanPoint &a = mesh.vertices[t[i]], &b = mesh.vertices[t[(i + 1) % 3]];
            sum += std::hypot(b[0] - a[0], b[1] - a[1]);
        }
    }
    return sum / (3.0 * static_cast<double>(mesh.triangles.size()));
}

/// The border consists of the rings' edges, in pieces: every border edge lies on an edge of the
/// rings up to rounding, their lengths add up to the rings' length, and every corner is there
/// unchanged.
void expect_border(const PlanarMesh& mesh, const std::vector<Ring>& rings) {
    double reach = 0, ring_length = 0;
    std::vector<std::array<PlanPoint, 2>> edges;
    for (const Ring& ring : rings) {
        for (std::size_t i = 0; i < ring.size(); ++i) {
            const PlanPoint &a = ring[i], &b = ring[(i + 1) % ring.size()];
            edges.push_back({a, b});
            ring_length += std::hypot(b[0] - a[0], b[1] - a[1]);
            reach = std::max({reach, std::abs(a[0]), std::abs(a[1])});
            EXPECT_NE(std::find(mesh.vertices.begin(), mesh.vertices.end(), a),
                      mesh.vertices.end());
        }
    }
    const double tolerance = 4 * reach * std::numeric_limits<double>::epsilon();
    double border_length = 0;
    for (const auto& [from, ends] : border_of(mesh)) {
        for (const std::int32_t to : ends) {
            const PlanPoint &p = mesh.vertices[from], &q = mesh.vertices[to];
            border_length += std::hypot(q[0] - p[0], q[1] - p[1]);
            const PlanPoint m{(p[0] + q[0]) / 2, (p[1] + q[1]) / 2};
            const bool on_edge = std::any_of(edges.begin(), edges.end(), [&](const auto& edge) {
                const double ux = edge[1][0] - edge[0][0], uy = edge[1][1] - edge[0][1];
                const double length = std::hypot(ux, uy);
                const double vx = m[0] - edge[0][0], vy = m[1] - edge[0][1];
                const double along = (ux * vx + uy * vy) / length;
                return std::abs(ux * vy - uy * vx) / length <= tolerance && along >= 0 &&
                       along <= length;
            });
            EXPECT_TRUE(on_edge) << m[0] << ", " << m[1];
        }
    }
    EXPECT_NEAR(border_length, ring_length, 1e-9 * ring_length);
}

PlanarMesh meshed(const std::vector<Ring>& rings, double edge_length, double angle = 25) {
    PlanarMesh mesh = mesh_region(rings, {.edge_length = edge_length});
    expect_valid(mesh);
    expect_border(mesh, rings);
    const double area = area_of(triangulate_rings(rings));
    EXPECT_NEAR(area_of(mesh), area, 1e-9 * area);
    EXPECT_GE(least_free_angle(mesh), angle);
    return mesh;
}

Ring moved(Ring ring, double x, double y) {
    for (PlanPoint& p : ring)
        p = {p[0] + x, p[1] + y};
    return ring;
}

TEST(RegionMesh, SquareWithTwoHoles) {
    const std::vector<Ring> rings{
        rectangle(0, 0, 100, 100), rectangle(20, 20, 40, 40), {{60, 60}, {80, 65}, {70, 85}}};
    const PlanarMesh mesh = meshed(rings, 2.5, 27 - 1e-6);
    EXPECT_NEAR(mean_edge(mesh), 2.5, 0.05 * 2.5);
    const double equilateral = std::numbers::sqrt3 / 4 * 2.5 * 2.5;
    EXPECT_NEAR(static_cast<double>(mesh.triangles.size()), area_of(mesh) / equilateral,
                0.05 * static_cast<double>(mesh.triangles.size()));
    EXPECT_EQ(mesh.vertices[0], (PlanPoint{0, 0}));  // corners first, as they were
    EXPECT_EQ(mesh.vertices[10], (PlanPoint{70, 85}));
}

TEST(RegionMesh, LShapeAtUtmCoordinates) {
    const Ring shape{{0, 0}, {100, 0}, {100, 30}, {30, 30}, {30, 100}, {0, 100}};
    const PlanarMesh mesh = meshed({moved(shape, 431234.56, 5398765.43)}, 3);
    EXPECT_NEAR(mean_edge(mesh), 3, 0.15);
}

TEST(RegionMesh, SharpSpikes) {
    for (const double width : {20.0, 5.0, 1.0, 0.2}) {
        meshed({{{0, 0}, {100, -width / 2}, {100, width / 2}}}, 4);
        // A sharp notch: the angle outside the region is not the mesh's business.
        meshed({{{0, 0},
                 {100, 0},
                 {100, 50 - width / 2},
                 {20, 50},
                 {100, 50 + width / 2},
                 {100, 100},
                 {0, 100}}},
               4);
    }
}

TEST(RegionMesh, HolesThatTouch) {
    meshed({rectangle(0, 0, 10, 10),
            {{5, 0}, {6, 2}, {4, 2}},
            {{10, 10}, {8, 9}, {9, 8}},
            {{4, 4}, {6, 5}, {5, 6}},
            {{6, 5}, {8, 5}, {7, 6}}},
           0.5);
    // Touches the slanted edge of the outline exactly in its middle.
    meshed({{{0, 0}, {9, 3}, {0, 12}}, {{3, 1}, {3, 3}, {2, 3}}}, 0.4);
}

TEST(RegionMesh, PartsAndIslands) {
    meshed({rectangle(0, 0, 10, 10), rectangle(2, 2, 8, 8), rectangle(4, 4, 6, 6),
            rectangle(20, 0, 23, 1)},
           0.7);
}

TEST(RegionMesh, EdgeLengthLargerThanTheRegion) {
    const PlanarMesh mesh = meshed({rectangle(0, 0, 1, 1)}, 50);
    EXPECT_EQ(mesh.triangles.size(), 2U);
}

TEST(RegionMesh, FineDetailIsGradedTo) {
    Ring coast;  // pieces a fiftieth of the edge length
    for (int i = 0; i < 400; ++i)
        coast.push_back({0.1 * i, i % 2 == 0 ? 0.0 : 0.05});
    coast.push_back({40, 30});
    coast.push_back({0, 30});
    const PlanarMesh mesh = meshed({coast}, 5);
    EXPECT_LT(mesh.triangles.size(), 20'000U);
}

TEST(RegionMesh, NarrowGapsDoNotRunAway) {
    // A strip 1e-7 wide beside a hole: detail below a thousandth of the edge length is kept as it
    // is.
    const std::vector<Ring> rings{rectangle(0, 0, 10, 10), rectangle(2, 1e-7, 8, 5)};
    const PlanarMesh mesh = meshed(rings, 1, 0);
    EXPECT_LT(mesh.triangles.size(), 60'000U);
}

TEST(RegionMesh, RandomStars) {
    std::mt19937 random(11);
    const auto uniform = [&] { return static_cast<double>(random()) / 4294967296.0; };
    for (int round = 0; round < 40; ++round) {
        const int corners = 3 + static_cast<int>(random() % 60);
        Ring star, hole;
        for (int i = 0; i < corners; ++i) {
            const double turn = 2 * std::numbers::pi * (i + 0.3 * uniform()) / corners;
            const double radius = 20 + 80 * uniform();
            star.push_back({1e5 + radius * std::cos(turn), 4e6 + radius * std::sin(turn)});
            hole.push_back(
                {1e5 + 0.4 * radius * std::cos(turn), 4e6 + 0.4 * radius * std::sin(turn)});
        }
        SCOPED_TRACE(round);
        try {
            triangulate_region(std::vector<Ring>{star, hole});
        } catch (const InputError&) {
            continue;  // three corners may reach round the center
        }
        meshed({star, hole}, 2 + 10 * uniform());
    }
}

TEST(RegionMesh, SameBytesEveryTime) {
    const std::vector<Ring> rings{
        rectangle(0, 0, 64, 64), rectangle(16, 16, 32, 32), {{60, 60}, {50, 61}, {60, 62}}};
    const PlanarMesh first = mesh_region(rings, {.edge_length = 1});
    const std::vector<std::string> elsewhere(1000, "moves the heap about, so addresses differ");
#if defined(_OPENMP)
    omp_set_num_threads(1);
#endif
    const PlanarMesh second = mesh_region(rings, {.edge_length = 1});
    EXPECT_EQ(first.vertices, second.vertices);
    EXPECT_EQ(first.triangles, second.triangles);
}

TEST(RegionMesh, RefusesWhatDoesNotFit) {
    const std::vector<Ring> rings{rectangle(0, 0, 1000, 1000)};
    for (const double bad : {0.0, -1.0, std::nan(""), HUGE_VAL}) {
        EXPECT_EQ(refusal([&] { mesh_region(rings, {.edge_length = bad}); }).kind, "edge_length");
    }
    const InputError large = refusal([&] { mesh_region(rings, {.edge_length = 1e-3}); });
    EXPECT_EQ(large.kind, "too_large");
    EXPECT_NE(std::string(large.what()).find("at least"), std::string::npos) << large.what();
    EXPECT_EQ(refusal([&] { mesh_region(rings, {.edge_length = 1e-300}); }).kind, "too_large");
    const std::vector<Ring> far{moved(rectangle(0, 0, 1e-6, 1e-6), 5e6, 5e6)};
    EXPECT_EQ(refusal([&] { mesh_region(far, {.edge_length = 1e-7}); }).kind, "edge_length");
    EXPECT_EQ(
        refusal([&] {
            mesh_region(std::vector<Ring>{{{0, 0}, {1, 1}, {1, 0}, {0, 1}}}, {.edge_length = 1});
        }).kind,
        "outline_crosses");
}

TEST(RegionMesh, TheEdgeLengthItNamesFits) {
    const std::vector<Ring> rings{rectangle(0, 0, 1000, 1000)};
    const std::string text = refusal([&] { mesh_region(rings, {.edge_length = 1e-3}); }).what();
    const double least = std::stod(text.substr(text.find("at least ") + 9));
    const MeshEstimate fits = estimate_region_mesh(rings, {.edge_length = 1.02 * least});
    const MeshEstimate does_not = estimate_region_mesh(rings, {.edge_length = 0.9 * least});
    EXPECT_LT(fits.triangles, 2147483647.0);
    EXPECT_GT(does_not.triangles, 0.9 * fits.triangles);
}

TEST(RegionMesh, StopsSoonAfterCancel) {
    const std::vector<Ring> rings{rectangle(0, 0, 1000, 1000)};
    for (const double reached : {0.0, 0.02, 0.1, 0.2}) {
        Progress progress;
        std::atomic<double> asked{};
        std::jthread watcher([&] {
            while (progress.fraction() < reached)
                std::this_thread::yield();
            progress.cancel();
            asked = progress.fraction();
        });
        EXPECT_THROW(mesh_region(rings, {.edge_length = 0.6}, &progress), Cancelled);
        watcher.join();
        // The step in hand may be told as done, which the fraction takes for up to a tenth; the
        // rest is left, however long that takes.
        EXPECT_LT(progress.fraction() - asked.load(), 0.15);
    }
}

}  // namespace
}  // namespace realmodel::meshing
