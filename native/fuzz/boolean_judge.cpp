// SPDX-License-Identifier: GPL-3.0-or-later
#include "boolean_judge.hpp"

#include <gmpxx.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <optional>
#include <set>
#include <string>

#include "random_source.hpp"
#include "realmodel/booleans/intersect.hpp"

namespace realmodel::fuzz {

namespace {

using booleans::LoopKind;
using booleans::Operation;
using booleans::Refinement;

struct Flat {
    std::vector<double> vertices;
    std::vector<std::int32_t> triangles;
    TriangleView view() const { return {vertices, triangles}; }
};

Flat flat(const Mesh& mesh) {
    Flat result;
    for (const Point& p : mesh.vertices)
        result.vertices.insert(result.vertices.end(), p.begin(), p.end());
    for (const Triangle& t : mesh.triangles)
        result.triangles.insert(result.triangles.end(), t.begin(), t.end());
    return result;
}

/// Six times the signed volume of a, b, c, d; in doubles of more digits where these decide.
int side_of(const Point& a, const Point& b, const Point& c, const Point& d) {
    std::array<std::array<long double, 3>, 3> u;
    for (std::size_t k = 0; k < 3; ++k) {
        u[0][k] = static_cast<long double>(a[k]) - d[k];
        u[1][k] = static_cast<long double>(b[k]) - d[k];
        u[2][k] = static_cast<long double>(c[k]) - d[k];
    }
    long double value = 0, size = 0;
    for (std::size_t k = 0; k < 3; ++k) {
        const std::size_t l = (k + 1) % 3, m = (k + 2) % 3;
        const long double p = u[1][l] * u[2][m], q = u[1][m] * u[2][l];
        value += u[0][k] * (p - q);
        size += std::abs(u[0][k]) * (std::abs(p) + std::abs(q));
    }
    if (std::abs(value) > 1e-16L * size && size > 1e-200L) return value > 0 ? 1 : -1;
    std::array<std::array<mpq_class, 3>, 3> v;
    for (std::size_t k = 0; k < 3; ++k) {
        v[0][k] = mpq_class(a[k]) - mpq_class(d[k]);
        v[1][k] = mpq_class(b[k]) - mpq_class(d[k]);
        v[2][k] = mpq_class(c[k]) - mpq_class(d[k]);
    }
    const mpq_class exact = v[0][0] * (v[1][1] * v[2][2] - v[1][2] * v[2][1]) +
                            v[0][1] * (v[1][2] * v[2][0] - v[1][0] * v[2][2]) +
                            v[0][2] * (v[1][0] * v[2][1] - v[1][1] * v[2][0]);
    return sgn(exact);
}

/// Which way a, b, c turn in the plane of all axes but one.
int turn_of(std::size_t axis, const Point& a, const Point& b, const Point& c) {
    const std::size_t u = (axis + 1) % 3, v = (axis + 2) % 3;
    const mpq_class exact =
        (mpq_class(b[u]) - mpq_class(a[u])) * (mpq_class(c[v]) - mpq_class(a[v])) -
        (mpq_class(b[v]) - mpq_class(a[v])) * (mpq_class(c[u]) - mpq_class(a[u]));
    return sgn(exact);
}

using Corners = std::array<Point, 3>;
using Row = std::array<std::int32_t, 3>;

/// The axis along which a triangle has an area; 3 where it has none.
std::size_t axis_of(const Corners& t) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
        if (turn_of(axis, t[0], t[1], t[2]) != 0) return axis;
    }
    return 3;
}

class Crossings {
public:
    explicit Crossings(const Refinement& r) : r_(r) {}

