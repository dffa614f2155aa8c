// SPDX-License-Identifier: GPL-3.0-or-later
// Every valid outline is meshed, however close its edges come: down to one unit in the last place.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <random>
#include <set>
#include <span>

#include "../sanitized.hpp"
#include "plan_mesh_checks.hpp"
#include "realmodel/meshing/region_mesh.hpp"
#include "realmodel/meshing/rings.hpp"

namespace realmodel::meshing {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

double above(double x, int steps = 1) {
    for (int i = 0; i < steps; ++i)
        x = std::nextafter(x, kInfinity);
    return x;
}

double below(double x) {
    return std::nextafter(x, -kInfinity);
}

/// The border of a mesh as rings; where it touches itself in a vertex any way on will do.
std::vector<Ring> border_rings(const PlanarMesh& mesh) {
    auto border = border_of(mesh);
    std::vector<Ring> rings;
    for (auto& [first, ends] : border) {
        while (!ends.empty()) {
            Ring& ring = rings.emplace_back();
            std::int32_t at = first;
            do {
                ring.push_back(mesh.vertices[at]);
                std::vector<std::int32_t>& next = border[at];
                at = next.back();
                next.pop_back();
            } while (at != first);
        }
    }
    return rings;
}

/// Whether the border, followed in its direction, leads from a corner to another along the edge
/// between them: each vertex on the way a rounding away from it, and corners of rings only on it.
class Chains {
public:
    Chains(const PlanarMesh& mesh, const std::vector<Ring>& rings) {
        for (const auto& [from, ends] : border_of(mesh))
            for (const std::int32_t to : ends)
                next_[mesh.vertices[from]].push_back(mesh.vertices[to]);
        for (const Ring& ring : rings)
            for (const PlanPoint& p : ring) {
                corners_.insert(p);
                slack_ = std::max({slack_, std::abs(p[0]), std::abs(p[1])});
            }
        slack_ *= 16 * std::numeric_limits<double>::epsilon();
    }

    bool lead(const PlanPoint& a, const PlanPoint& b) const { return lead_on(a, b, a); }

private:
    bool lead_on(const PlanPoint& a, const PlanPoint& b, const PlanPoint& start) const {
        for (PlanPoint at : next_.at(start)) {
            while (at != b && !corners_.contains(at) && is_near(a, b, at))
                at = next_.at(at).front();
            if (at == b) return true;
            if (at != a && corners_.contains(at) && orient2d(a, b, at) == 0 && lead_on(a, b, at))
                return true;
        }
        return false;
    }
    bool is_near(const PlanPoint& a, const PlanPoint& b, const PlanPoint& p) const {
        const double length = std::hypot(b[0] - a[0], b[1] - a[1]);
        return std::abs((p[0] - a[0]) * (b[1] - a[1]) - (p[1] - a[1]) * (b[0] - a[0])) <=
               slack_ * length;
    }

