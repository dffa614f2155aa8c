// SPDX-License-Identifier: GPL-3.0-or-later
#include "realmodel/strata/stack.hpp"

#include <algorithm>
#include <cmath>
#include <set>

#include "complex_checks.hpp"
#include "realmodel/base/errors.hpp"

namespace realmodel::strata {
namespace {

OwnedSurface flat(double z, bool other = false) {
    return grid(
        1, 1, 0, 0, 1, 1, [z](double, double) { return z; }, other);
}

TEST(Stack, OneSlabBetweenTwoSquares) {
    const auto c = build({flat(0), flat(2)});
    expect_valid(c);
    EXPECT_EQ(cells_of_blocks(c), (std::vector<int>{0, 2}));  // a column a triangle
    EXPECT_EQ(c.volumes, (std::vector<double>{0, 2}));
    EXPECT_EQ(c.vertices.size(), 8u);
    EXPECT_EQ(c.face_cells.size(), 2u + 2u + 4u + 1u);
}

TEST(Stack, TwoCrossingPlanesOnOneSquare) {
    // z = x - 1/2 cuts the slab top z = 0 in the line x = 1/2; beneath the lower half the floor.
    const auto c = build(
        {flat(-1), flat(0), grid(1, 1, 0, 0, 1, 1, [](double x, double) { return x - 0.5; })});
    expect_valid(c);
    EXPECT_DOUBLE_EQ(c.volumes[1], 1.0 - 0.125);
    EXPECT_DOUBLE_EQ(c.volumes[2], 0.125);
    for (const auto& v : c.vertices) {
        EXPECT_TRUE(v[0] == 0.0 || v[0] == 0.5 || v[0] == 1.0) << v[0];
    }
}

TEST(Stack, ThreePlanesThroughOneLine) {
    const auto plane = [](double slope, bool other) {
        return grid(
            1, 1, 0, 0, 1, 1, [slope](double x, double) { return slope * (x - 0.5); }, other);
    };
    const auto c = build({flat(-2), plane(1, false), plane(0, true), plane(-1, false)});
    expect_valid(c);
    // record lows: left of the line z = x - 1/2 is lowest (the oldest), right of it z = 1/2 - x
    EXPECT_DOUBLE_EQ(c.volumes[1], 2.0 - 0.25);
    EXPECT_DOUBLE_EQ(c.volumes[2], 0.125);
    EXPECT_DOUBLE_EQ(c.volumes[3], 0.125);
    std::set<double> on_line;
    for (const auto& v : c.vertices) {
        if (v[0] == 0.5 && v[2] > -1) on_line.insert(v[2]);
    }
    EXPECT_EQ(on_line, std::set<double>{0.0});
}

TEST(Stack, AConeWhoseTipTouches) {
    // The tip of an upward cone touches the plane above in one vertex; nothing is pinched off.
    OwnedSurface cone;
    const auto tip = cone.vertex(0, 0, 0);
    std::vector<std::int32_t> rim;
    for (const auto& [x, y] :
         {std::pair{1, 0}, {1, 1}, {0, 1}, {-1, 1}, {-1, 0}, {-1, -1}, {0, -1}, {1, -1}}) {
        rim.push_back(cone.vertex(x, y, -1));
    }
    for (std::size_t i = 0; i < 8; ++i)
        cone.triangle(tip, rim[i], rim[(i + 1) % 8]);
    const auto lid = grid(1, 1, -1, -1, 1, 1, [](double, double) { return 0; });
    const auto c = build({cone, lid});
    expect_valid(c);
    EXPECT_NEAR(c.volumes[1], 4.0 - 4.0 / 3.0, 1e-15);
    const auto downward =
        build({grid(1, 1, -1, -1, 1, 1, [](double, double) { return -1; }), cone});
    expect_valid(downward);
    EXPECT_NEAR(downward.volumes[1], 4.0 / 3.0, 1e-15);
}

TEST(Stack, SurfacesThatCoincideOverHalf) {
    const auto lower = grid(2, 1, 0, 0, 2, 1, [](double, double) { return 0; });
    const auto upper = grid(
        2, 1, 0, 0, 2, 1, [](double x, double) { return std::max(0.0, x - 1); }, true);
    const auto c = build({lower, upper}, -1.0);
    expect_valid(c);
    EXPECT_DOUBLE_EQ(c.volumes[0], 2.0);
    EXPECT_DOUBLE_EQ(c.volumes[1], 0.5);
    // no sliver where they coincide
    for (const auto& v : c.vertices)
        EXPECT_TRUE(v[0] >= 1 || v[2] <= 0);
}

TEST(Stack, ARepeatedSurfaceLeavesNoBlock) {
    const auto s = grid(3, 3, 0, 0, 1, 1, [](double x, double y) { return x * y; });
    const auto c = build({flat(-1), s, s, flat(2)});
    expect_valid(c);
    EXPECT_EQ(cells_of_blocks(c)[2], 0);
    EXPECT_EQ(c.volumes[2], 0.0);
}

TEST(Stack, OneUnitInTheLastPlaceIsALayer) {
    const double z = 0.1;
    const auto c = build({flat(z), flat(std::nextafter(z, 1), true)});
    expect_valid(c);
    EXPECT_NEAR(c.volumes[1], std::nextafter(z, 1) - z, 1e-20);
    EXPECT_GT(cells_of_blocks(c)[1], 0);
}

TEST(Stack, ErosionLeavesTwoBodies) {
    const auto valley = grid(
        4, 1, 0, 0, 4, 1, [](double x, double) { return std::abs(x - 2) - 0.5; }, true);
    const auto floor = grid(1, 1, 0, 0, 4, 1, [](double, double) { return -1; });
    const auto top = grid(1, 1, 0, 0, 4, 1, [](double, double) { return 0; });
    const auto c = merge_columns(build({floor, top, valley}));
    expect_valid(c, true);
    EXPECT_EQ(cells_of_blocks(c), (std::vector<int>{0, 1, 2}));
    EXPECT_DOUBLE_EQ(c.volumes[2], 2 * 1.5 * 1.5 / 2);
}

TEST(Stack, PartialCoverageStandsAsWalls) {
    const auto patch = grid(2, 2, 0.25, 0.25, 0.75, 0.75, [](double, double) { return 1; });
    const auto c = build({flat(0), patch, flat(2)});
    expect_valid(c);
    EXPECT_DOUBLE_EQ(c.volumes[1], 0.25);
    EXPECT_DOUBLE_EQ(c.volumes[2], 2 - 0.25);
}

TEST(Stack, NothingOlderMeansNoBlock) {
    const auto island = grid(1, 1, 5, 5, 6, 6, [](double, double) { return 1; });
    const auto c = build({flat(0), island});
    EXPECT_TRUE(c.cell_block.empty());
    EXPECT_EQ(c.volumes, (std::vector<double>{0, 0}));
}

TEST(Stack, AJumpIsAWall) {
    OwnedSurface step;
    for (const auto& [x, z] : {std::pair{0.0, 1.0}, {0.5, 1.0}, {0.5, 2.0}, {1.0, 2.0}}) {
        step.vertex(x, 0, z);
        step.vertex(x, 1, z);
    }
    step.triangle(0, 2, 3);
    step.triangle(0, 3, 1);
    step.triangle(4, 6, 7);
    step.triangle(4, 7, 5);
    const auto c = build({flat(0), step, flat(3)});
    expect_valid(c);
    EXPECT_DOUBLE_EQ(c.volumes[1], 1.5);
    EXPECT_DOUBLE_EQ(c.volumes[2], 1.5);
}

TEST(Stack, HeightsThatCrossInAWallGetAPointThere) {
    // Left of x = 1 the interface falls along y, right of it it rises: in the wall they cross.
    OwnedSurface scissors;
    scissors.vertex(0, 0, 1), scissors.vertex(0, 1, 2), scissors.vertex(1, 0, 1),
        scissors.vertex(1, 1, 2);
    scissors.vertex(1, 0, 2), scissors.vertex(1, 1, 1), scissors.vertex(2, 0, 2),
        scissors.vertex(2, 1, 1);
    scissors.triangle(0, 2, 3);
    scissors.triangle(0, 3, 1);
    scissors.triangle(4, 6, 7);
    scissors.triangle(4, 7, 5);
    const auto box = [](double z) {
        return grid(1, 1, 0, 0, 2, 1, [z](double, double) { return z; });
    };
    const auto c = build({box(0), scissors, box(3)});
    expect_valid(c);
    EXPECT_EQ(std::count(c.vertices.begin(), c.vertices.end(), std::array<double, 3>{1, 0.5, 1.5}),
              1);
    EXPECT_DOUBLE_EQ(c.volumes[1], 3.0);
}

TEST(Stack, TheRegionClips) {
    const std::vector<double> corners{0.25, 0.25, 0.75, 0.25, 0.75, 0.75, 0.25, 0.75};
    const std::vector<std::int32_t> triangles{0, 1, 2, 0, 2, 3};
    StackInput input;
    const auto lower = grid(3, 3, 0, 0, 1, 1, [](double x, double) { return x; });
    const auto upper = grid(
        4, 4, 0, 0, 1, 1, [](double, double y) { return 2 + y; }, true);
    input.surfaces = {lower.view(), upper.view()};
    input.region = TriangleView{corners, triangles};
    const auto c = build_stack(input, {1, nullptr});
    expect_valid(c);
    EXPECT_DOUBLE_EQ(c.volumes[1], 0.25 * 2.0);
    for (const auto& v : c.vertices) {
        EXPECT_GE(std::min(v[0], v[1]), 0.25);
        EXPECT_LE(std::max(v[0], v[1]), 0.75);
    }
}

TEST(Stack, ARegionWhoseTrianglesOverlapIsRefused) {
    const std::vector<double> corners{0, 0, 1, 0.4, 0, 1, 0.6, 0.8};
    const std::vector<std::int32_t> triangles{0, 1, 3, 0, 3, 2, 1, 3, 2};
    StackInput input;
    const auto lower = flat(0), upper = flat(1);
    input.surfaces = {lower.view(), upper.view()};
    input.region = TriangleView{corners, triangles};
    try {
        build_stack(input, {1, nullptr});
        FAIL();
    } catch (const InputError& e) {
        EXPECT_EQ(e.kind, "bad_region");
        EXPECT_EQ(e.items, (std::vector<std::int64_t>{0}));
    }
}

TEST(Stack, TheBaseCarriesBlockZero) {
    const auto c = build({flat(0), flat(1)}, -2.0);
    expect_valid(c);
    EXPECT_EQ(c.volumes, (std::vector<double>{2, 1}));
    EXPECT_EQ(std::count(c.face_surface.begin(), c.face_surface.end(), kBase), 2);
}

TEST(Stack, ABaseThatIsNotBelowIsRefusedWithThePlace) {
    try {
        build({grid(1, 1, 0, 0, 1, 1, [](double x, double y) { return x + y; }), flat(5)}, 0.0);
        FAIL();
    } catch (const InputError& e) {
        EXPECT_EQ(e.kind, "base_not_below");
        EXPECT_EQ(e.place, (std::array<double, 3>{0, 0, 0}));
    }
}

TEST(Stack, ABaseThatIsNoNumberIsRefused) {
    for (const double base : {std::nan(""), -HUGE_VAL, HUGE_VAL}) {
        EXPECT_THROW(build({flat(0), flat(1)}, base), InputError);
    }
}

TEST(Stack, DoubleValuedSurfacesAreRefusedWithBothTriangles) {
    OwnedSurface s = flat(0);
    const auto a = s.vertex(0.5, 0.1, 1), b = s.vertex(0.9, 0.1, 1), c = s.vertex(0.9, 0.3, 1);
    s.triangle(a, b, c);
    try {
        build({flat(-1), s});
        FAIL();
    } catch (const InputError& e) {
        EXPECT_EQ(e.kind, "double_valued");
        EXPECT_EQ(e.surface, 1);
        EXPECT_EQ(e.items, (std::vector<std::int64_t>{0, 2}));
        ASSERT_TRUE(e.place.has_value());
        EXPECT_GT((*e.place)[0], 0.5);
    }
}

TEST(Stack, UprightTrianglesAreRefusedAndFlatOnesLeftOut) {
    OwnedSurface s = flat(0);
    s.triangle(0, 0, 1);
    const auto c = build({flat(-1), s});
    ASSERT_EQ(c.warnings.size(), 1u);
    EXPECT_EQ(c.warnings[0].items, (std::vector<std::int64_t>{2}));
    EXPECT_DOUBLE_EQ(c.volumes[1], 1);
    s.triangle(0, 1, s.vertex(0, 0.5, 3));
    try {
        build({flat(-1), s});
        FAIL();
    } catch (const InputError& e) {
        EXPECT_EQ(e.kind, "vertical_triangle");
        EXPECT_EQ(e.items, (std::vector<std::int64_t>{3}));
    }
}

TEST(Stack, BadNumbersAndIndicesAreRefused) {
    OwnedSurface s = flat(0);
    s.vertices[4] = std::nan("");
    EXPECT_THROW(build({s}), InputError);
    OwnedSurface t = flat(0);
    t.triangles[2] = 4;
    EXPECT_THROW(build({t}), InputError);
}

/// Whether a vertex is a corner of a face: edges of some length that meet there at an angle.
std::vector<bool> corners_of_faces(const CellComplex& c) {
    std::vector<bool> is_corner(c.vertices.size(), false);
    for (std::size_t f = 0; f < c.face_cells.size(); ++f) {
        const auto begin = c.face_offsets[f], size = c.face_offsets[f + 1] - begin;
        for (std::int64_t i = 0; i < size; ++i) {
            const auto vertex = [&](std::int64_t j) {
                return static_cast<std::size_t>(
                    c.face_vertices[static_cast<std::size_t>(begin + j % size)]);
            };
            const auto &p = c.vertices[vertex(i)], &q = c.vertices[vertex(i + 1)],
                       &r = c.vertices[vertex(i + 2)];
            std::array<double, 3> u, v;
            for (std::size_t axis = 0; axis < 3; ++axis) {
                u[axis] = q[axis] - p[axis];
                v[axis] = r[axis] - q[axis];
            }
            for (std::size_t axis = 0; axis < 3; ++axis) {
                const std::size_t a = (axis + 1) % 3, b = (axis + 2) % 3;
                if (std::abs(u[a] * v[b] - u[b] * v[a]) > 1e-12) is_corner[vertex(i + 1)] = true;
            }
        }
    }
    return is_corner;
}

TEST(Stack, VerticesStandWhereAFaceHasACorner) {
    const auto wave = [](double height, double phase) {
        return [=](double x, double y) {
            return height + 0.1 * std::sin(3 * x + phase) * std::cos(2 * y - phase);
        };
    };
    // grids that have no inner line in common
    const auto c =
        build({grid(7, 6, 0, 0, 1, 1, wave(0, 0)), grid(5, 7, 0, 0, 1, 1, wave(1, 1), true),
               grid(8, 9, 0, 0, 1, 1, wave(2, 2)), grid(11, 5, 0, 0, 1, 1, wave(3, 3))});
    expect_valid(c);
    // On the border, where only one side has columns, all heights are joined up.
    const std::vector<bool> is_corner = corners_of_faces(c);
    std::size_t inside = 0;
    for (std::size_t v = 0; v < c.vertices.size(); ++v) {
        const auto& [x, y, z] = c.vertices[v];
        if (x == 0 || x == 1 || y == 0 || y == 1) continue;
        EXPECT_TRUE(is_corner[v]) << x << " " << y << " " << z;
        ++inside;
    }
    EXPECT_GT(inside, 400u);
}

TEST(Stack, EdgesThatTouchWhereTheyCross) {
    // The ridge of the older and the valley of the younger surface meet in one point of theirs.
    for (const double room : {0.0, 1e-12, 1e-3}) {
        const auto c = build(
            {flat(-2, true),
             grid(2, 1, 0, 0, 1, 1, [](double x, double) { return -std::abs(x - 0.5); }),
             grid(1, 2, 0, 0, 1, 1, [&](double, double y) { return room + std::abs(y - 0.5); })});
        expect_valid(c);
        EXPECT_NEAR(c.volumes[2], 0.5 + room, 1e-15);
        std::set<double> heights;
        for (const auto& v : c.vertices) {
            if (v[0] == 0.5 && v[1] == 0.5) heights.insert(v[2]);
        }
        // Nobody needs a vertex of the ridge beneath the valley's edge, nor on the edge over it,
        // but where they are that near.
        EXPECT_EQ(heights.count(0.0), 1u);
        EXPECT_EQ(heights.count(room), 1u - (room > 1e-6 ? 1u : 0u));
    }
}

TEST(Stack, AnyNumberOfThreadsGivesTheSame) {
    std::vector<OwnedSurface> surfaces;
    for (int k = 0; k < 5; ++k) {
        surfaces.push_back(grid(
            12 + k, 15 - k, 0, 0, 1, 1,
            [k](double x, double y) {
                return 0.1 * k + 0.2 * x * (k % 2 ? 1 : -1) + 0.1 * y * (k % 3 - 1);
            },
            k % 2 == 1));
    }
    const auto one = build(surfaces, -1.0, 1), four = build(surfaces, -1.0, 4);
    expect_valid(one);
    EXPECT_EQ(one.vertices, four.vertices);
    EXPECT_EQ(one.face_vertices, four.face_vertices);
    EXPECT_EQ(one.face_cells, four.face_cells);
    EXPECT_EQ(one.cell_block, four.cell_block);
    EXPECT_EQ(one.volumes, four.volumes);
}

// Two triangles become far more than the overlay makes room for beforehand, and the many facets
// after them less.
TEST(Stack, AFineSurfaceUnderACoarseOne) {
    const auto fine = [](double z, bool other) {
        return grid(
            36, 36, 0, 0, 1, 1,
            [z](double x, double y) { return z + 0.2 * std::sin(40 * x) * std::cos(30 * y); },
            other);
    };
    const std::vector<OwnedSurface> surfaces{fine(-1, false), flat(0, true), fine(0.1, true),
                                             flat(0.15)};
    const auto one = build(surfaces, std::nullopt, 1), two = build(surfaces, std::nullopt, 3);
    expect_valid(one);
    EXPECT_EQ(one.vertices, two.vertices);
    EXPECT_EQ(one.face_vertices, two.face_vertices);
    EXPECT_EQ(one.face_cells, two.face_cells);
    EXPECT_EQ(one.cell_block, two.cell_block);
}

TEST(Stack, ACancelledBuildThrows) {
    Progress progress;
    progress.cancel();
    StackInput input;
    const auto s = flat(0), t = flat(1);
    input.surfaces = {s.view(), t.view()};
    EXPECT_THROW(build_stack(input, {1, &progress}), Cancelled);
}

TEST(Stack, VolumesOfThinLayersHighUp) {
    // All places are whole multiples of 2^-10, at an elevation of 2^20: seen from there, terms keep
    // what a sum from height 0 would lose.
    const double up = 0x1p20, thin = 0x1p-10;
    const auto ground = [&](double x, double y) { return up + 0.25 * x + 0.5 * y; };
    const auto top = [&](double x, double y) { return ground(x, y) + thin; };
    for (const CellKind kind : {CellKind::kColumns, CellKind::kBlocks}) {
        const OwnedSurface low = grid(8, 8, 0, 0, 8, 8, ground),
                           high = grid(4, 4, 0, 0, 8, 8, top, true);
        StackInput input;
        input.surfaces = {low.view(), high.view()};
        input.rules.assign(2, Rule::kErosional);
        const auto c = build_stack(input, {1, nullptr}, kind);
        EXPECT_NEAR(c.volumes[1], 64 * thin, 64 * thin * 1e-13);
    }
}

TEST(Stack, TrianglesBesideABorderStayWholeInBlocks) {
    // Nothing meets, so nothing is cut, beside the border either; and a hole divides what is under
    // it.
    const auto level = [](double z) { return [z](double, double) { return z; }; };
    const OwnedSurface low = grid(6, 6, 0, 0, 6, 6, level(0)),
                       high = grid(4, 4, 0, 0, 6, 6, level(1), true);
    const auto faces = [&](const OwnedSurface& top) {
        StackInput input;
        input.surfaces = {low.view(), top.view()};
        input.rules.assign(2, Rule::kErosional);
        const auto c = build_stack(input, {1, nullptr}, CellKind::kBlocks);
        EXPECT_EQ(c.cell_block.size(), 1u);
        return std::count_if(c.face_surface.begin(), c.face_surface.end(),
                             [](std::int32_t s) { return s >= 0; });
    };
    EXPECT_EQ(faces(high), 2 * 36 + 2 * 16);
    OwnedSurface holed = high;
    const auto hole = holed.triangles.begin() + 3 * 10;
    holed.triangles.erase(hole, hole + 3);
    EXPECT_GT(faces(holed), 2 * 36 + 2 * 16 - 1);
}

TEST(Stack, WallsEndWhereACellTouchesItself) {
    // A hole touches the west side of the square in one point: the cell is all around it.
    OwnedSurface pierced;
    const auto a = pierced.vertex(0, 0, 0), b = pierced.vertex(9, 0, 0),
               c = pierced.vertex(9, 9, 0), d = pierced.vertex(0, 9, 0),
               touching = pierced.vertex(0, 4, 0), low = pierced.vertex(3, 3, 0),
               high = pierced.vertex(3, 5, 0);
    pierced.triangle(a, b, low);
    pierced.triangle(a, low, touching);
    pierced.triangle(low, b, high);
    pierced.triangle(b, c, high);
    pierced.triangle(c, d, high);
    pierced.triangle(d, touching, high);
    StackInput input;
    input.surfaces = {pierced.view()};
    input.base_elevation = -1.0;
    const auto blocks = build_stack(input, {1, nullptr}, CellKind::kBlocks);
    expect_valid(blocks, true);
    EXPECT_EQ(blocks.cell_block.size(), 1u);
    std::size_t along = 0;  // walls that have the vertical edge there
    for (std::size_t f = 0; f < blocks.face_surface.size(); ++f) {
        std::size_t there = 0;
        for (auto i = blocks.face_offsets[f]; i < blocks.face_offsets[f + 1]; ++i) {
            const std::int32_t v = blocks.face_vertices[static_cast<std::size_t>(i)];
            const auto& p = blocks.vertices[static_cast<std::size_t>(v)];
            there += p[0] == 0 && p[1] == 4;
        }
        along += there == 2;
    }
    EXPECT_EQ(along, 4u);
}

TEST(Stack, BlocksAreMergedColumns) {
    std::vector<OwnedSurface> surfaces;
    for (int k = 0; k < 4; ++k) {
        surfaces.push_back(grid(
            6, 6, 0, 0, 6, 6,
            [k](double x, double y) { return std::fmod(x * (k + 1) + y * (3 - k), 4.0); },
            k % 2 == 1));
    }
    const auto columns = build(surfaces, -1.0);
    expect_valid(columns);
    const auto merged = merge_columns(columns);
    expect_valid(merged, true);
    StackInput input;
    for (const OwnedSurface& s : surfaces)
        input.surfaces.push_back(s.view());
    input.base_elevation = -1.0;
    const auto blocks = build_stack(input, {1, nullptr}, CellKind::kBlocks);
    expect_valid(blocks, true);
    EXPECT_EQ(cells_of_blocks(blocks), cells_of_blocks(merged));
    for (std::size_t k = 0; k < 4; ++k)
        EXPECT_NEAR(blocks.volumes[k], columns.volumes[k], 1e-12);
}

TEST(Stack, LimitsHoldForTheRegionAndTheBaseToo) {
    const OwnedSurface floor = flat(0), top = flat(1);
    const std::vector<double> corners{0, 0, 1e60, 0, 0, 1};
    const std::vector<std::int32_t> triangle{0, 1, 2};
    const auto refusal = [](const StackInput& input) -> std::string {
        try {
            build_stack(input, {1, nullptr});
        } catch (const InputError& e) {
            EXPECT_EQ(e.kind, "not_finite");
            return e.what();
        }
        return {};
    };
    StackInput input{{floor.view(), top.view()}, {}, {}, {}, {}, {}};
    input.region = TriangleView{corners, triangle};
    EXPECT_NE(refusal(input).find("corner 1 of the region"), std::string::npos);
    input.region.reset();
    for (const double base : {-1e60, std::nan("")}) {
        input.base_elevation = base;
        EXPECT_NE(refusal(input).find("base elevation"), std::string::npos);
    }
}

using Faces = std::multiset<std::vector<std::array<double, 3>>>;

/// The faces of cells that lie within a window, each by its corners in order of their places.
Faces faces_of_cells_in(const CellComplex& c, double low, double high) {
    std::vector<std::uint8_t> inside(c.cell_block.size(), 1);
    const auto corners = [&](std::size_t f) {
        std::vector<std::array<double, 3>> found;
        for (auto i = c.face_offsets[f]; i < c.face_offsets[f + 1]; ++i) {
            found.push_back(
                c.vertices[static_cast<std::size_t>(c.face_vertices[static_cast<std::size_t>(i)])]);
        }
        std::ranges::sort(found);
        return found;
    };
    const auto each_cell = [&](std::size_t f, const auto& visit) {
        for (const std::int32_t cell : c.face_cells[f]) {
            if (cell >= 0) visit(static_cast<std::size_t>(cell));
        }
    };
    for (std::size_t f = 0; f < c.face_cells.size(); ++f) {
        for (const auto& p : corners(f)) {
            if (p[0] < low || p[0] > high || p[1] < low || p[1] > high)
                each_cell(f, [&](std::size_t cell) { inside[cell] = 0; });
        }
    }
    Faces faces;
    for (std::size_t f = 0; f < c.face_cells.size(); ++f)
        each_cell(f, [&](std::size_t cell) {
            if (inside[cell] != 0) faces.insert(corners(f));
        });
    return faces;
}

/// Only the triangles that lie in a window, or reach into it.
OwnedSurface part_of(const OwnedSurface& whole, double low, double high) {
    OwnedSurface part;
    part.vertices = whole.vertices;
    for (std::size_t t = 0; t < whole.triangles.size(); t += 3) {
        std::array least{HUGE_VAL, HUGE_VAL}, most{-HUGE_VAL, -HUGE_VAL};
        for (std::size_t i = 0; i < 3; ++i) {
            for (std::size_t k = 0; k < 2; ++k) {
                const double x =
                    whole.vertices[3 * static_cast<std::size_t>(whole.triangles[t + i]) + k];
                least[k] = std::min(least[k], x);
                most[k] = std::max(most[k], x);
            }
        }
        if (least[0] <= high && least[1] <= high && most[0] >= low && most[1] >= low)
            part.triangle(whole.triangles[t], whole.triangles[t + 1], whole.triangles[t + 2]);
    }
    return part;
}

TEST(Stack, WhatIsLocalFollowsFromTheTrianglesNearIt) {
    const auto wave = [](double z, double a) {
        return [=](double x, double y) { return z + 0.4 * std::sin(3 * x + a) * std::cos(2 * y); };
    };
    // lattices with lines in common, on which edges match here and do not match there
    const std::vector<OwnedSurface> whole{grid(16, 16, 0, 0, 8, 8, wave(0, 0)),
                                          grid(8, 8, 0, 0, 8, 8, wave(0.3, 1)),
                                          grid(12, 12, 0, 0, 8, 8, wave(0.5, 2))};
    std::vector<OwnedSurface> part;
    for (const OwnedSurface& s : whole)
        part.push_back(part_of(s, 2, 6));
    const auto built = [](const std::vector<OwnedSurface>& surfaces, bool is_local) {
        StackInput input;
        for (const OwnedSurface& s : surfaces)
            input.surfaces.push_back(s.view());
        input.base_elevation = -3;
        const CellComplex complex =
            build_rock_masses({&input, 1}, {2, nullptr}, CellKind::kColumns, nullptr, is_local);
        expect_valid(complex, false);
        return complex;
    };
    const CellComplex of_all = built(whole, true), of_piece = built(part, true);
    const Faces faces = faces_of_cells_in(of_all, 3, 5);
    EXPECT_GT(faces.size(), 500U);
    EXPECT_EQ(faces, faces_of_cells_in(of_piece, 3, 5));
    const CellComplex usual = built(whole, false);
    EXPECT_EQ(usual.cell_block.size(), of_all.cell_block.size());
    EXPECT_LT(usual.face_vertices.size(), of_all.face_vertices.size());
    for (std::size_t b = 0; b < usual.volumes.size(); ++b)
        EXPECT_NEAR(usual.volumes[b], of_all.volumes[b], 1e-12);
}

}  // namespace
}  // namespace realmodel::strata
