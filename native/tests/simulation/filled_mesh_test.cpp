// SPDX-License-Identifier: GPL-3.0-or-later
#include "realmodel/simulation/filled_mesh.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <string>
#include <vector>

#include "../sanitized.hpp"
#include "realmodel/base/errors.hpp"
#include "simulation/tetrahedra_repair.hpp"

namespace realmodel::simulation {
namespace {

using Triangle = std::array<std::int32_t, 3>;

/// Cells of faces with four corners.
struct QuadComplex {
    std::vector<double> vertices;
    std::vector<std::int32_t> block;  // of each cell
    std::vector<std::int64_t> offsets{0};
    std::vector<std::int32_t> corners, cells, surface;

    void add(const std::array<std::int32_t, 4>& loop, std::int32_t first, std::int32_t second,
             std::int32_t on) {
        corners.insert(corners.end(), loop.begin(), loop.end());
        offsets.push_back(static_cast<std::int64_t>(corners.size()));
        cells.insert(cells.end(), {first, second});
        surface.push_back(on);
    }
    ComplexView view(std::size_t blocks, std::int32_t surfaces) const {
        return {.vertices = vertices,
                .face_offsets = offsets,
                .face_vertices = corners,
                .face_cells = cells,
                .face_surface = surface,
                .cell_block = block,
                .blocks = blocks,
                .surfaces = surfaces};
    }
};

/// A box divided by an inclined face, which is a fault (surface 0).
struct DividedBox : QuadComplex {
    DividedBox() {
        // below at y = 0 and 6, then above, then the ends of the fault below and above
        vertices = {0,  0, 0, 10, 0, 0, 10, 6, 0, 0, 6, 0, 0, 0, 8, 10, 0, 8,
                    10, 6, 8, 0,  6, 8, 4,  0, 0, 4, 6, 0, 6, 0, 8, 6,  6, 8};
        block = {0, 0};
        add({8, 9, 11, 10}, 0, 1, 0);
        add({0, 3, 9, 8}, 0, -1, 1);
        add({4, 10, 11, 7}, 0, -1, 2);
        add({0, 4, 7, 3}, 0, -1, -1);
        add({0, 8, 10, 4}, 0, -1, -1);
        add({3, 7, 11, 9}, 0, -1, -1);
        add({8, 9, 2, 1}, 1, -1, 1);
        add({10, 5, 6, 11}, 1, -1, 2);
        add({1, 2, 6, 5}, 1, -1, -1);
        add({8, 1, 5, 10}, 1, -1, -1);
        add({9, 11, 6, 2}, 1, -1, -1);
    }
    FilledMesh filled(double edge_length, double tolerance,
                      const std::vector<std::int32_t>& regions = {0, 1},
                      const std::vector<meshing::LocalLength>& sizes = {}) const {
        return filled_mesh(view(1, 3), regions, std::vector<std::uint8_t>{1, 0, 0}, edge_length,
                           tolerance, sizes, {1, nullptr});
    }
};

Triangle sorted(Triangle face) {
    std::sort(face.begin(), face.end());
    return face;
}

/// How many tetrahedra have each face.
std::map<Triangle, int> faces_of(const FilledMesh& mesh) {
    std::map<Triangle, int> found;
    for (const auto& t : mesh.tetrahedra) {
        for (std::size_t i = 0; i < 4; ++i)
            ++found[sorted({t[(i + 1) % 4], t[(i + 2) % 4], t[(i + 3) % 4]})];
    }
    return found;
}

double volume(const FilledMesh& mesh, std::int32_t region) {
    double sum = 0;
    for (std::size_t t = 0; t < mesh.tetrahedra.size(); ++t)
        if (mesh.region[t] == region) sum += six_volumes(mesh, mesh.tetrahedra[t]) / 6;
    return sum;
}

/// Positive, conforming, and with all faces of the outside given once.
void expect_valid(const FilledMesh& mesh) {
    ASSERT_FALSE(mesh.tetrahedra.empty());
    for (const auto& t : mesh.tetrahedra)
        EXPECT_GT(six_volumes(mesh, t), 0);
    std::map<Triangle, int> given;
    for (const Triangle& face : mesh.triangles)
        ++given[sorted(face)];
    for (const auto& [face, times] : given)
        EXPECT_EQ(times, 1);
    std::map<std::array<std::int32_t, 2>, int> edges;
    for (const auto& [face, times] : faces_of(mesh)) {
        EXPECT_LE(times, 2);
        if (times > 1) continue;
        EXPECT_TRUE(given.contains(face));
        for (std::size_t i = 0; i < 3; ++i)
            for (std::size_t j = i + 1; j < 3; ++j)
                ++edges[{face[i], face[j]}];
    }
    for (const auto& [edge, times] : edges)
        EXPECT_EQ(times % 2, 0);
}

TEST(FilledMeshTest, AnInclinedFaultDividesABox) {
    const DividedBox box;
    const FilledMesh mesh = box.filled(1.5, 0.2);
    expect_valid(mesh);
    EXPECT_NEAR(volume(mesh, 0), 240, 2.4);
    EXPECT_NEAR(volume(mesh, 1), 240, 2.4);
    std::size_t on_fault = 0;
    for (std::size_t f = 0; f < mesh.triangles.size(); ++f) {
        if (mesh.surface[f] != 0) continue;
        ++on_fault;
        for (const std::int32_t v : mesh.triangles[f]) {
            const auto& p = mesh.points[static_cast<std::size_t>(v)];
            EXPECT_NEAR(p[0], 4 + p[2] / 4, 0.2);
        }
    }
    EXPECT_GT(on_fault, 30u);
}

/// Three layers in a box; the one in the middle is as thin as doubles allow.
TEST(FilledMeshTest, ALayerThinnerThanRoundingOfSharesOfARayIsInItsPlaceAlone) {
    QuadComplex layers;
    layers.block = {0, 1, 2};
    for (std::int32_t level = 0; level < 4; ++level) {
        for (const auto& [x, y] : {std::array{0.1, 0.2}, {3.1, 0.2}, {3.1, 2.2}, {0.1, 2.2}}) {
            const double middle = 1 + 0.3 * x + 0.1 * y;
            const std::array heights{0.0, middle, std::nextafter(middle, 9), 3.0};
            layers.vertices.insert(layers.vertices.end(),
                                   {x, y, heights[static_cast<std::size_t>(level)]});
        }
    }
    for (const std::int32_t level : {3, 2, 1}) {
        const std::int32_t v = 4 * level;
        layers.add({v, v + 1, v + 2, v + 3}, level - 1, level < 3 ? level : -1, level);
    }
    layers.add({0, 3, 2, 1}, 0, -1, 0);
    for (std::int32_t cell = 0; cell < 3; ++cell) {
        for (std::int32_t i = 0; i < 4; ++i) {
            const std::int32_t a = 4 * cell + i, b = 4 * cell + (i + 1) % 4;
            layers.add({a, b, b + 4, a + 4}, cell, -1, -1);
        }
    }
    const FilledMesh mesh = filled_mesh(layers.view(3, 4), std::array{0, 1, 2},
                                        std::vector<std::uint8_t>(4), 0.4, 0.1, {}, {1, nullptr});
    EXPECT_NEAR(volume(mesh, 0), 9.6, 0.3);
    EXPECT_EQ(volume(mesh, 1), 0);
    EXPECT_NEAR(volume(mesh, 2), 8.4, 0.3);
}

TEST(FilledMeshTest, AKeptSurfaceWithinOneRegionHasFaces) {
    const FilledMesh mesh = DividedBox().filled(2, 0.3, {0, 0});
    expect_valid(mesh);
    EXPECT_NEAR(volume(mesh, 0), 480, 4.8);
    EXPECT_GT(std::count(mesh.surface.begin(), mesh.surface.end(), 0), 10);
}

TEST(FilledMeshTest, EveryLengthEnds) {
    const DividedBox box;
    for (const double edge : {0.8, 1.1, 1.6, 2.0, 2.5})
        for (const double share : {0.1, 0.25, 0.5}) {
            if (kSanitized && edge < 1.5) continue;
            expect_valid(box.filled(edge, share * edge));
        }
}

TEST(FilledMeshTest, EveryLocalLengthEnds) {
    const DividedBox box;
    for (const double local : {0.3, 0.8})
        for (const double distance : {0.0, 2.0})
            for (const double share : {0.25, 1.0}) {
                if (kSanitized && (local < 0.5 || share < 0.5)) continue;
                expect_valid(box.filled(2, share * local, {0, 1}, {{{{5, 2}}, local, distance}}));
            }
}

/// The mean length of the edges whose middles lie nearer to a line along z than `reach`, or
/// farther.
double mean_edge(const FilledMesh& mesh, double x, double y, double reach, bool is_near) {
    double sum = 0, count = 0;
    for (const auto& t : mesh.tetrahedra) {
        for (std::size_t i = 0; i < 4; ++i) {
            for (std::size_t j = 0; j < i; ++j) {
                const auto &a = mesh.points[static_cast<std::size_t>(t[i])],
                           &b = mesh.points[static_cast<std::size_t>(t[j])];
                const double away = std::hypot((a[0] + b[0]) / 2 - x, (a[1] + b[1]) / 2 - y);
                if ((away < reach) != is_near) continue;
                sum += std::hypot(a[0] - b[0], a[1] - b[1], a[2] - b[2]);
                ++count;
            }
        }
    }
    return sum / count;
}

TEST(FilledMeshTest, EdgesAreShorterWhereAsked) {
    const DividedBox box;
    const FilledMesh plain = box.filled(2, 0.2);
    for (const meshing::PlanPoint& place : {meshing::PlanPoint{0, 0}, {10, 3}}) {
        const auto [x, y] = place;
        const FilledMesh mesh = box.filled(2, 0.2, {0, 1}, {{{place}, 0.5, 1}});
        expect_valid(mesh);
        EXPECT_NEAR(volume(mesh, 0), 240, 2.4);
        EXPECT_NEAR(volume(mesh, 1), 240, 2.4);
        const double fine = mean_edge(mesh, x, y, 1, true);
        EXPECT_GT(fine, 0.3);
        EXPECT_LT(fine, 0.8);
        // from 7 m on edges are as long as without
        EXPECT_NEAR(mean_edge(mesh, x, y, 7, false) / mean_edge(plain, x, y, 7, false), 1, 0.2);
    }
}

TEST(FilledMeshTest, SizesWithoutPlacesAreThoseOfSharpEdges) {
    const FilledMesh mesh = DividedBox().filled(3, 0.2, {0, 1}, {{{}, 0.6, 0}});
    expect_valid(mesh);
    EXPECT_LT(mean_edge(mesh, 0, 0, 1, true), 0.9);
    EXPECT_GT(mean_edge(mesh, 8, 3, 1.5, true), 1);
}

TEST(FilledMeshTest, LocalLengthsThatCannotBeAreRefused) {
    const auto kind = [](const meshing::LocalLength& size) -> std::string {
        try {
            DividedBox().filled(2, 0.0001, {0, 1}, {size});
        } catch (const InputError& error) {
            return error.kind;
        }
        return "";
    };
    EXPECT_EQ(kind({{{5, 3}}, 2, 0}), "size");
    EXPECT_EQ(kind({{{5, 3}}, 0.00009, 0}), "size");
    EXPECT_EQ(kind({{{5, 3}}, 0.001, 3}), "too_large");
}

TEST(FilledMeshTest, WhatIsTooCoarseIsRefused) {
    try {
        DividedBox().filled(1000, 500);
        FAIL();
    } catch (const InputError& error) {
        EXPECT_EQ(error.kind, "nothing");
    }
}

TEST(FilledMeshTest, ThereIsOneRegionForEachCell) {
    EXPECT_THROW(DividedBox().filled(2, 0.3, {0}), InputError);
}

/// Corners 0 to 3 of a tetrahedron, and 4 below it.
FilledMesh corner_mesh() {
    return {
        .points = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {0.3, 0.3, -1}},
        .tetrahedra = {{0, 1, 2, 3}, {0, 2, 1, 4}},
        .region = {0, 1},
        .triangles = {{0, 1, 3}, {1, 2, 3}, {2, 0, 3}, {1, 0, 4}, {2, 1, 4}, {0, 2, 4}, {0, 1, 2}},
        .surface = {1, 2, 3, 4, 5, 6, 0}};
}

TEST(CornerTetrahedraTest, ThreeFacesOutsideAreDivided) {
    FilledMesh mesh = corner_mesh();
    divide_corner_tetrahedra(mesh, nullptr);
    expect_valid(mesh);
    const auto faces = faces_of(mesh);
    for (const auto& t : mesh.tetrahedra) {
        int outside = 0;
        for (std::size_t i = 0; i < 4; ++i)
            outside += faces.at(sorted({t[(i + 1) % 4], t[(i + 2) % 4], t[(i + 3) % 4]})) == 1;
        EXPECT_LE(outside, 1);
    }
    EXPECT_NEAR(volume(mesh, 0) + volume(mesh, 1), 1.0 / 3, 1e-12);
    EXPECT_NEAR(volume(mesh, 0), 1.0 / 6, 1e-12);
}

TEST(CornerTetrahedraTest, ASingleTetrahedronIsLeftOut) {
    FilledMesh mesh = corner_mesh();
    mesh.points.insert(mesh.points.end(), {{5, 0, 0}, {6, 0, 0}, {5, 1, 0}, {5, 0, 1}});
    // of four faces outside, none is inside
    mesh.tetrahedra.push_back({5, 6, 7, 8});
    mesh.region.push_back(0);
    for (const Triangle& face : {Triangle{5, 7, 6}, {5, 6, 8}, {6, 7, 8}, {7, 5, 8}}) {
        mesh.triangles.push_back(face);
        mesh.surface.push_back(7);
    }
    divide_corner_tetrahedra(mesh, nullptr);
    expect_valid(mesh);
    EXPECT_NEAR(volume(mesh, 0) + volume(mesh, 1), 1.0 / 3, 1e-12);
    EXPECT_EQ(std::count(mesh.surface.begin(), mesh.surface.end(), 7), 0);
    for (const auto& p : mesh.points)
        EXPECT_LT(p[0], 2);
}

/// An octahedron of eight tetrahedra around its point 6. Above and below are two regions.
FilledMesh octahedron(const std::array<double, 3>& middle, bool is_divided) {
    FilledMesh mesh;
    mesh.points = {{1, 0, 0}, {0, 1, 0}, {-1, 0, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}, middle};
    for (std::int32_t i = 0; i < 4; ++i) {
        const std::int32_t j = (i + 1) % 4;
        mesh.tetrahedra.push_back({6, i, j, 4});
        mesh.tetrahedra.push_back({6, j, i, 5});
        mesh.region.insert(mesh.region.end(), {0, is_divided ? 1 : 0});
        mesh.triangles.push_back({i, j, 4});
        mesh.triangles.push_back({j, i, 5});
        mesh.surface.insert(mesh.surface.end(), {1, 2});
        if (!is_divided) continue;
        mesh.triangles.push_back({i, j, 6});
        mesh.surface.push_back(0);
    }
    return mesh;
}

double volume_of_all(const FilledMesh& mesh) {
    return volume(mesh, 0) + volume(mesh, 1);
}

TEST(OutsideCoversTest, ACornerIsCoveredByBothRegionsThatMeetThere) {
    FilledMesh mesh = octahedron({0, 0, 0}, true);
    ASSERT_TRUE(TetrahedraRound(mesh).cover(std::array{0}, {2, 0, 0}));
    expect_valid(mesh);
    // the faces of a region are a triangle of area 1, seen along x; the new point is 1 farther out
    EXPECT_NEAR(volume(mesh, 0), 2.0 / 3 + 1.0 / 3, 1e-12);
    EXPECT_NEAR(volume(mesh, 1), volume(mesh, 0), 1e-12);
    EXPECT_EQ(std::count(mesh.surface.begin(), mesh.surface.end(), 0), 4 + 2);
    for (std::size_t f = 0; f < mesh.triangles.size(); ++f) {
        for (const std::int32_t v : mesh.triangles[f])
            EXPECT_TRUE(mesh.surface[f] != 0 || mesh.points[static_cast<std::size_t>(v)][2] == 0);
    }
}

TEST(OutsideCoversTest, AnEdgeIsCoveredByTheRegionsOfItsFaces) {
    FilledMesh mesh = octahedron({0, 0, 0}, true);
    TetrahedraRound covers(mesh);
    ASSERT_TRUE(covers.cover(std::array{0, 1}, {0.8, 0.8, 0}));
    EXPECT_FALSE(covers.cover(std::array{1}, {0, 1.5, 0}));  // touches what was covered
    expect_valid(mesh);
    EXPECT_NEAR(volume_of_all(mesh), 4.0 / 3 + 0.6 / 3, 1e-12);
    EXPECT_NEAR(volume(mesh, 1), volume(mesh, 0), 1e-12);
    EXPECT_EQ(std::count(mesh.surface.begin(), mesh.surface.end(), 0), 4 + 1);
}

TEST(OutsideCoversTest, NothingIsCoveredByTurnedOrFlatElements) {
    FilledMesh mesh = octahedron({0, 0, 0}, true);
    for (const double x : {0.5, 1.0, 1.0001}) {
        EXPECT_FALSE(TetrahedraRound(mesh).cover(std::array{0}, {x, 0, 0}));
        EXPECT_EQ(mesh.points.size(), 7);
    }
    EXPECT_NEAR(volume_of_all(mesh), 4.0 / 3, 1e-12);
}

double flattest(const FilledMesh& mesh) {
    double least = 1;
    for (const auto& corners : mesh.tetrahedra)
        least = std::min(least, roundness(mesh, corners));
    return least;
}

TEST(FlatTetrahedraTest, RoundnessIsThatOfCheckMesh) {
    FilledMesh mesh;
    mesh.points = {{1, 1, 1}, {-1, -1, 1}, {-1, 1, -1}, {1, -1, -1}, {0, 0, 1}};
    EXPECT_NEAR(roundness(mesh, {0, 1, 2, 3}), 64.0 / 27 / 8, 1e-12);
    EXPECT_EQ(roundness(mesh, {0, 1, 4, 4}), 0);
}

TEST(FlatTetrahedraTest, CornersInsideMoveUntilNothingIsFlat) {
    FilledMesh mesh = octahedron({0.33, 0.33, 0.33}, false);
    const auto before = mesh.points;
    ASSERT_LT(flattest(mesh), 0.001);
    EXPECT_EQ(thicken_flat_tetrahedra(mesh, 0.01, nullptr), 0u);
    EXPECT_GE(flattest(mesh), 0.002);
    expect_valid(mesh);
    EXPECT_NE(mesh.points[6], before[6]);
    for (std::size_t i = 0; i < 6; ++i)
        EXPECT_EQ(mesh.points[i], before[i]);
}

TEST(FlatTetrahedraTest, CornersOnSurfacesMoveByHalfOfTheToleranceAtMost) {
    for (const double tolerance : {0.02, 0.1}) {
        FilledMesh mesh = octahedron({0.33, 0.33, 0.33}, true);
        const double before = flattest(mesh);
        const std::size_t left = thicken_flat_tetrahedra(mesh, tolerance, nullptr);
        EXPECT_GT(flattest(mesh), before);
        EXPECT_EQ(left == 0, flattest(mesh) >= 0.002);
        expect_valid(mesh);
        double moved = 0;
        for (const double x : mesh.points[6])
            moved += (x - 0.33) * (x - 0.33);
        EXPECT_GT(moved, 0);
        EXPECT_LE(moved, 0.25 * tolerance * tolerance);
    }
}

TEST(FlatTetrahedraTest, WhatIsRoundStays) {
    FilledMesh mesh = octahedron({0.1, 0, 0}, false);
    const auto before = mesh.points;
    EXPECT_EQ(thicken_flat_tetrahedra(mesh, 1, nullptr), 0u);
    EXPECT_EQ(mesh.points, before);
}

}  // namespace
}  // namespace realmodel::simulation