    /// "" where two triangles have nothing in common but corners and edges.
    std::string between(std::size_t i, std::size_t j) const {
        const Row &a = r_.triangles[i], &b = r_.triangles[j];
        const auto s = corners(a), t = corners(b);
        for (std::size_t k = 0; k < 3; ++k) {
            if (!is_in(a[k], b) && contains(t, s[k])) return "a corner lies on the other";
            if (!is_in(b[k], a) && contains(s, t[k])) return "a corner lies on the other";
        }
        for (std::size_t k = 0; k < 3; ++k) {
            if (pierces(s[k], s[(k + 1) % 3], t)) return "an edge passes through the other";
            if (pierces(t[k], t[(k + 1) % 3], s)) return "an edge passes through the other";
            for (std::size_t l = 0; l < 3; ++l) {
                if (cross(s[k], s[(k + 1) % 3], t[l], t[(l + 1) % 3], t)) return "edges cross";
            }
        }
        return "";
    }
    Point vertex(std::int32_t v) const {
        const double* p = &r_.vertices[3 * static_cast<std::size_t>(v)];
        return {p[0], p[1], p[2]};
    }
    Corners corners(const Row& t) const { return {vertex(t[0]), vertex(t[1]), vertex(t[2])}; }

private:
    static bool is_in(std::int32_t v, const Row& t) { return v == t[0] || v == t[1] || v == t[2]; }
    static bool contains(const Corners& t, const Point& p) {
        if (side_of(t[0], t[1], t[2], p) != 0) return false;
        const std::size_t axis = axis_of(t);
        if (axis == 3) return false;
        const int way = turn_of(axis, t[0], t[1], t[2]);
        for (std::size_t k = 0; k < 3; ++k) {
            if (way * turn_of(axis, t[k], t[(k + 1) % 3], p) < 0) return false;
        }
        return true;
    }
    static bool pierces(const Point& p, const Point& q, const Corners& t) {
        if (side_of(t[0], t[1], t[2], p) * side_of(t[0], t[1], t[2], q) >= 0) return false;
        int above = 0, below = 0;
        for (std::size_t k = 0; k < 3; ++k) {
            const int side = side_of(p, q, t[k], t[(k + 1) % 3]);
            above += side > 0;
            below += side < 0;
        }
        return above == 0 || below == 0;
    }
    static bool cross(const Point& a, const Point& b, const Point& c, const Point& d,
                      const Corners& t) {
        if (side_of(a, b, c, d) != 0) return false;
        if (side_of(t[0], t[1], t[2], a) != 0 || side_of(t[0], t[1], t[2], b) != 0) return false;
        const std::size_t axis = axis_of(t);
        return axis < 3 && turn_of(axis, a, b, c) * turn_of(axis, a, b, d) < 0 &&
               turn_of(axis, c, d, a) * turn_of(axis, c, d, b) < 0;
    }

    const Refinement& r_;
};

/// How often a surface goes round a place, as the angle that it is seen under (A. van Oosterom and
/// J. Strackee, 1983); not a whole number where the place is on it.
template <class At>
double winding(const std::vector<Row>& triangles, const At& at, const Point& p) {
    double sum = 0;
    for (const Row& t : triangles) {
        std::array<Point, 3> u;
        std::array<double, 3> size;
        for (std::size_t i = 0; i < 3; ++i) {
            const Point corner = at(t[i]);
            for (std::size_t k = 0; k < 3; ++k)
                u[i][k] = corner[k] - p[k];
            size[i] = std::sqrt(u[i][0] * u[i][0] + u[i][1] * u[i][1] + u[i][2] * u[i][2]);
        }
        const auto dot = [&](std::size_t i, std::size_t j) {
            return u[i][0] * u[j][0] + u[i][1] * u[j][1] + u[i][2] * u[j][2];
        };
        const double volume = u[0][0] * (u[1][1] * u[2][2] - u[1][2] * u[2][1]) +
                              u[0][1] * (u[1][2] * u[2][0] - u[1][0] * u[2][2]) +
                              u[0][2] * (u[1][0] * u[2][1] - u[1][1] * u[2][0]);
        sum += std::atan2(volume, size[0] * size[1] * size[2] + dot(0, 1) * size[2] +
                                      dot(1, 2) * size[0] + dot(2, 0) * size[1]);
    }
    return sum / (2 * std::numbers::pi);
}

