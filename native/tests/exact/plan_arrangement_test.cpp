// SPDX-License-Identifier: GPL-3.0-or-later
#include "exact/plan_arrangement.hpp"

#include <gmpxx.h>
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <map>
#include <optional>
#include <random>
#include <utility>
#include <vector>

#include "../sanitized.hpp"
#include "base/key_table.hpp"
#include "exact/arithmetic.hpp"
#include "exact/local_arrangement.hpp"
#include "exact/orientation.hpp"
#include "realmodel/base/errors.hpp"

namespace realmodel::exact {
namespace {

TEST(OwnedNames, FindsWhatAnOwnerHasAndSendsTheRestElsewhere) {
    OwnedNames names;
    KeyTable elsewhere;
    std::vector<std::pair<std::int32_t, std::int32_t>> things;
    std::map<std::pair<std::int32_t, std::int32_t>, std::int32_t> reference;
    std::mt19937 random(1);
    std::uniform_int_distribution<std::int32_t> owner(0, 300), which(0, 40);
    int sent = 0;
    for (int i = 0; i < 20000; ++i) {
        // the first owners have few things, the others more than a list holds
        const std::int32_t o = owner(random), w = o < 150 ? which(random) % 8 : which(random);
        const auto next = static_cast<std::int32_t>(things.size());
        std::int32_t number = names.find_or_add(o, next, [&](std::int32_t n) {
            return things[static_cast<std::size_t>(n)].second == w;
        });
        if (number == OwnedNames::kElsewhere) {
            ++sent;
            EXPECT_GE(o, 150);
            number = elsewhere
                         .insert({o, w, 0, 0}, next,
                                 [&](std::int32_t n) {
                                     const auto [a, b] = things[static_cast<std::size_t>(n)];
                                     return KeyTable::Key{a, b, 0, 0};
                                 })
                         .number;
        }
        EXPECT_EQ(number, reference.emplace(std::pair(o, w), next).first->second);
        if (number == next) things.emplace_back(o, w);
    }
    EXPECT_GT(sent, 1000);
}

TEST(OwnedNames, EdgesAreFoundAgainHoweverManyMeet) {
    PlanArrangement geometry;
    constexpr int kLines = 40;
    const VertexId from = geometry.add_vertex(0, 0);
    std::vector<VertexId> to;
    for (int i = 0; i < kLines; ++i)
        to.push_back(geometry.add_vertex(i + 1, 5));
    geometry.freeze_vertices();
    std::vector<LineId> fan;
    for (const VertexId v : to)
        fan.push_back(geometry.add_edge(from, v).id());
    for (std::size_t i = 0; i < to.size(); ++i)
        EXPECT_EQ(geometry.add_edge(to[i], from), DirectedLine(fan[i], true));
    EXPECT_EQ(geometry.line_count(), static_cast<std::size_t>(kLines));
}

using ExactPosition = std::array<mpq_class, 2>;

mpq_class q(double v) {
    return mpq_class(v);
}

/// Another way to the same answers: rational coordinates instead of determinants of lines.
class Reference {
public:
    explicit Reference(const PlanArrangement& g) : g_(g) {}

    mpq_class height(PlaneId plane, const ExactPosition& p) const {
        std::array<std::array<mpq_class, 3>, 3> c;
        for (std::size_t i = 0; i < 3; ++i) {
            const SpaceVertex& s = g_.space(g_.plane(plane).corner[i]);
            c[i] = {q(g_.point(s.plan).x), q(g_.point(s.plan).y), q(s.z)};
        }
        const mpq_class ux = c[1][0] - c[0][0], uy = c[1][1] - c[0][1];
        const mpq_class vx = c[2][0] - c[0][0], vy = c[2][1] - c[0][1];
        const mpq_class area = ux * vy - uy * vx;
        const mpq_class wx = p[0] - c[0][0], wy = p[1] - c[0][1];
        const mpq_class s = (wx * vy - wy * vx) / area, t = (ux * wy - uy * wx) / area;
        return c[0][2] + s * (c[1][2] - c[0][2]) + t * (c[2][2] - c[0][2]);
    }

    mpq_class value(const Line& line, const ExactPosition& p) const {
        if (!line.is_edge()) return height(line.planes()[0], p) - height(line.planes()[1], p);
        const Point &a = g_.point(line.ends()[0]), &b = g_.point(line.ends()[1]);
        return (q(b.x) - q(a.x)) * (p[1] - q(a.y)) - (q(b.y) - q(a.y)) * (p[0] - q(a.x));
    }

