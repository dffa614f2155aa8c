// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <string>

#include "../sanitized.hpp"
#include "complex_checks.hpp"

namespace realmodel::strata {
namespace {

class TileOf : public testing::TestWithParam<CellKind> {};

OwnedSurface slope(int n, double z, double x, double y, bool other) {
    return grid(
        n, n, -1, -1, 7, 7, [=](double u, double v) { return z + x * u + y * v; }, other);
}

/// A triangle as region, on a base at -10.
struct Input {
    std::vector<OwnedSurface> surfaces{slope(3, 0, 0.1, 0.02, false), slope(5, 1, -0.2, 0.1, true),
                                       slope(4, 2, 0.3, -0.3, false)};
    std::vector<double> corners{0, 0, 6, 1, 1, 5};
    std::vector<std::int32_t> triangle{0, 1, 2};

    StackInput view(bool has_region) const {
        StackInput input;
        for (const OwnedSurface& s : surfaces)
            input.surfaces.push_back(s.view());
        if (has_region) input.region = {corners, triangle};
        input.base_elevation = -10;
        return input;
    }
};

TEST_P(TileOf, FourTilesHaveTheVolumesOfTheWhole) {
    const Input owned;
    for (const bool has_region : {true, false}) {
        const StackInput input = owned.view(has_region);
        const CellComplex whole = build_stack(input, {1, nullptr}, GetParam());
        std::vector<double> sum(whole.volumes.size());
        for (const auto& [x0, x1] : {std::pair{-2.0, 2.3}, std::pair{2.3, 8.0}}) {
            for (const auto& [y0, y1] : {std::pair{-2.0, 1.7}, std::pair{1.7, 8.0}}) {
                const CellComplex tile =
                    build_tile({&input, 1}, {x0, y0, x1, y1}, {2, nullptr}, GetParam()).complex;
                expect_valid(tile, GetParam() == CellKind::kBlocks);
                for (const auto& v : tile.vertices) {
                    EXPECT_TRUE(v[0] >= x0 && v[0] <= x1 && v[1] >= y0 && v[1] <= y1);
                }
                for (std::size_t b = 0; b < sum.size(); ++b)
                    sum[b] += tile.volumes[b];
            }
        }
        for (std::size_t b = 0; b < sum.size(); ++b)
            EXPECT_NEAR(sum[b], whole.volumes[b], 1e-12 * std::abs(whole.volumes[b]));
    }
}

/// Triangles that a border divides are whole facets in each tile: what surfaces above divide them
/// into does not add up from surface to surface.
TEST(ColumnsOfTiles, DoNotCompoundAlongTheirBorder) {
    constexpr int kSide = kSanitized ? 12 : 24, kSurfaces = 9;
    std::vector<OwnedSurface> surfaces;
    StackInput input;
    for (int k = 0; k < kSurfaces; ++k)
        surfaces.push_back(slope(kSide - k, k, 0.01 * k, -0.02 * k, k % 2 == 0));
    for (const OwnedSurface& s : surfaces)
        input.surfaces.push_back(s.view());
    input.base_elevation = -10;
    const std::size_t whole = build_stack(input, {1, nullptr}).cell_block.size();
    std::size_t in_tiles = 0;
    for (const Window& window : {Window{-2, -2, 2.3, 8}, Window{2.3, -2, 8, 8}}) {
        const CellComplex tile = build_tile({&input, 1}, window, {1, nullptr}).complex;
        expect_valid(tile, false);
        in_tiles += tile.cell_block.size();
    }
    EXPECT_GT(in_tiles, whole);
    EXPECT_LE(in_tiles, whole + 3 * kSide * kSurfaces);  // a line passes two or three in a row
}

TEST_P(TileOf, AWindowBesideTheRegionIsEmpty) {
    const Input owned;
    const StackInput input = owned.view(true);
    const CellComplex tile =
        build_tile({&input, 1}, {5, 5, 7, 7}, {1, nullptr}, GetParam()).complex;
    EXPECT_TRUE(tile.cell_block.empty());
    EXPECT_EQ(tile.volumes, std::vector<double>(3, 0.0));
}

/// The exact places of a tile's border vertices on the line x = 2.3, and where they are.
std::map<std::array<std::string, 3>, std::array<double, 3>> on_line(const Tile& tile) {
    std::map<std::array<std::string, 3>, std::array<double, 3>> found;
    for (const BorderVertex& vertex : tile.border) {
        const auto& at = tile.complex.vertices[static_cast<std::size_t>(vertex.vertex)];
        EXPECT_EQ(at, vertex.nearest);  // nothing is so close here that it would move
        if (at[0] != 2.3) continue;
        EXPECT_EQ(vertex.exact[0], "9333333333333/4000000000000");
        EXPECT_TRUE(found.emplace(vertex.exact, at).second);
    }
    return found;
}

TEST_P(TileOf, NeighborsHaveTheSameExactPlacesOnTheirLine) {
    const Input owned;
    for (const bool has_region : {true, false}) {
        const StackInput input = owned.view(has_region);
        const Tile west = build_tile({&input, 1}, {-2, -2, 2.3, 8}, {1, nullptr}, GetParam()),
                   east = build_tile({&input, 1}, {2.3, -2, 8, 8}, {1, nullptr}, GetParam());
        const auto one = on_line(west), other = on_line(east);
        std::size_t both = 0;
        for (const auto& [exact, at] : one) {
            const auto same = other.find(exact);
            if (same == other.end()) continue;
            EXPECT_EQ(same->second, at);
            ++both;
        }
        EXPECT_GT(both, 10U);
        // no other vertex has a coordinate of a line
        for (const Tile* tile : {&west, &east}) {
            const auto& vertices = tile->complex.vertices;
            const auto count =
                std::ranges::count_if(vertices, [](const auto& v) { return v[0] == 2.3; });
            EXPECT_EQ(static_cast<std::size_t>(count), tile == &west ? one.size() : other.size());
        }
    }
}

INSTANTIATE_TEST_SUITE_P(Cells, TileOf, testing::Values(CellKind::kColumns, CellKind::kBlocks));

}  // namespace
}  // namespace realmodel::strata