class Judge {
public:
    Judge(const StackCase& pair, std::uint64_t seed) : random_(seed) {
        for (std::size_t k = 0; k < 2; ++k)
            inputs_[k] = pair.rocks[0].surfaces[k];
        for (const Mesh& mesh : inputs_) {
            for (const Point& p : mesh.vertices) {
                for (std::size_t k = 0; k < 3; ++k) {
                    low_[k] = std::min(low_[k], p[k]);
                    high_[k] = std::max(high_[k], p[k]);
                    largest_ = std::max(largest_, std::abs(p[k]));
                }
            }
        }
    }

    std::vector<Defect> run() {
        const Flat a = flat(inputs_[0]), b = flat(inputs_[1]);
        try {
            const Refinement r = booleans::intersect(a.view(), b.view(), {1});
            look_at_triangles(r);
            if (defects_.empty()) look_at_parts(r);
            if (defects_.empty()) look_at_loops(r);
            if (defects_.empty()) look_at_blocks(r);
            if (defects_.empty()) look_at_operations(r);
            if (defects_.empty()) look_again(r);
            const Refinement other = booleans::intersect(a.view(), b.view(), {2});
            if (other.vertices != r.vertices || other.triangles != r.triangles)
                add("threads", "two threads give another refinement");
        } catch (const InputError& error) {
            add("refused", error.kind + ": " + error.what());
        } catch (const std::exception& error) {
            add("exception", error.what());
        }
        return std::move(defects_);
    }

    /// One of the results and one of the surfaces that it was made of; none where there is none.
    std::optional<StackCase> result_with_operand() {
        if (!result_) return std::nullopt;
        StackCase pair;
        pair.rocks.emplace_back();
        pair.rocks[0].surfaces = {std::move(*result_), inputs_[random_.below(2)]};
        return pair;
    }

private:
    void add(const char* kind, std::string sentence) {
        defects_.push_back({kind, std::move(sentence)});
    }
    /// How far rounding may have moved something that matters, in lengths: generously.
    double allowance() const { return 1e-9 * extent() + 0x1p-40 * largest_; }
    double extent() const {
        return std::max({high_[0] - low_[0], high_[1] - low_[1], high_[2] - low_[2], 0x1p-1000});
    }

    void look_at_triangles(const Refinement& r) {
        const Crossings crossings(r);
        std::set<Point> places;
        for (std::size_t v = 0; v < r.vertices.size() / 3; ++v) {
            if (!places.insert(crossings.vertex(static_cast<std::int32_t>(v))).second)
                return add("vertices", "two vertices are in one place");
        }
        for (std::size_t i = 0; i < r.triangles.size(); ++i) {
            if (axis_of(crossings.corners(r.triangles[i])) == 3)
                return add("flat", "triangle " + std::to_string(i) + " has no area");
        }
        const auto is_apart = [&](const Corners& s, const Corners& t) {
            for (std::size_t k = 0; k < 3; ++k) {
                if (std::max({s[0][k], s[1][k], s[2][k]}) < std::min({t[0][k], t[1][k], t[2][k]}) ||
                    std::max({t[0][k], t[1][k], t[2][k]}) < std::min({s[0][k], s[1][k], s[2][k]}))
                    return true;
            }
            return false;
        };
        if (r.triangles.size() > 3000) return;
        for (std::size_t i = 0; i < r.triangles.size(); ++i) {
            const Corners s = crossings.corners(r.triangles[i]);
            for (std::size_t j = i + 1; j < r.triangles.size(); ++j) {
                Row a = r.triangles[i], b = r.triangles[j];
                std::sort(a.begin(), a.end());
                std::sort(b.begin(), b.end());
                if (a == b || is_apart(s, crossings.corners(r.triangles[j]))) continue;
                const std::string found = crossings.between(i, j);
                if (!found.empty())
                    return add("crossing", "triangles " + std::to_string(i) + " and " +
                                               std::to_string(j) + ": " + found);
            }
        }
    }