    /// Whether a trace is a line: its planes are not parallel.
    bool is_proper(const Line& line) const {
        const mpq_class c = value(line, {0, 0});
        return value(line, {1, 0}) != c || value(line, {0, 1}) != c;
    }

    /// Where two lines cross, found from their values at three places; nothing if parallel.
    std::optional<ExactPosition> crossing(const Line& l, const Line& m) const {
        const auto coefficients = [&](const Line& line) {
            const mpq_class c = value(line, {0, 0});
            return std::array<mpq_class, 3>{value(line, {1, 0}) - c, value(line, {0, 1}) - c, c};
        };
        const auto a = coefficients(l), b = coefficients(m);
        const mpq_class w = a[0] * b[1] - a[1] * b[0];
        if (w == 0) return std::nullopt;
        return ExactPosition{(a[1] * b[2] - b[1] * a[2]) / w, (a[2] * b[0] - b[2] * a[0]) / w};
    }

private:
    const PlanArrangement& g_;
};

struct Trial {
    PlanArrangement geometry;
    std::vector<VertexId> vertices;
    std::vector<PlaneId> planes;
};

/// Vertices from a source of coordinates and planes over random triples of them.
void fill(Trial& trial, std::mt19937_64& random, const std::function<double()>& plan,
          const std::function<double()>& height) {
    std::vector<SpaceId> space;
    for (int i = 0; i < 9; ++i) {
        const VertexId v = trial.geometry.add_vertex(plan(), plan());
        trial.vertices.push_back(v);
        space.push_back(trial.geometry.add_space_vertex(v, height()));
    }
    trial.geometry.freeze_vertices();
    std::uniform_int_distribution<std::size_t> pick(0, space.size() - 1);
    while (trial.planes.size() < 5) {
        std::array<SpaceId, 3> c{space[pick(random)], space[pick(random)], space[pick(random)]};
        std::array<std::array<double, 2>, 3> p;
        for (std::size_t i = 0; i < 3; ++i) {
            const Point& at = trial.geometry.point(trial.geometry.space(c[i]).plan);
            p[i] = {at.x, at.y};
        }
        const int way = orient2d(p[0], p[1], p[2]);
        if (way == 0) continue;
        if (way < 0) std::swap(c[1], c[2]);
        trial.planes.push_back(trial.geometry.add_plane(c));
    }
}

struct Tally {
    std::uint64_t named = 0;  // pairs of planes known to be equally high
    std::uint64_t sides = 0, exact_sides = 0, zeros = 0;  // exact_sides: of answers that are not 0
};

/// Asks every kind of question of random lines and crossings and compares with the reference.
Tally compare(std::uint64_t seed, int rounds, const std::function<double(std::mt19937_64&)>& plan,
              const std::function<double(std::mt19937_64&)>& height) {
    std::mt19937_64 random(seed);
    Tally tally;
    for (int round = 0; round < (kSanitized ? rounds / 4 : rounds); ++round) {
        Trial trial;
        fill(
            trial, random, [&] { return plan(random); }, [&] { return height(random); });
        const Reference reference(trial.geometry);
        std::vector<LineId> lines;
        std::uniform_int_distribution<std::size_t> pick(0, trial.vertices.size() - 1);
        for (int i = 0; i < 6; ++i) {
            const VertexId a = trial.vertices[pick(random)], b = trial.vertices[pick(random)];
            if (a != b) lines.push_back(trial.geometry.add_edge(a, b).id());
        }
        {
            LocalArrangement scope(trial.geometry);
            for (std::size_t i = 0; i < trial.planes.size(); ++i) {
                for (std::size_t j = 0; j < i; ++j) {
                    const PlaneId a = trial.planes[i], b = trial.planes[j];
                    const LineId trace = scope.trace(a, b).id();
                    if (reference.is_proper(scope.line(trace))) lines.push_back(trace);
                }
            }
            std::vector<std::pair<PointId, ExactPosition>> points;
            for (const VertexId v : trial.vertices) {
                points.push_back({v, {q(trial.geometry.point(v).x), q(trial.geometry.point(v).y)}});
            }
            for (const LineId l : lines) {
                for (const LineId m : lines) {
                    if (points.size() > 26) break;
                    const auto at = reference.crossing(scope.line(l), scope.line(m));
                    if (at) points.push_back({scope.crossing(l, m), *at});
                }
            }
            for (const auto& [point, at] : points) {
                for (const LineId l : lines) {
                    const int expected = sgn(reference.value(scope.line(l), at));
                    tally.zeros += expected == 0;
                    const std::uint64_t exact_before = scope.exact_decisions();
                    EXPECT_EQ(scope.side(DirectedLine(l), point), expected);
                    ++tally.sides;
                    if (expected != 0) tally.exact_sides += scope.exact_decisions() - exact_before;
                    EXPECT_EQ(scope.side(DirectedLine(l, true), point), -expected);
                }
                for (const PlaneId a : trial.planes) {
                    const mpq_class z = reference.height(a, at);
                    EXPECT_EQ(scope.rounded_height(a, point),
                              nearest_double(z.get_num(), z.get_den(), 0));
                    for (const PlaneId b : trial.planes) {
                        const int sign = sgn(mpq_class(z - reference.height(b, at)));
                        EXPECT_EQ(scope.compare_heights(a, b, point), sign);
                        if (scope.height_name(a, point) == scope.height_name(b, point)) {
                            EXPECT_EQ(sign, 0);
                            tally.named += a != b;
                        }
                    }
                }
                EXPECT_EQ(scope.rounded(point)[0],
                          nearest_double(at[0].get_num(), at[0].get_den(), 0));
                EXPECT_EQ(scope.rounded(point)[1],
                          nearest_double(at[1].get_num(), at[1].get_den(), 0));
            }
            for (std::size_t i = 0; i + 1 < points.size(); ++i) {
                const auto& [p, at] = points[i];
                const auto& [r, there] = points[i + 1];
                EXPECT_EQ(scope.same_place(p, r), at == there);
                EXPECT_EQ(scope.compare(0, p, r), sgn(mpq_class(there[0] - at[0])));
                EXPECT_EQ(scope.compare(1, p, r), sgn(mpq_class(there[1] - at[1])));
            }
            for (const LineId l : lines) {
                for (const LineId m : lines) {
                    const Line a = scope.line(l), b = scope.line(m);
                    bool same = true;
                    for (const auto& [point, at] : points) {
                        same &= (reference.value(a, at) == 0) == (reference.value(b, at) == 0);
                    }
                    // lines that pass the same of many places, two of them at least, are one line
                    if (scope.same_line(l, m)) {
                        EXPECT_TRUE(same);
                        EXPECT_EQ(scope.line_key(l), scope.line_key(m));
                    }
                    if (a.is_edge()) {
                        const auto on_b = [&](VertexId v) {
                            return reference.value(b, {q(trial.geometry.point(v).x),
                                                       q(trial.geometry.point(v).y)}) == 0;
                        };
                        EXPECT_EQ(scope.same_line(l, m), on_b(a.ends()[0]) && on_b(a.ends()[1]));
                    }
                }
            }
        }
    }
    return tally;
}

double uniform(std::mt19937_64& random, double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(random);
}

TEST(PlanArrangement, RandomInputIsDecidedByTheFilter) {
    const Tally tally = compare(
        1, 12, [](auto& r) { return uniform(r, 0, 1000); },
        [](auto& r) { return uniform(r, 0, 50); });
    EXPECT_GT(tally.sides, kSanitized ? 1000u : 2000u);
    // only lines through one point by another name should need exact arithmetic
    EXPECT_LT(static_cast<double>(tally.exact_sides), 0.002 * static_cast<double>(tally.sides));
    RecordProperty("sides", static_cast<int>(tally.sides));
    RecordProperty("exact_sides", static_cast<int>(tally.exact_sides));
}

TEST(PlanArrangement, LatticesWhereMostAnswersAreTies) {
    const auto lattice = [](auto& r) { return std::floor(uniform(r, 0, 4)); };
    const Tally tally = compare(2, 20, lattice, lattice);
    EXPECT_GT(tally.zeros, 500u);
    EXPECT_GT(tally.named, 100u);
}

TEST(PlanArrangement, OneUnitInTheLastPlace) {
    const auto nudged = [](auto& r) {
        double v = std::floor(uniform(r, 1, 4)) / 3.0;
        for (int i = static_cast<int>(uniform(r, 0, 3)); i > 0; --i)
            v = std::nextafter(v, 10.0);
        return v;
    };
    compare(3, 15, nudged, nudged);
}

TEST(PlanArrangement, LargeCoordinatesAndUnlikeMagnitudes) {
    compare(
        4, 10, [](auto& r) { return 5.3e6 + std::floor(uniform(r, 0, 6)) * 0.1; },
        [](auto& r) { return uniform(r, 0, 1) < 0.5 ? 1e-6 : 1e6 * std::floor(uniform(r, 0, 3)); });
}

TEST(PlanArrangement, NeedlesWhoseAreaIsBelowRounding) {
    compare(
        5, 10,
        [](auto& r) {
            return std::floor(uniform(r, 0, 3)) + std::floor(uniform(r, 0, 2)) * 0x1p-40;
        },
        [](auto& r) { return std::floor(uniform(r, 0, 3)); });
}

TEST(PlanArrangement, VerticesAreOneWherePositionsAreEqual) {
    PlanArrangement g;
    EXPECT_EQ(g.add_vertex(1, 2), g.add_vertex(1, 2));
    EXPECT_EQ(g.add_vertex(0.0, 2), g.add_vertex(-0.0, 2));
    EXPECT_NE(g.add_vertex(1, 2), g.add_vertex(2, 1));
    const VertexId v = g.add_vertex(1, 2);
    EXPECT_EQ(g.add_space_vertex(v, 0.0), g.add_space_vertex(v, -0.0));
    EXPECT_NE(g.add_space_vertex(v, 1), g.add_space_vertex(v, 2));
}

TEST(PlanArrangement, LocalNamesBecomeSharedOnes) {
    PlanArrangement g;
    const VertexId a = g.add_vertex(0, 0), b = g.add_vertex(4, 0), c = g.add_vertex(0, 4),
                   d = g.add_vertex(4, 3);
    g.freeze_vertices();
    const LineId ab = g.add_edge(a, b).id(), ad = g.add_edge(a, d).id(), bc = g.add_edge(b, c).id();
    LocalArrangement first(g), second(g);
    const PointId p = first.crossing(ad, bc), r = second.crossing(bc, ad);
    EXPECT_EQ(first.crossing(ad, bc), p);
    EXPECT_EQ(first.crossing(ab, bc), b);  // an input vertex keeps its name
    first.commit(g);
    second.commit(g);
    EXPECT_EQ(first.shared_point(p), second.shared_point(r));  // not marked: found by name
    EXPECT_EQ(g.point_count(), 5u);
    EXPECT_DOUBLE_EQ(g.point(first.shared_point(p)).x, 16.0 / 7.0);
}

TEST(LocalIds, WhatIsMarkedGetsARangeOfIdsInTheOrderOfMarking) {
    PlanArrangement g;
    const VertexId a = g.add_vertex(0, 0), b = g.add_vertex(8, 1), c = g.add_vertex(1, 8),
                   d = g.add_vertex(2, -4), e = g.add_vertex(3, 9), f = g.add_vertex(5, -3),
                   h = g.add_vertex(6, 7);
    g.freeze_vertices();
    const LineId ab = g.add_edge(a, b).id(), ac = g.add_edge(a, c).id(), de = g.add_edge(d, e).id(),
                 fh = g.add_edge(f, h).id();
    LocalArrangement first(g), second(g);
    const PointId with_de = first.crossing(ab, de), with_fh = first.crossing(ab, fh);
    const PointId again = second.crossing(ab, de);
    first.mark_point_used(with_fh);
    first.mark_point_used(with_de);
    first.mark_point_used(with_fh);  // counts once
    first.mark_point_used(a);        // is shared already
    second.mark_point_used(again);
    first.commit(g);
    second.commit(g);
    EXPECT_EQ(first.shared_point(a), a);
    EXPECT_EQ(first.shared_point(with_fh), PointId(7));
    EXPECT_EQ(first.shared_point(with_de), PointId(8));
    EXPECT_EQ(second.shared_point(again), PointId(9));  // nobody looks for the one of the first
    EXPECT_EQ(g.line_count(), 4u);
    EXPECT_EQ(first.shared_line(ac), ac);
    LocalArrangement reader(g);
    EXPECT_TRUE(reader.same_place(PointId(8), PointId(9)));
    EXPECT_FALSE(reader.same_place(PointId(7), PointId(9)));
    EXPECT_EQ(reader.exact_decisions(), 0u);
}

TEST(PlanArrangement, RefusesMoreThingsThanItHasIdsFor) {
    EXPECT_NO_THROW(check_ids(4, "triangles", 4));
    EXPECT_NO_THROW(check_ids(std::size_t{1} << 29, "triangles"));
    try {
        check_ids((std::size_t{1} << 29) + 1, "triangles");
        FAIL();
    } catch (const InputError& error) {
        EXPECT_EQ(error.kind, "too_large");
        EXPECT_NE(std::string(error.what()).find("536 million triangles"), std::string::npos);
    }
    PlanArrangement g;
    EXPECT_THROW(g.make_planes(std::size_t{1} << 30), InputError);
    EXPECT_THROW(g.append(std::size_t{1} << 30, 0), InputError);
    EXPECT_THROW(g.append(0, std::size_t{1} << 30), InputError);
    EXPECT_EQ(g.plane_count(), 0u);
}

/// Two surfaces on the plan mesh of two triangles that share the plan edge of vertices 1 and 2, and
/// cross each other over it.
struct CrossingOnOneMesh {
    CrossingOnOneMesh() {
        const std::array<VertexId, 4> v{g.add_vertex(0, 0), g.add_vertex(1, 0.125),
                                        g.add_vertex(0.25, 1), g.add_vertex(1.5, 1.25)};
        const std::array<std::array<double, 4>, 2> heights{{{0, 0.5, 0.25, 1}, {0.5, 0, 0.75, 0}}};
        for (std::size_t k = 0; k < 2; ++k) {
            std::array<SpaceId, 4> s;
            for (std::size_t i = 0; i < 4; ++i)
                s[i] = g.add_space_vertex(v[i], heights[k][i]);
            plane[k] = {g.add_plane({s[0], s[1], s[2]}), g.add_plane({s[2], s[1], s[3]})};
        }
        g.freeze_vertices();
        edge = g.add_edge(v[1], v[2]).id();
    }