    std::map<PlanPoint, std::vector<PlanPoint>> next_;
    std::set<PlanPoint> corners_;
    double slack_ = 0;
};

void expect_chains(const PlanarMesh& mesh, const std::vector<Ring>& rings) {
    const Chains chains(mesh, rings);
    for (const Ring& ring : rings) {
        for (std::size_t i = 0; i < ring.size(); ++i) {
            const PlanPoint &a = ring[i], &b = ring[(i + 1) % ring.size()];
            EXPECT_TRUE(a == b || chains.lead(a, b) || chains.lead(b, a))
                << a[0] << ", " << a[1] << " - " << b[0] << ", " << b[1];
        }
    }
}

void expect_meshed(const std::vector<Ring>& rings, MeshRequest request) {
    const double area = area_of(triangulate_rings(rings));
    for (const Mesher mesher : {Mesher::kDelaunay, Mesher::kFrontal, Mesher::kGrid}) {
        SCOPED_TRACE(static_cast<int>(mesher));
        request.mesher = mesher;
        const PlanarMesh mesh = mesh_region(rings, request);
        expect_valid(mesh);
        expect_chains(mesh, rings);
        EXPECT_NO_THROW(triangulate_region(border_rings(mesh)));
        double reach = 0, length = 0;
        for (const Ring& ring : rings) {
            for (std::size_t i = 0; i < ring.size(); ++i) {
                const PlanPoint &a = ring[i], &b = ring[(i + 1) % ring.size()];
                reach = std::max({reach, std::abs(a[0]), std::abs(a[1])});
                length += std::hypot(b[0] - a[0], b[1] - a[1]);
            }
        }
        EXPECT_NEAR(area_of(mesh), area,
                    1e-12 * area + 2 * length * reach * std::numeric_limits<double>::epsilon());
        const PlanarMesh again = mesh_region(rings, request);
        EXPECT_EQ(mesh.vertices, again.vertices);
        EXPECT_EQ(mesh.triangles, again.triangles);
    }
}

void expect_meshed(const std::vector<Ring>& rings, double edge_length) {
    MeshRequest request;
    request.edge_length = edge_length;
    expect_meshed(rings, request);
}

/// Coordinates near the origin, in degrees, and as large as those of UTM.
struct Frame {
    double x, y, unit;
    PlanPoint operator()(double u, double v) const { return {x + unit * u, y + unit * v}; }
};
const std::vector<Frame> frames{
    {0, 0, 1}, {7.1234567, 50.7654321, 1e-3}, {431234.56, 5398765.43, 10}};

TEST(CloseOutlines, AGapOfOneUnitOutside) {
    for (const Frame& frame : frames) {
        const PlanPoint a = frame(0, 0), b = frame(10, 4), c = frame(20, 0);
        const double gap = above(b[0]);
        // Two blocks with the least gap between them, upright and slanted.
        expect_meshed(
            {{a, {b[0], a[1]}, b, {a[0], b[1]}}, {{gap, a[1]}, c, {c[0], b[1]}, {gap, b[1]}}},
            frame.unit);
        const PlanPoint p = frame(1, 1), q = frame(8, 4.3), r = frame(2, 9), s = frame(9, -3);
        expect_meshed({{p, q, r}, {{p[0], below(p[1])}, s, {q[0], below(q[1])}}}, frame.unit / 3);
    }
}

TEST(CloseOutlines, AStripOfOneUnitInside) {
    for (const Frame& frame : frames) {
        const PlanPoint a = frame(0, 0), b = frame(10, 3);
        expect_meshed({{a, b, {b[0], above(b[1])}, {a[0], above(a[1])}}}, frame.unit);
        // A hole one unit from the outline, along it.
        const PlanPoint p = frame(2, 0), q = frame(8, 5);
        expect_meshed({rectangle(a[0], a[1], frame(10, 0)[0], frame(0, 8)[1]),
                       rectangle(p[0], above(a[1]), q[0], q[1])},
                      frame.unit);
    }
}

TEST(CloseOutlines, ACornerOneUnitFromAnEdge) {
    for (const Frame& frame : frames) {
        for (int steps = 1; steps < 4; ++steps) {
            const PlanPoint a = frame(0, 0), b = frame(10, 3.3), c = frame(3, 9);
            const double x = frame(5, 0)[0];
            double y = a[1] + (x - a[0]) / (b[0] - a[0]) * (b[1] - a[1]);
            while (orient2d(a, b, {x, y}) <= 0)
                y = above(y);
            y = above(y, steps - 1);
            expect_meshed({{a, b, c}, {{x, y}, frame(5, 4), frame(4, 4)}}, frame.unit);
        }
    }
}

TEST(CloseOutlines, NeedlesFromOneCorner) {
    for (const Frame& frame : frames) {
        std::vector<Ring> rings;
        const PlanPoint tip = frame(0, 0);
        double y = frame(0, 3.7)[1];
        const double x = frame(30, 0)[0];
        for (int i = 0; i < 5; ++i) {  // touching at the tip, a unit between them at the other end
            rings.push_back({tip, {x, y}, {x, above(y, 3)}});
            y = above(y, 4);
        }
        expect_meshed(rings, frame.unit);
    }
}

TEST(CloseOutlines, CombsAndSpirals) {
    for (const Frame& frame : frames) {
        Ring comb{frame(0, -2)};
        double x = frame(0, 0)[0];
        for (int i = 0; i < 12; ++i) {
            const double right = above(x, 2 + i % 3);
            comb.insert(comb.end(), {{x, frame(0, 0)[1]},
                                     {x, frame(0, 6)[1]},
                                     {right, frame(0, 6)[1]},
                                     {right, frame(0, 0)[1]}});
            x = above(right, 1 + i % 2);
        }
        comb.push_back(frame(9, -2));
        std::reverse(comb.begin() + 1, comb.end());
        expect_meshed({comb}, frame.unit);

        Ring out, back;  // a spiral whose arms are a few units apart
        for (int i = 0; i < 40; ++i) {
            const double angle = i * std::numbers::pi / 4;
            const double radius = 5 + 0.1 * i;
            const PlanPoint p = frame(radius * std::cos(angle), radius * std::sin(angle));
            out.push_back(p);
            back.push_back({above(p[0], 3), above(p[1], 2)});
        }
        out.insert(out.end(), back.rbegin(), back.rend());
        try {
            triangulate_region(std::vector<Ring>{out});
        } catch (const InputError&) {
            continue;
        }
        expect_meshed({out}, frame.unit);
    }
}

TEST(CloseOutlines, HolesThatTouchInVertices) {
    for (const Frame& frame : frames) {
        const PlanPoint touch = frame(5, 5), edge = frame(5, 0);
        expect_meshed({rectangle(frame(0, 0)[0], frame(0, 0)[1], frame(10, 0)[0], frame(0, 10)[1]),
                       {touch, frame(7, 6), {above(touch[0], 2), frame(0, 8)[1]}},
                       {touch, {below(touch[0]), frame(0, 8)[1]}, frame(3, 6)},
                       {edge, {above(edge[0]), frame(0, 3)[1]}, {edge[0], frame(0, 3)[1]}}},
                      frame.unit);
    }
}

TEST(CloseOutlines, VeryShortEdgesBesideLongOnes) {
    for (const Frame& frame : frames) {
        const PlanPoint a = frame(0, 0), b = frame(100, 1), c = frame(50, 40);
        expect_meshed(
            {{a, b, {above(b[0], 2), above(b[1])}, c, {below(c[0]), c[1]}, {a[0], above(a[1], 3)}}},
            3 * frame.unit);
    }
}

TEST(CloseOutlines, RandomRingsOnAFewDoubles) {
    std::mt19937 random(3);
    int meshed = 0;
    for (int round = 0; round < (kSanitized ? 100 : 300); ++round) {
        const Frame& frame = frames[round % 3];
        std::vector<Ring> rings(1 + random() % 3);
        for (Ring& ring : rings) {
            for (std::size_t i = 3 + random() % 5; i > 0; --i) {
                PlanPoint p = frame(2 * static_cast<double>(random() % 5),
                                    2 * static_cast<double>(random() % 5));
                p = {above(p[0], static_cast<int>(random() % 4)),
                     above(p[1], static_cast<int>(random() % 4))};
                ring.push_back(p);
            }
        }
        try {
            triangulate_region(rings);
        } catch (const InputError&) {
            continue;
        }
        SCOPED_TRACE(round);
        ++meshed;
        expect_meshed(rings, frame.unit);
    }
    EXPECT_GT(meshed, kSanitized ? 12 : 40);
}

TEST(CloseOutlines, LinesAndPointsThatComeClose) {
    for (const Frame& frame : std::span(frames).first(kSanitized ? 1 : 3)) {
        const PlanPoint a = frame(0, 0), b = frame(10, 0), c = frame(10, 10), d = frame(0, 10);
        const double gap = above(frame(5, 0)[0]);
        const std::vector<Ring> rings{{a, {frame(5, 0)[0], a[1]}, {frame(5, 0)[0], d[1]}, d},
                                      {{gap, a[1]}, b, c, {gap, d[1]}}};
        MeshRequest request;
        request.edge_length = frame.unit;
        const PlanPoint p = frame(1, 2), q = frame(9, 7.3);
        request.constraints.lines = {{p, q},
                                     {p, {q[0], above(q[1])}},
                                     {{p[0], above(p[1])}, {q[0], below(q[1])}},
                                     {frame(-1, 3), frame(11, 4)},
                                     {frame(2, 0), frame(2, 10)},
                                     {{above(frame(2, 0)[0]), a[1]}, {frame(2, 0)[0], d[1]}}};
        request.constraints.points = {
            p, {above(a[0]), frame(0, 5)[1]}, {frame(3, 0)[0], above(a[1])}};
        expect_meshed(rings, request);
    }
}

TEST(CloseOutlines, RandomLinesThroughOnePlace) {
    std::mt19937 random(5);
    for (int round = 0; round < (kSanitized ? 3 : 6); ++round) {
        const Frame& frame = frames[round % 3];
        MeshRequest request;
        request.edge_length = 2 * frame.unit;
        const PlanPoint c = frame(5, 5);
        for (int i = 0; i < 8; ++i) {
            const double angle = static_cast<double>(random()) * 1e-9;
            const PlanPoint p = frame(5 + 7 * std::cos(angle), 5 + 7 * std::sin(angle)),
                            q = frame(5 - 7 * std::cos(angle), 5 - 7 * std::sin(angle));
            request.constraints.lines.push_back(
                {p, {above(c[0], static_cast<int>(random() % 3)), c[1]}, q});
        }
        SCOPED_TRACE(round);
        expect_meshed({rectangle(frame(0, 0)[0], frame(0, 0)[1], frame(10, 0)[0], frame(0, 10)[1])},
                      request);
    }
}

}  // namespace
}  // namespace realmodel::meshing