    /// The sum of the parts' areas, as vectors, is the area of the triangle.
    void look_at_parts(const Refinement& r) {
        const Crossings crossings(r);
        for (std::size_t source = 0; source < 2; ++source) {
            const Mesh& mesh = inputs_[source];
            std::vector<Point> sums(mesh.triangles.size(), Point{0, 0, 0});
            const auto add_area = [](Point& sum, const Corners& t, double sign) {
                for (std::size_t k = 0; k < 3; ++k) {
                    const std::size_t l = (k + 1) % 3, m = (k + 2) % 3;
                    sum[k] += sign * ((t[1][l] - t[0][l]) * (t[2][m] - t[0][m]) -
                                      (t[1][m] - t[0][m]) * (t[2][l] - t[0][l]));
                }
            };
            for (std::size_t i = 0; i < r.triangles.size(); ++i) {
                if (r.source[i] == source)
                    add_area(sums[static_cast<std::size_t>(r.source_triangle[i])],
                             crossings.corners(r.triangles[i]), 1);
            }
            for (std::size_t t = 0; t < sums.size(); ++t) {
                const auto at = [&](std::size_t k) {
                    return mesh.vertices[static_cast<std::size_t>(mesh.triangles[t][k])];
                };
                add_area(sums[t], {at(0), at(1), at(2)}, -1);
                for (const double x : sums[t]) {
                    if (std::abs(x) > 10 * allowance() * extent())
                        return add("parts", "those of triangle " + std::to_string(t) +
                                                " of surface " + std::to_string(source) +
                                                " are not as large as it is");
                }
            }
        }
    }

    void look_at_loops(const Refinement& r) {
        std::set<std::array<std::int32_t, 2>> edges;
        std::map<std::int32_t, int> degree;
        const auto for_each_edge = [](const booleans::IntersectionLoop& loop, const auto& visit) {
            const std::size_t count = loop.vertices.size();
            for (std::size_t i = 0; i + (loop.kind == LoopKind::kHardClosed ? 0 : 1) < count; ++i)
                visit(loop.vertices[i], loop.vertices[(i + 1) % count]);
        };
        for (const auto& loop : r.loops) {
            for_each_edge(loop, [&](std::int32_t p, std::int32_t q) {
                if (p == q || !edges.insert({std::min(p, q), std::max(p, q)}).second)
                    add("loops", "an edge is in two loops, or has no length");
                ++degree[p];
                ++degree[q];
            });
        }
        // edges that triangles of both surfaces have, not all of which are of both
        std::map<std::array<std::int32_t, 2>, std::array<std::set<Row>, 2>> of_edge;
        for (std::size_t i = 0; i < r.triangles.size(); ++i) {
            Row t = r.triangles[i];
            std::sort(t.begin(), t.end());
            for (const auto& edge : {std::array{t[0], t[1]}, {t[1], t[2]}, {t[0], t[2]}})
                of_edge[edge][r.source[i]].insert(t);
        }
        std::size_t expected = 0;
        for (const auto& [edge, triangles] : of_edge) {
            if (triangles[0].empty() || triangles[1].empty() || triangles[0] == triangles[1])
                continue;
            ++expected;
            if (!edges.contains(edge)) add("loops", "an intersection edge is in none");
        }
        if (expected != edges.size()) add("loops", "an edge of one is no intersection edge");
        for (const auto& loop : r.loops) {
            const auto& v = loop.vertices;
            const bool hard = loop.kind == LoopKind::kHardClosed;
            if (v.size() < (hard ? 3U : 2U)) return add("loops", "one is too short");
            for (std::size_t i = 0; i < v.size(); ++i) {
                const bool end = !hard && (i == 0 || i + 1 == v.size());
                if ((degree[v[i]] == 2) == end)
                    return add("loops", "one goes through a vertex wrongly");
            }
            const bool soft = degree[v.front()] > 2 && degree[v.back()] > 2;
            if (!hard && soft != (loop.kind == LoopKind::kSoftClosed))
                return add("loops", "one is of a wrong kind");
        }
    }

