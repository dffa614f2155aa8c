// SPDX-License-Identifier: GPL-3.0-or-later
// Borders of one outline that were divided differently run through the same points.
#include "strata/repair/border_joining.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <vector>

namespace realmodel::strata {
namespace {

/// A triangle over the outline (0, 0), (3e6 + 0.1, 1e6 + 0.3), (0, 2e6), its long edge with or
/// without a vertex at the share given, rounded to doubles and so beside the line.
struct Outline {
    std::vector<double> vertices;
    std::vector<std::int32_t> triangles;

    explicit Outline(double z) : vertices{0, 0, z, kX, kY, z, 0, 2e6, z}, triangles{0, 1, 2} {}
    Outline(double z, double share) : Outline(z) {
        vertices.insert(vertices.end(), {share * kX, share * kY, z});
        triangles = {0, 3, 2, 3, 1, 2};
    }
    static constexpr double kX = 3e6 + 0.1, kY = 1e6 + 0.3;
};

StackInput stack_of(const std::vector<Outline>& outlines) {
    StackInput input;
    for (const Outline& o : outlines)
        input.surfaces.push_back({o.vertices, o.triangles});
    return input;
}

TEST(BorderJoining, DividesEdgesAtVerticesBesideThem) {
    const std::vector<Outline> outlines{Outline(0), Outline(1, 1.0 / 3), Outline(2, 0.7)};
    const StackInput input = stack_of(outlines);
    const JoinedBorders joined = join_borders({&input, 1}, {}, find_chains({&input, 1}, {}));
    ASSERT_EQ(joined.rocks.size(), 1u);
    for (const TriangleView& s : joined.rocks[0].surfaces)
        EXPECT_EQ(s.triangles.size(), 9u);  // all have both vertices now
    const CellComplex columns = build_stack(input, {1, nullptr});
    const double area = Outline::kX * 2e6 / 2;
    EXPECT_NEAR(columns.volumes[1], area, 1e-6 * area);
    EXPECT_NEAR(columns.volumes[2], area, 1e-6 * area);
    EXPECT_EQ(columns.cell_block.size(), 6u);
}

TEST(BorderJoining, PartsOfOneSurfaceDoNotOverlapByRounding) {
    for (const double share : {1.0 / 3, 0.7, 0.9}) {
        std::vector<Outline> both{Outline(0, share)};
        both[0].vertices.insert(both[0].vertices.end(), {Outline::kX, 0, 0});
        both[0].triangles = {0, 1, 2, 0, 4, 3, 3, 4, 1};  // the long edge, and its vertex beyond it
        StackInput input = stack_of(both);
        input.base_elevation = -1;
        const CellComplex columns = build_stack(input, {1, nullptr});
        const double area = Outline::kX * (2e6 + Outline::kY) / 2;
        EXPECT_NEAR(columns.volumes[0], area, 1e-6 * area);
        EXPECT_EQ(columns.cell_block.size(), columns.warnings.empty() ? 3u : 4u);
    }
}

TEST(BorderJoining, DividesAnEdgeInBothOfItsTrianglesOrInNone) {
    Outline needle(0, 0.45), plain(1);
    needle.triangles = {0, 1, 2,
                        0, 3, 1};  // the vertex is beyond the edge, in a triangle of its own
    const std::vector<Outline> outlines{needle, plain};
    const StackInput input = stack_of(outlines);
    const JoinedBorders joined = join_borders({&input, 1}, {}, find_chains({&input, 1}, {}));
    const auto& surfaces = joined.rocks.at(0).surfaces;
    EXPECT_TRUE(std::ranges::equal(surfaces[0].triangles, needle.triangles));
    EXPECT_EQ(surfaces[1].triangles.size(), 6u);
}

TEST(BorderJoining, LeavesVerticesOnTheLineAndFarFromItAlone) {
    Outline plain(0), on_line(1), away(2);
    for (Outline* o : {&plain, &on_line, &away})
        o->vertices[3] = 4, o->vertices[4] = 2, o->vertices[7] = 8;
    on_line.vertices.insert(on_line.vertices.end(), {2, 1, 1});
    on_line.triangles = {0, 3, 2, 3, 1, 2};
    away.vertices.insert(away.vertices.end(), {2, 1.0 + 1e-9, 1});
    away.triangles = {0, 3, 2, 3, 1, 2};
    const std::vector<Outline> outlines{plain, on_line, away};
    const StackInput input = stack_of(outlines);
    EXPECT_TRUE(find_chains({&input, 1}, {}).empty());
}

}  // namespace
}  // namespace realmodel::strata
