// SPDX-License-Identifier: GPL-3.0-or-later
#include "realmodel/shells/shells.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "../strata/complex_checks.hpp"
#include "realmodel/base/errors.hpp"

namespace realmodel::shells {
namespace {

strata::CellComplex landscape(double x0) {
    const auto wave = [x0](double x, double y) { return 3 + std::sin(x - x0) + std::cos(y); };
    const auto level = [](double, double) { return 2.5; };
    return strata::build({strata::grid(6, 5, x0, 0, x0 + 8, 8, wave),
                          strata::grid(4, 4, x0, 0, x0 + 8, 8, level, true)},
                         0.0);
}

/// The volume inside, about the first vertex; that each edge is used both ways is looked at too.
double volume_of(const Shell& shell) {
    std::multiset<std::pair<std::int32_t, std::int32_t>> ahead, back;
    const auto at = [&](std::size_t corner) {
        return shell.coordinates[static_cast<std::size_t>(shell.corners[corner])];
    };
    double sum = 0;
    for (std::size_t f = 0; f + 1 < shell.offsets.size(); ++f) {
        const auto begin = static_cast<std::size_t>(shell.offsets[f]);
        const auto end = static_cast<std::size_t>(shell.offsets[f + 1]);
        for (std::size_t c = begin; c < end; ++c) {
            const std::int32_t a = shell.corners[c], b = shell.corners[c + 1 < end ? c + 1 : begin];
            ahead.emplace(a, b);
            back.emplace(b, a);
            const auto edge = static_cast<std::size_t>(shell.edges.of_corner[c]);
            EXPECT_EQ(shell.edges.edges[edge],
                      (std::array<std::int32_t, 2>{std::min(a, b), std::max(a, b)}));
        }
        for (std::size_t c = begin + 1; c + 1 < end; ++c) {
            const auto o = shell.coordinates[0], p = at(begin), q = at(c), r = at(c + 1);
            const double u[3]{p[0] - o[0], p[1] - o[1], p[2] - o[2]};
            const double v[3]{q[0] - o[0], q[1] - o[1], q[2] - o[2]};
            const double w[3]{r[0] - o[0], r[1] - o[1], r[2] - o[2]};
            sum += u[0] * (v[1] * w[2] - v[2] * w[1]) + u[1] * (v[2] * w[0] - v[0] * w[2]) +
                   u[2] * (v[0] * w[1] - v[1] * w[0]);
        }
    }
    EXPECT_EQ(ahead, back);
    const std::set<std::array<std::int32_t, 2>> distinct(shell.edges.edges.begin(),
                                                         shell.edges.edges.end());
    EXPECT_EQ(distinct.size(), shell.edges.edges.size());
    EXPECT_EQ(2 * distinct.size(), shell.corners.size());
    return sum / 6;
}

TEST(Shells, BlocksHaveTheirVolumesFarFromTheOriginToo) {
    for (const double x0 : {0.0, 4.5e6}) {
        const auto c = landscape(x0);
        const auto shells = block_shells(c, {x0, 0, 0}, {1});
        ASSERT_EQ(shells.size(), c.volumes.size());
        for (std::size_t b = 0; b < shells.size(); ++b)
            EXPECT_NEAR(volume_of(shells[b]), c.volumes[b], 1e-5 * c.volumes[b]);
    }
}

TEST(Shells, CellsStandByThemselvesAndShrink) {
    const auto c = landscape(0);
    for (const double shrink : {1.0, 0.5}) {
        const auto shells = cell_shells(c, shrink, {0, 0, 0}, {1});
        for (std::size_t b = 0; b < shells.size(); ++b) {
            EXPECT_NEAR(volume_of(shells[b]), std::pow(shrink, 3) * c.volumes[b],
                        1e-5 * c.volumes[b]);
            // what hangs together by edges is one cell
            const auto count = std::ranges::count(c.cell_block, static_cast<std::int32_t>(b));
            std::vector<std::size_t> group(shells[b].coordinates.size());
            for (std::size_t v = 0; v < group.size(); ++v)
                group[v] = v;
            for (bool changed = true; changed;) {
                changed = false;
                for (const auto& [p, q] : shells[b].edges.edges) {
                    auto &x = group[static_cast<std::size_t>(p)],
                         &y = group[static_cast<std::size_t>(q)];
                    changed = changed || x != y;
                    x = y = std::min(x, y);
                }
            }
            EXPECT_EQ(std::set(group.begin(), group.end()).size(), static_cast<std::size_t>(count));
        }
    }
}

TEST(Shells, AreTheSameForAnyNumberOfThreads) {
    const auto c = landscape(0);
    const auto one = cell_shells(c, 0.9, {1, 2, 3}, {1});
    const auto three = cell_shells(c, 0.9, {1, 2, 3}, {3});
    for (std::size_t b = 0; b < one.size(); ++b) {
        EXPECT_EQ(one[b].coordinates, three[b].coordinates);
        EXPECT_EQ(one[b].corners, three[b].corners);
        EXPECT_EQ(one[b].edges.edges, three[b].edges.edges);
    }
}

TEST(Shells, ABlockWithoutCellsIsEmpty) {
    const auto c = landscape(0);
    ComplexView view = c;
    ++view.blocks;
    const auto shells = block_shells(view, {0, 0, 0}, {2});
    EXPECT_TRUE(shells.back().faces.empty());
    EXPECT_EQ(shells.back().offsets, std::vector<std::int32_t>{0});
}

TEST(Shells, EdgesOfManyTrianglesAroundOneVertex) {
    // a fan so large that the uses are sorted; every spoke is used twice
    const std::int32_t count = 100;
    std::vector<std::int32_t> offsets{0}, corners;
    for (std::int32_t i = 0; i < count; ++i) {
        corners.insert(corners.end(), {0, 1 + i, 1 + (i + 1) % count});
        offsets.push_back(static_cast<std::int32_t>(corners.size()));
    }
    const auto found = polygon_edges(offsets, corners, 1 + count);
    EXPECT_EQ(found.edges.size(), 2u * count);
    for (std::size_t c = 0; c < corners.size(); ++c) {
        const std::int32_t next = corners[c % 3 == 2 ? c - 2 : c + 1];
        const auto edge = found.edges[static_cast<std::size_t>(found.of_corner[c])];
        EXPECT_EQ(edge[0], std::min(corners[c], next));
        EXPECT_EQ(edge[1], std::max(corners[c], next));
    }
}

TEST(Shells, RefuseNumbersOutOfRange) {
    const auto refuses = [](const auto& spoil) {
        auto c = landscape(0);
        spoil(c);
        EXPECT_THROW(block_shells(c, {0, 0, 0}, {1}), InputError);
    };
    refuses([](auto& c) { c.face_vertices[3] = -1; });
    refuses([](auto& c) { c.face_cells[3][1] = 1 << 20; });
    refuses([](auto& c) { c.face_offsets[3] = 1 << 20; });
    refuses([](auto& c) { c.face_offsets.pop_back(); });
    refuses([](auto& c) { c.cell_block[0] = 9; });
    const std::vector<std::int32_t> offsets{0, 3}, corners{0, 1, 5};
    EXPECT_THROW(polygon_edges(offsets, corners, 5), InputError);
    EXPECT_NO_THROW(polygon_edges(offsets, corners, 6));
}

}  // namespace
}  // namespace realmodel::shells