    template <class Triangles>
    static bool is_closed(const Triangles& triangles) {
        std::map<std::array<std::int32_t, 2>, int> net;
        for (const auto& t : triangles) {
            for (std::size_t k = 0; k < 3; ++k) {
                ++net[{t[k], t[(k + 1) % 3]}];
                --net[{t[(k + 1) % 3], t[k]}];
            }
        }
        return std::all_of(net.begin(), net.end(), [](const auto& e) { return e.second == 0; });
    }
    double volume(const Refinement& r, const std::vector<Row>& triangles) const {
        const Crossings crossings(r);
        long double sum = 0;
        for (const Row& row : triangles) {
            const Corners t = crossings.corners(row);
            std::array<std::array<long double, 3>, 3> u;
            for (std::size_t i = 0; i < 3; ++i) {
                for (std::size_t k = 0; k < 3; ++k)
                    u[i][k] = static_cast<long double>(t[i][k]) - low_[k];
            }
            sum += u[0][0] * (u[1][1] * u[2][2] - u[1][2] * u[2][1]) +
                   u[0][1] * (u[1][2] * u[2][0] - u[1][0] * u[2][2]) +
                   u[0][2] * (u[1][0] * u[2][1] - u[1][1] * u[2][0]);
        }
        return static_cast<double>(sum / 6);
    }

    void look_at_blocks(const Refinement& r) {
        for (const auto& block : r.sub_blocks) {
            if (!is_closed(block.triangles)) return add("blocks", "one is open");
            if (!(r.volume(block) > -1e-12 * std::pow(extent(), 3)))
                return add("blocks", "one has a volume below zero");
        }
        std::vector<std::uint8_t> seen(r.triangles.size(), 0);
        for (const auto& part : r.sub_surfaces) {
            for (const std::int32_t t : part.triangles) {
                if (r.source[static_cast<std::size_t>(t)] != part.source)
                    add("sub-surfaces", "one has a triangle of the other surface");
                ++seen[static_cast<std::size_t>(t)];
            }
        }
        if (std::any_of(seen.begin(), seen.end(), [](int n) { return n != 1; }))
            add("sub-surfaces", "not each triangle is in one");
    }

