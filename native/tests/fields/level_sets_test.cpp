// SPDX-License-Identifier: GPL-3.0-or-later
#include "realmodel/fields/level_sets.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <numbers>
#include <numeric>
#include <random>

#include "base/vectors.hpp"
#include "realmodel/base/errors.hpp"

namespace realmodel::fields {
namespace {

using Point = Vec3;

/// A lattice with the values of a function at its nodes, and points with values of their own.
struct Sampled {
    std::vector<double> values, points, point_values;
    LatticeField field{};

    Sampled(const std::array<std::int32_t, 3>& counts, const Point& spacing,
            const std::function<double(const Point&)>& f) {
        field.lattice = {{-1, 2, 0.5}, spacing, counts};
        for (std::int32_t k = 0; k < counts[2]; ++k) {
            for (std::int32_t j = 0; j < counts[1]; ++j) {
                for (std::int32_t i = 0; i < counts[0]; ++i)
                    values.push_back(f(node({i, j, k})));
            }
        }
    }
    Point node(const std::array<std::int32_t, 3>& at) const {
        return field.lattice.position(at[0], at[1], at[2]);
    }
    void add(const Point& p, double value) {
        points.insert(points.end(), p.begin(), p.end());
        point_values.push_back(value);
    }
    const LatticeField& view() {
        field.values = values;
        field.points = points;
        field.point_values = point_values;
        return field;
    }
    std::vector<LevelSet> at(const std::vector<double>& levels, int threads = 1) {
        return level_sets(view(), levels, {threads, nullptr});
    }
};

double volume(const LevelSet& set) {
    double sum = 0;
    const auto at = [&](std::int32_t v) { return set.vertices[static_cast<std::size_t>(v)]; };
    for (const auto& t : set.triangles)
        sum += sixfold_volume({0, 0, 0}, at(t[0]), at(t[1]), at(t[2]));
    return sum / 6;
}

/// Each edge as often in one direction as in the other.
void expect_closed(const LevelSet& set) {
    std::map<std::pair<std::int32_t, std::int32_t>, int> sums;
    for (const auto& t : set.triangles) {
        for (std::size_t i = 0; i < 3; ++i) {
            const auto a = t[i], b = t[(i + 1) % 3];
            ASSERT_NE(a, b);
            sums[std::minmax(a, b)] += a < b ? 1 : -1;
        }
    }
    EXPECT_TRUE(std::ranges::all_of(sums, [](const auto& sum) { return sum.second == 0; }));
}

double radius(const Point& p) {
    return std::hypot(p[0] - 1.1, p[1] - 4.2, p[2] - 2.3);
}

TEST(LevelSetsTest, BallsHaveTheVolumesThatTheyMust) {
    Sampled ball({41, 41, 41}, {0.1, 0.1, 0.1}, radius);
    for (const auto& [level, set] : {std::pair(1.0, 0), {1.5, 1}}) {
        const auto sets = ball.at({1.0, 1.5});
        const LevelSet& own = sets[static_cast<std::size_t>(set)];
        expect_closed(own);
        const double exact = 4.0 / 3 * std::numbers::pi * std::pow(level, 3);
        EXPECT_NEAR(volume(own), exact, 0.01 * exact);
    }
}

TEST(LevelSetsTest, APlaneIsClosedBeyondTheSidesOfTheLattice) {
    Sampled slope({5, 6, 7}, {1, 0.5, 0.7}, [](const Point& p) { return p[2] + 0.1 * p[0]; });
    const LevelSet set = slope.at({2.0})[0];
    expect_closed(set);
    // what is below in the lattice, and pyramids a step high over it on five sides
    const double ends = 2.5 * (1.6 + 1.2), beside = 2 * 4 * 1.4, base = 4 * 2.5;
    EXPECT_NEAR(volume(set), 4 * 2.5 * 1.4 + (ends + 0.5 * beside + 0.7 * base) / 3, 1e-12);
    EXPECT_LT(set.triangles.size() - set.on_level, 60U);  // where the level set ends, or the box
    for (std::size_t t = 0; t < set.triangles.size(); ++t) {
        double beyond = 0;  // how far all corners are beyond a side, or in it
        for (std::size_t axis = 0; axis < 3; ++axis) {
            double low = HUGE_VAL, high = -HUGE_VAL;
            for (const std::int32_t v : set.triangles[t]) {
                const Point& p = set.vertices[static_cast<std::size_t>(v)];
                low = std::min(low, p[axis]);
                high = std::max(high, p[axis]);
                if (t < set.on_level) {
                    EXPECT_NEAR(p[2] + 0.1 * p[0], 2.0, 1e-12);
                }
            }
            const Point last = slope.node({4, 5, 6});
            const bool is_out = high <= slope.node({0, 0, 0})[axis] || low >= last[axis];
            beyond = std::max(beyond, is_out ? high - low : 0.0);
        }
        EXPECT_EQ(beyond > 0, t >= set.on_level);
    }
}

TEST(LevelSetsTest, AFieldThatIsNowhereAboveALevelIsTheLatticeAndAPyramidOverEachSide) {
    Sampled all({3, 4, 5}, {1, 1, 1}, [](const Point& p) { return p[0]; });
    all.add({-1, 2.5, 0.5}, 0.25);  // within an edge of the box
    const LevelSet set = all.at({9.0})[0];
    expect_closed(set);
    EXPECT_EQ(set.on_level, 0U);
    EXPECT_EQ(set.triangles.size(), 24U);
    EXPECT_NEAR(volume(set), 24 + 2 * (6 + 8 + 12) / 3.0, 1e-12);
}

/// Values of few kinds, so that levels pass through nodes, edges and whole faces of the sides.
TEST(LevelSetsTest, AnyValuesAreClosed) {
    std::mt19937 random(11);
    for (int n = 0; n < 300; ++n) {
        Sampled any({3, 3, 4}, {1, 0.5, 0.75}, [&](const Point&) { return random() % 3; });
        if (n % 2 == 0) any.add({-1, 2.25, 0.5}, random() % 3);
        if (n % 3 == 0) any.add({-1, 2.3, 1.1}, random() % 3);
        for (const LevelSet& set : any.at({0.0, 0.5, 1.0}))
            expect_closed(set);
    }
}

TEST(LevelSetsTest, ALevelThroughNodesHasNoTriangleTwiceAndNoneWithoutCorners) {
    // all nodes of a layer lie on the level, and so do whole tetrahedra of the next one
    Sampled flat({4, 4, 5}, {1, 1, 1}, [](const Point& p) { return std::max(p[2], 2.5); });
    flat.values[0] = 2.5;
    const auto sets = flat.at({2.5});
    expect_closed(sets[0]);
    auto sorted = sets[0].triangles;
    for (auto& t : sorted)
        std::ranges::sort(t);
    std::ranges::sort(sorted);
    EXPECT_TRUE(std::ranges::adjacent_find(sorted) == sorted.end());
}

TEST(LevelSetsTest, ALevelOfLargeValuesIsClosedAroundTheLattice) {
    Sampled large({3, 3, 3}, {1, 1, 1}, [](const Point&) { return 1e17; });  // 1e17 + 1 is 1e17
    const auto sets = large.at({1e17});
    expect_closed(sets[0]);
    EXPECT_GE(volume(sets[0]), 8.0);
}

TEST(LevelSetsTest, ATouchingPairOfTrianglesCancels) {
    // three nodes of one face are on the level, all others above: there is nothing inside
    Sampled touched({3, 3, 3}, {1, 1, 1}, [](const Point&) { return 1.0; });
    touched.values[9] = touched.values[10] = touched.values[13] = 0.0;
    EXPECT_TRUE(touched.at({0.0})[0].triangles.empty());
}

/// Points within cells, on faces, on edges and in nodes become vertices.
TEST(LevelSetsTest, PointsAreVerticesWhereverTheyLie) {
    // z of a point decides which level it is on
    const auto f = [](const Point& p) { return 2 * p[0] - 0.5 * p[1] + 0.75 * p[2]; };
    Sampled field({12, 12, 12}, {0.37, 0.37, 0.37}, f);
    std::mt19937_64 generator(5);
    std::uniform_real_distribution<double> random(0.2, 3.8);
    for (std::size_t i = 0; i < 600; ++i) {
        Point p{-1 + random(generator), 2 + random(generator), 0.5};
        const auto node = field.node({static_cast<std::int32_t>(i % 10), 3, 4});
        if (i % 5 == 1) p[0] = node[0];             // in a face of cells
        if (i % 5 == 2) p = {node[0], node[1], 0};  // on an edge
        const double level = i % 2 == 0 ? 1.2 : 1.6;
        p[2] = (level - 2 * p[0] + 0.5 * p[1]) / 0.75;
        if (p[2] < 0.6 || p[2] > 4.5) continue;
        bool is_new = true;
        for (std::size_t j = 0; j + 2 < field.points.size(); j += 3)
            is_new &= Point{field.points[j], field.points[j + 1], field.points[j + 2]} != p;
        if (is_new) field.add(p, level);
    }
    const Point node = field.node({3, 3, 4});
    field.add(node, f(node));
    field.values[3 + 12 * (3 + 12 * 4)] = 9;  // what the point in it says counts
    ASSERT_GT(field.point_values.size(), 50U);
    const std::vector<double> levels{1.2, 1.6};
    const auto sets = field.at(levels);
    for (std::size_t level = 0; level < 2; ++level) {
        expect_closed(sets[level]);
        for (std::size_t i = 0; i < field.point_values.size(); ++i) {
            if (field.point_values[i] != levels[level]) continue;
            const Point p{field.points[3 * i], field.points[3 * i + 1], field.points[3 * i + 2]};
            EXPECT_NE(std::ranges::find(sets[level].vertices, p), sets[level].vertices.end());
        }
    }
    const auto values = field_at(field.view(), field.points, {1, nullptr});
    for (std::size_t i = 0; i < values.size(); ++i)
        EXPECT_NEAR(values[i], field.point_values[i], 1e-12);
    const double inside = volume(sets[0]), outside = volume(sets[1]);
    EXPECT_LT(inside, outside);
}

TEST(LevelSetsTest, TheFieldIsLinearOnTetrahedra) {
    const auto f = [](const Point& p) { return 2 * p[0] - 0.5 * p[1] + 0.25 * p[2]; };
    Sampled field({4, 5, 6}, {0.7, 0.3, 0.9}, f);
    const Lattice& lattice = field.field.lattice;
    std::mt19937_64 generator(6);
    std::vector<double> positions;
    for (std::size_t i = 0; i < 100; ++i) {
        for (std::size_t axis = 0; axis < 3; ++axis) {
            std::uniform_real_distribution<double> random(
                lattice.origin[axis],
                lattice.origin[axis] + lattice.spacing[axis] * (lattice.counts[axis] - 1));
            positions.push_back(random(generator));
        }
        if (i % 3 == 0) {
            const std::size_t own = positions.size() - 3;
            const Point p{positions[own], positions[own + 1], positions[own + 2]};
            field.add(p, f(p));
        }
    }
    const auto found = field_at(field.view(), positions, {2, nullptr});
    for (std::size_t i = 0; i < found.size(); ++i)
        EXPECT_NEAR(found[i], f({positions[3 * i], positions[3 * i + 1], positions[3 * i + 2]}),
                    1e-12);
    EXPECT_TRUE(std::isnan(field_at(field.view(), std::vector<double>{9, 9, 9}, {})[0]));
}

TEST(LevelSetsTest, NodesBesideALevelAreMovedOntoIt) {
    Sampled field({3, 3, 3}, {1, 1, 1}, [](const Point& p) { return p[2]; });
    field.values[13] += 1e-9;
    const auto moved = moved_onto_levels(field.view(), std::vector<double>{1.5});
    EXPECT_EQ(moved[13], 1.5);
    EXPECT_EQ(moved[4], field.values[4]);
    expect_closed(field.at({1.5})[0]);
}

TEST(LevelSetsTest, TheSameForAnyNumberOfThreads) {
    Sampled ball({21, 22, 23}, {0.2, 0.2, 0.2}, radius);
    const auto one = ball.at({0.9, 1.3}, 1), three = ball.at({0.9, 1.3}, 3);
    for (std::size_t level = 0; level < 2; ++level) {
        EXPECT_EQ(one[level].triangles, three[level].triangles);
        EXPECT_TRUE(std::ranges::equal(one[level].vertices, three[level].vertices));
    }
}

void expect_refused(Sampled& field, const std::vector<double>& levels, const std::string& kind) {
    try {
        field.at(levels);
        ADD_FAILURE() << "not refused: " << kind;
    } catch (const InputError& error) {
        EXPECT_EQ(error.kind, kind);
    }
}

TEST(LevelSetsTest, WhatMakesNoFieldIsRefused) {
    const auto f = [](const Point& p) { return p[2]; };
    Sampled outside({3, 3, 3}, {1, 1, 1}, f);
    outside.add({9, 3, 1}, 1);
    expect_refused(outside, {1}, "outside");
    Sampled twice({3, 3, 3}, {1, 1, 1}, f);
    twice.add({0.3, 3.3, 1.1}, 1);
    twice.add({0.3, 3.3, 1.1}, 1);
    EXPECT_EQ(twice.at({1}).size(), 1U);
    twice.add({0.3, 3.3, 1.1}, 2);
    expect_refused(twice, {1, 2}, "two_values");
    Sampled at_node({3, 3, 3}, {1, 1, 1}, f);
    at_node.add({0, 3, 1.5}, 1);
    at_node.add({0, 3, 1.5}, 2);
    expect_refused(at_node, {1, 2}, "two_values");
    Sampled unknown({3, 3, 3}, {1, 1, 1}, f);
    unknown.values[3] = NAN;
    expect_refused(unknown, {1}, "not_finite");
    Sampled flat({1, 3, 3}, {1, 1, 1}, f);
    expect_refused(flat, {1}, "bad_lattice");
    Sampled down({3, 3, 3}, {1, 1, 1}, f);
    expect_refused(down, {2, 1}, "bad_lattice");
    Sampled coarse({3, 3, 3}, {1, 1, 1}, f);  // all nodes have the same x
    coarse.field.lattice.origin[0] = 1e18;
    coarse.add({1e18, 3, 1}, 1);
    expect_refused(coarse, {1}, "bad_lattice");
}

double slope(const Point& p) {
    return p[2] + 0.3 * p[0] - 0.2 * p[1];
}

/// A lattice whose coordinates have few binary digits: the middles of its edges lie exactly on
/// them.
Sampled short_lattice(const std::function<double(const Point&)>& f) {
    return {{5, 6, 7}, {1, 0.5, 0.75}, f};
}

TEST(TetrahedraAtTest, WeightsGiveThePositionsAndTheValuesBack) {
    Sampled field = short_lattice(slope);
    field.add({0.5, 2.25, 0.875}, 7);  // the middle of a diagonal
    field.add({1.2, 3.1, 2.3}, -1);
    std::mt19937 random(3);
    std::vector<double> positions;
    for (int n = 0; n < 400; ++n) {
        positions.push_back(std::uniform_real_distribution(-1.0, 3.0)(random));
        positions.push_back(std::uniform_real_distribution(2.0, 4.5)(random));
        positions.push_back(std::uniform_real_distribution(0.5, 5.0)(random));
    }
    positions.insert(positions.end(), field.points.begin(), field.points.end());
    const LatticeField& view = field.view();
    const TetrahedraAt found = tetrahedra_at(view, positions, {2, nullptr});
    const std::vector<double> values = field_at(view, positions, {1, nullptr});
    const auto nodes = static_cast<std::int64_t>(field.values.size());
    for (std::size_t n = 0; n < found.corners.size(); ++n) {
        // asked for alone, only the points of its cell divide tetrahedra
        const TetrahedraAt alone =
            tetrahedra_at(view, std::span(positions).subspan(3 * n, 3), {1, nullptr});
        EXPECT_EQ(alone.corners[0], found.corners[n]);
        EXPECT_EQ(alone.weights[0], found.weights[n]);
        Point at{};
        double value = 0;
        for (std::size_t k = 0; k < 4; ++k) {
            const std::int64_t corner = found.corners[n][k];
            const auto own = static_cast<std::size_t>(corner < nodes ? corner : corner - nodes);
            const auto i = static_cast<std::int32_t>(own % 5);
            const auto j = static_cast<std::int32_t>(own / 5 % 6);
            const Point node = field.node({i, j, static_cast<std::int32_t>(own / 30)});
            const double weight = found.weights[n][k];
            for (std::size_t axis = 0; axis < 3; ++axis)
                at[axis] += weight * (corner < nodes ? node[axis] : field.points[3 * own + axis]);
            value += weight * (corner < nodes ? field.values[own] : field.point_values[own]);
        }
        for (std::size_t axis = 0; axis < 3; ++axis)
            EXPECT_NEAR(at[axis], positions[3 * n + axis], 1e-12);
        EXPECT_NEAR(value, values[n], 1e-12);
    }
    EXPECT_EQ(found.corners[401][0] >= nodes || found.weights[401][0] < 1, true);
    positions[1] = 99;
    EXPECT_THROW(tetrahedra_at(view, positions, {1, nullptr}), InputError);
}

TEST(PointsBetweenTest, APeakIsNoPlaceThatItsLevelPassesThrough) {
    Sampled field = short_lattice(slope);
    const Point inside{0.7, 3.1, 2.3}, node = field.node({2, 2, 2}), same{2.1, 3.3, 2.9};
    field.add(inside, slope(inside));
    field.add({1.6, 2.6, 1.7}, 40);  // above all around it
    field.add({0.3, 3.8, 3.7}, -40);
    field.add(node, slope(node));
    field.add(same, slope(same));
    field.add(same, slope(same));
    field.add({-1, 2.3, 1.1}, slope({-1, 2.3, 1.1}));  // on the border
    const std::vector<std::uint8_t> expected{1, 0, 0, 1, 1, 1, 1};
    EXPECT_EQ(points_between(field.view(), {1, nullptr}), expected);
    EXPECT_EQ(points_between(field.view(), {3, nullptr}), expected);
}

TEST(LevelSetsTest, AMiddleOfAnEdgeInASideDividesWhatIsAroundIt) {
    Sampled field = short_lattice(slope);
    const std::vector<double> before = field.values;
    field.add({-1, 2.25, 0.5}, 9);     // of an edge of the box
    field.add({-1, 3.25, 2.375}, -9);  // of a diagonal of its side
    for (const LevelSet& set : field.at({2.0, 4.0}))
        expect_closed(set);
}

}  // namespace
}  // namespace realmodel::fields
