// SPDX-License-Identifier: GPL-3.0-or-later
#include <cmath>
#include <map>
#include <random>
#include <set>

#include "../../sanitized.hpp"
#include "../complex_checks.hpp"
#include "strata/tiling/plan_grid.hpp"

namespace realmodel::strata {
namespace {

using Extent = std::array<double, 6>;  // the least corner, then the other one

/// What other columns cross may move a vertex by the last bit.
Extent rounded(Extent extent) {
    for (double& x : extent)
        x = std::round(x * 1e9) / 1e9;
    return extent;
}

/// Where the cells of each block are.
std::multiset<std::pair<std::int32_t, Extent>> cells_in(const CellComplex& c) {
    constexpr double kFar = HUGE_VAL;
    std::vector<Extent> extents(c.cell_block.size(), {kFar, kFar, kFar, -kFar, -kFar, -kFar});
    for (std::size_t f = 0; f < c.face_cells.size(); ++f) {
        for (const std::int32_t cell : c.face_cells[f]) {
            if (cell < 0) continue;
            Extent& own = extents[static_cast<std::size_t>(cell)];
            for (auto i = c.face_offsets[f]; i < c.face_offsets[f + 1]; ++i) {
                const auto& p = c.vertices[static_cast<std::size_t>(
                    c.face_vertices[static_cast<std::size_t>(i)])];
                for (std::size_t k = 0; k < 3; ++k) {
                    own[k] = std::min(own[k], p[k]);
                    own[k + 3] = std::max(own[k + 3], p[k]);
                }
            }
        }
    }
    std::multiset<std::pair<std::int32_t, Extent>> found;
    for (std::size_t cell = 0; cell < extents.size(); ++cell)
        found.insert({c.cell_block[cell], rounded(extents[cell])});
    return found;
}

spatial::Box box(const Extent& e) {
    spatial::Box box;
    box.include(spatial::Box::Position{e[0], e[1], e[2]});
    box.include(spatial::Box::Position{e[3], e[4], e[5]});
    return box;
}

TEST(WantedBoxes, SeesWhatABoxMeets) {
    std::vector<std::uint8_t> cells(2 * 2 * 64, 0);
    cells[(1 * 2 + 0) * 64 + 63] = 1;  // the topmost layer where x is high and y is low
    const WantedBoxes wanted({{0, 0, 0}, {1, 1, 1}, {2, 2, 64}, cells});
    EXPECT_TRUE(wanted.any_in(box({1.2, 0.2, 63.5, 1.4, 0.4, 63.6})));
    EXPECT_TRUE(wanted.any_in(box({0, 0, 0, 2, 2, 64})));
    EXPECT_FALSE(wanted.any_in(box({1.2, 0.2, 0, 1.4, 0.4, 62.9})));
    EXPECT_FALSE(wanted.any_in(box({1.2, 1.2, 63.5, 1.4, 1.4, 63.6})));
    EXPECT_FALSE(wanted.any_in(box({0.2, 0.2, 63.5, 0.4, 0.4, 63.6})));
    // on the line between two cells is in both
    EXPECT_TRUE(wanted.any_in(box({0.5, 0.5, 63.5, 1.0, 0.6, 63.6})));
    EXPECT_TRUE(wanted.any_in(box({1.5, 1.0, 62.0, 1.6, 1.0, 63.0})));
    // beside the grid as in its nearest cells; above and below it all is
    EXPECT_TRUE(wanted.any_in(box({7, -5, 63.5, 8, -4, 63.6})));
    EXPECT_FALSE(wanted.any_in(box({-7, -5, 63.5, -6, -4, 63.6})));
    EXPECT_TRUE(wanted.any_in(box({0.2, 1.2, 64.5, 0.4, 1.4, 65})));
    EXPECT_TRUE(wanted.any_in(box({0.2, 1.2, -1, 0.4, 1.4, 0.5})));
}

TEST(WantedBoxes, LeavesOutColumnsWhereNothingIsWanted) {
    for (std::uint64_t seed = 0; seed < (kSanitized ? 4 : 12); ++seed) {
        std::mt19937_64 random(seed);
        std::uniform_real_distribution<double> any(-1, 1);
        std::vector<OwnedSurface> surfaces;
        for (int k = 0; k < 5; ++k) {
            const double a = any(random), b = any(random);
            surfaces.push_back(grid(
                6 + k, 7, -1, -1, 1, 1,
                [&](double x, double y) { return 0.4 * k + 0.5 * (a * x + b * y * y); },
                k % 2 == 1));
        }
        std::vector<std::uint8_t> cells(5 * 4 * 3);
        for (auto& cell : cells)
            cell = any(random) > 0.6 ? 1 : 0;
        const WantedSpace space{{-1, -1, -3}, {0.4, 0.5, 2}, {5, 4, 3}, cells};
        StackInput input;
        for (const OwnedSurface& s : surfaces)
            input.surfaces.push_back(s.view());
        if (seed % 2 == 0) input.base_elevation = -2.5;
        const auto all = build_rock_masses({&input, 1}, {1, nullptr});
        const auto few = build_rock_masses({&input, 1}, {2, nullptr}, CellKind::kColumns, &space);
        expect_valid(few);
        auto kept = cells_in(few);
        EXPECT_LT(kept.size(), cells_in(all).size());
        const WantedBoxes wanted(space);
        for (const auto& cell : cells_in(all)) {
            const auto at = kept.find(cell);
            if (wanted.any_in(box(cell.second))) {
                EXPECT_NE(at, kept.end());
            }
            if (at != kept.end()) kept.erase(at);
        }
        EXPECT_TRUE(kept.empty());
    }
}

}  // namespace
}  // namespace realmodel::strata