    void look_at_operations(const Refinement& r) {
        std::array<std::vector<Row>, 2> input;
        for (std::size_t k = 0; k < 2; ++k) {
            std::map<Point, std::int32_t> number;
            for (const Triangle& t : inputs_[k].triangles) {
                Row row;
                for (std::size_t i = 0; i < 3; ++i) {
                    const Point& p = inputs_[k].vertices[static_cast<std::size_t>(t[i])];
                    row[i] = number.emplace(Point{p[0] + 0.0, p[1] + 0.0, p[2] + 0.0}, t[i])
                                 .first->second;
                }
                input[k].push_back(row);
            }
            if (is_closed(input[k]) && !r.is_closed[k]) return add("closed", "a solid became open");
        }
        if (!r.is_closed[0] || !r.is_closed[1]) return;
        std::array<std::vector<Row>, 4> results;
        std::array<double, 4> volumes{};
        for (std::size_t i = 0; i < 4; ++i) {
            results[i] = r.boundary(static_cast<Operation>(i));
            if (!is_closed(results[i])) return add("result", "one is open");
            volumes[i] = volume(r, results[i]);
        }
        if (const auto& kept = results[random_.below(4)]; !kept.empty()) result_ = mesh_of(r, kept);
        const double whole = std::pow(extent(), 3);
        if (std::abs(volumes[0] - volumes[1] - volumes[2] - volumes[3]) > 1e-12 * whole)
            return add("volumes", "those of the parts do not make up the union's");
        double blocks = 0;
        for (const auto& block : r.sub_blocks) {
            if (block.is_in[0] || block.is_in[1]) blocks += r.volume(block);
        }
        if (std::abs(blocks - volumes[0]) > 1e-12 * whole)
            return add("volumes", "those of the sub-blocks do not make up the union's");
        const Crossings crossings(r);
        for (int n = 0; n < 12; ++n) {
            Point p;
            for (std::size_t k = 0; k < 3; ++k)
                p[k] = random_.uniform(low_[k], high_[k]);
            std::array<bool, 2> is_in{};
            bool sure = true;
            for (std::size_t k = 0; k < 2; ++k) {
                const double w = winding(
                    input[k],
                    [&](std::int32_t v) {
                        return inputs_[k].vertices[static_cast<std::size_t>(v)];
                    },
                    p);
                sure = sure && std::abs(w - std::round(w)) < 1e-7;
                is_in[k] = std::round(w) != 0;
            }
            if (!sure) continue;
            const bool wanted[] = {is_in[0] || is_in[1], is_in[0] && is_in[1],
                                   is_in[0] && !is_in[1], is_in[1] && !is_in[0]};
            for (std::size_t i = 0; i < 4; ++i) {
                const double w = winding(
                    results[i], [&](std::int32_t v) { return crossings.vertex(v); }, p);
                if (std::abs(w - (wanted[i] ? 1 : 0)) > 1e-6)
                    return add("inside", "operation " + std::to_string(i) + " goes " +
                                             std::to_string(w) + " times round a place");
            }
        }
    }

    /// Triangles of a refinement with the vertices that they have.
    static Mesh mesh_of(const Refinement& r, const std::vector<Row>& triangles) {
        const Crossings crossings(r);
        Mesh mesh;
        std::map<std::int32_t, std::int32_t> number;
        for (const Row& row : triangles) {
            Triangle own;
            for (std::size_t k = 0; k < 3; ++k) {
                const auto next = static_cast<std::int32_t>(mesh.vertices.size());
                const auto [at, is_new] = number.emplace(row[k], next);
                if (is_new) mesh.vertices.push_back(crossings.vertex(row[k]));
                own[k] = at->second;
            }
            mesh.triangles.push_back(own);
        }
        return mesh;
    }

    void look_again(const Refinement& r) {
        if (r.triangles.empty()) return;
        Flat all{r.vertices, {}};
        for (const Row& t : r.triangles)
            all.triangles.insert(all.triangles.end(), t.begin(), t.end());
        const Refinement again = booleans::intersect(all.view(), all.view(), {1});
        if (again.triangles.size() != 2 * r.triangles.size() ||
            again.vertices.size() != r.vertices.size())
            add("again", "intersected with itself the refinement is divided");
    }

    std::array<Mesh, 2> inputs_;
    RandomSource random_;
    Point low_{HUGE_VAL, HUGE_VAL, HUGE_VAL}, high_{-HUGE_VAL, -HUGE_VAL, -HUGE_VAL};
    double largest_ = 0;
    std::vector<Defect> defects_;
    std::optional<Mesh> result_;  ///< of one of the operations
};

}  // namespace

std::vector<Defect> boolean_defects(const StackCase& pair, std::uint64_t seed) {
    Judge judge(pair, seed);
    std::vector<Defect> defects = judge.run();
    if (!defects.empty()) return defects;
    // results are inputs of the next operation
    if (const auto again = judge.result_with_operand()) {
        defects = Judge(*again, seed).run();
        for (Defect& defect : defects)
            defect.sentence = "a result with an operand: " + defect.sentence;
    }
    return defects;
}

}  // namespace realmodel::fuzz
