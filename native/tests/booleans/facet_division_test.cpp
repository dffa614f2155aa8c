// SPDX-License-Identifier: GPL-3.0-or-later
#include "booleans/facet_division.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <set>

#include "booleans/nearness.hpp"

namespace realmodel::booleans {
namespace {

/// A triangle in space, and points that lie on it up to rounding.
class Sample {
public:
    Sample() {
        for (const Position& p : {o_, at(1, 0), at(0, 1)})
            corners_.push_back(points.add(p));
        facet.corners = {corners_[0], corners_[1], corners_[2]};
    }
    SpacePointId inside(double s, double t) { return points.add(at(s, t)); }
    /// Twice the area in plan, which all axes see.
    double area(const TriangleCorners& t) const {
        const auto &a = points.rounded(t[0]), &b = points.rounded(t[1]), &c = points.rounded(t[2]);
        return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
    }

    SpacePoints points;
    FacetPoints facet;

private:
    using Position = exact::SpacePosition;
    Position at(double s, double t) const {
        Position p;
        for (std::size_t k = 0; k < 3; ++k)
            p[k] = o_[k] + s * u_[k] + t * v_[k];
        return p;
    }
    Position o_{0.1, 0.2, 0.3}, u_{3, 0.3, 1}, v_{0.2, 2, -0.7};
    std::vector<SpacePointId> corners_;
};

std::set<SpaceEdge> edges_in(const std::vector<TriangleCorners>& triangles) {
    std::set<SpaceEdge> found;
    for (const TriangleCorners& t : triangles) {
        for (const SpaceEdge& edge : edges_of(t))
            found.insert(edge);
    }
    return found;
}

void expect_tiled(const Sample& sample, const std::vector<TriangleCorners>& triangles) {
    double sum = 0;
    for (const TriangleCorners& t : triangles) {
        EXPECT_GT(sample.area(t), 0);
        sum += sample.area(t);
    }
    EXPECT_NEAR(sum, sample.area(sample.facet.corners), 1e-9);
}

TEST(FacetDivision, ManyPointsAndAChainOfEdges) {
    Sample sample;
    std::mt19937 random(3);
    const auto uniform = [&] { return static_cast<double>(random()) / 4294967296.0; };
    constexpr std::size_t kInside = 3000, kChain = 200, kOnEdge = 50;
    SpacePointId last = kNone;
    for (std::size_t i = 0; i < kChain; ++i) {
        const double s = 0.05 + 0.4 * static_cast<double>(i) / kChain;
        const SpacePointId p = sample.inside(s, 0.2 + 0.1 * uniform());
        sample.facet.within.push_back(p);
        if (i > 0) sample.facet.wanted.push_back(unordered(last, p));
        last = p;
    }
    while (sample.facet.within.size() < kInside) {
        const double s = uniform(), t = uniform();
        if (s + t < 0.99 && s > 0.01 && t > 0.31)
            sample.facet.within.push_back(sample.inside(s, t));
    }
    for (std::size_t i = 1; i <= kOnEdge; ++i)
        sample.facet.on_edges[0].push_back(
            sample.inside(static_cast<double>(i) / (kOnEdge + 1), 0));
    const auto triangles = divided(sample.points, sample.facet, nullptr);
    EXPECT_EQ(triangles.size(), 1 + 2 * kInside + kOnEdge);
    expect_tiled(sample, triangles);
    const auto edges = edges_in(triangles);
    for (const SpaceEdge& edge : sample.facet.wanted)
        EXPECT_TRUE(edges.contains(edge));
}

TEST(FacetDivision, AnEdgeAcrossEverything) {
    Sample sample;
    std::mt19937 random(4);
    const auto uniform = [&] { return static_cast<double>(random()) / 4294967296.0; };
    const SpacePointId from = sample.inside(0.01, 0.3), to = sample.inside(0.6, 0.31);
    sample.facet.within = {from, to};
    for (std::size_t i = 0; i < 400; ++i) {
        const double s = 0.02 + 0.5 * uniform(), t = 0.1 + 0.35 * uniform();
        sample.facet.within.push_back(sample.inside(s, t));
    }
    sample.facet.wanted = {unordered(from, to)};
    const auto triangles = divided(sample.points, sample.facet, nullptr);
    expect_tiled(sample, triangles);
    EXPECT_TRUE(edges_in(triangles).contains(unordered(from, to)));
    // two that cross: the first one stays
    const SpacePointId low = sample.inside(0.3, 0.05), high = sample.inside(0.3, 0.6);
    sample.facet.within.insert(sample.facet.within.end(), {low, high});
    sample.facet.wanted.push_back(unordered(low, high));
    const auto again = divided(sample.points, sample.facet, nullptr);
    expect_tiled(sample, again);
    EXPECT_TRUE(edges_in(again).contains(unordered(from, to)));
    EXPECT_FALSE(edges_in(again).contains(unordered(low, high)));
}

/// The same points give the same triangles, whichever of its corners comes first.
TEST(FacetDivision, WhicheverCornerIsFirst) {
    Sample sample;
    std::mt19937 random(6);
    const auto uniform = [&] { return static_cast<double>(random()) / 4294967296.0; };
    for (std::size_t i = 0; i < 60; ++i)
        sample.facet.within.push_back(
            sample.inside(0.05 + 0.4 * uniform(), 0.05 + 0.4 * uniform()));
    sample.facet.on_edges[0] = {sample.inside(0.25, 0), sample.inside(0.5, 0)};
    const auto sorted = [](std::vector<TriangleCorners> triangles) {
        for (TriangleCorners& t : triangles)
            std::sort(t.begin(), t.end());
        std::sort(triangles.begin(), triangles.end());
        return triangles;
    };
    const auto first = sorted(divided(sample.points, sample.facet, nullptr));
    std::rotate(sample.facet.corners.begin(), sample.facet.corners.begin() + 1,
                sample.facet.corners.end());
    std::rotate(sample.facet.on_edges.begin(), sample.facet.on_edges.begin() + 1,
                sample.facet.on_edges.end());
    EXPECT_EQ(sorted(divided(sample.points, sample.facet, nullptr)), first);
}

TEST(FacetDivision, CanBeCancelled) {
    Sample sample;
    sample.facet.within = {sample.inside(0.2, 0.2)};
    Progress progress;
    progress.cancel();
    EXPECT_THROW(divided(sample.points, sample.facet, &progress), Cancelled);
}

}  // namespace
}  // namespace realmodel::booleans