    PlanArrangement g;
    LineId edge;
    std::array<std::array<PlaneId, 2>, 2> plane;  ///< of each surface, on either side of the edge
};

TEST(PlanArrangement, EdgesOverEachOtherCrossInOnePointFromBothSides) {
    CrossingOnOneMesh mesh;
    LocalArrangement scope(mesh.g);
    const auto trace = [&](std::size_t lower, std::size_t upper) {
        return scope.trace(mesh.plane[0][lower], mesh.plane[1][upper]).id();
    };
    const PointId from_one = scope.crossing(mesh.edge, trace(0, 0));
    EXPECT_EQ(scope.crossing(trace(1, 1), mesh.edge), from_one);
    EXPECT_EQ(scope.crossing(mesh.edge, trace(0, 1)), from_one);
    // All four planes are equally high there, which is known without arithmetic.
    for (const PlaneId a : {mesh.plane[0][0], mesh.plane[0][1]}) {
        for (const PlaneId b : {mesh.plane[1][0], mesh.plane[1][1]}) {
            EXPECT_EQ(scope.compare_heights(a, b, from_one), 0);
            EXPECT_EQ(scope.side(scope.trace(a, b), from_one), 0);
        }
    }
    EXPECT_EQ(scope.exact_decisions(), 0u);
    scope.mark_point_used(from_one);
    const auto position = scope.rounded(from_one);
    scope.commit(mesh.g);
    LocalArrangement other(mesh.g);
    EXPECT_EQ(other.rounded(scope.shared_point(from_one)), position);
}

TEST(PlanArrangement, CrossingsOnABorderAlongAnAxisNeedNoExactArithmetic) {
    PlanArrangement g;
    const double x = 0.1;
    const std::array<VertexId, 5> v{g.add_vertex(x, 0), g.add_vertex(x, 0.3), g.add_vertex(x, 0.7),
                                    g.add_vertex(-1, 0.1), g.add_vertex(1, 0.2)};
    g.freeze_vertices();
    const LineId lower = g.add_edge(v[0], v[1]).id(), across = g.add_edge(v[3], v[4]).id();
    const DirectedLine upper = g.add_edge(v[1], v[2]);
    LocalArrangement scope(g);
    const PointId at = scope.crossing(lower, across);
    ASSERT_FALSE(scope.is_vertex(at));
    EXPECT_EQ(scope.side(upper, at), 0);
    EXPECT_EQ(scope.exact_decisions(), 0u);
}

}  // namespace
}  // namespace realmodel::exact
