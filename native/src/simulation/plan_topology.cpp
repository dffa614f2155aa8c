// SPDX-License-Identifier: GPL-3.0-or-later
#include "simulation/plan_topology.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <unordered_map>

#include "base/counting_sort.hpp"
#include "base/disjoint_sets.hpp"
#include "base/index.hpp"
#include "exact/orient2d.hpp"
#include "realmodel/base/elementary.hpp"
#include "realmodel/base/errors.hpp"

namespace realmodel::simulation {

namespace {

constexpr double kLeastAngle = 20.0 * std::numbers::pi / 180;
constexpr double kSharpAngle = 25.0 * std::numbers::pi / 180;  ///< made better, if it can be
constexpr int kImprovements = 12;
constexpr double kStep =
    0.05;  ///< of an edge: how far nodes are moved where their middle is no better

double least_angle(const PlanPoint& a, const PlanPoint& b, const PlanPoint& c) {
    double least = std::numbers::pi;
    const std::array<const PlanPoint*, 3> p{&a, &b, &c};
    for (std::size_t i = 0; i < 3; ++i) {
        const PlanPoint &o = *p[i], &u = *p[(i + 1) % 3], &v = *p[(i + 2) % 3];
        const double ux = u[0] - o[0], uy = u[1] - o[1], vx = v[0] - o[0], vy = v[1] - o[1];
        least = std::min(least, elementary::atan2(std::abs(ux * vy - uy * vx), ux * vx + uy * vy));
    }
    return least;
}

using Edge = std::array<std::int32_t, 2>;
Edge edge_of(std::int32_t a, std::int32_t b) {
    return {std::min(a, b), std::max(a, b)};
}

}  // namespace

PlanTopology::PlanTopology(const PlanLines& lines, meshing::PlanarMesh mesh)
    : lines_(lines), mesh_(std::move(mesh)) {
    link();
    if (turn_border_triangles()) link();
    mark_segments();
    find_posts();
    if (divide_between_steps()) refresh();
    improve();
    spread_rocks();
}

bool PlanTopology::is_step(std::size_t t, std::size_t edge) const {
    return segment_[t][edge] >= 0 && lines_.segments[index(segment_[t][edge])].is_step;
}

void PlanTopology::link() {
    struct Side {
        std::int32_t to, corner;
    };
    const auto sides = bucketize<Side>(nodes(), [&](const auto& put) {
        for (std::size_t c = 0; c < 3 * triangles(); ++c) {
            const std::int32_t a = node(c), b = mesh_.triangles[c / 3][(c % 3 + 1) % 3];
            put(index(std::min(a, b)), Side{std::max(a, b), static_cast<std::int32_t>(c)});
        }
    });
    neighbor_.assign(triangles(), {-1, -1, -1});
    for (std::size_t n = 0; n < sides.size(); ++n) {
        const auto own = sides[n];
        for (std::size_t i = 0; i < own.size(); ++i) {
            for (std::size_t j = i + 1; j < own.size(); ++j) {
                if (own[i].to != own[j].to) continue;
                const auto a = index(own[i].corner), b = index(own[j].corner);
                neighbor_[a / 3][a % 3] = static_cast<std::int32_t>(b / 3);
                neighbor_[b / 3][b % 3] = static_cast<std::int32_t>(a / 3);
            }
        }
    }
}

bool PlanTopology::turn_border_triangles() {
    std::vector<std::size_t> corners;
    for (std::size_t t = 0; t < triangles(); ++t) {
        if (std::count(neighbor_[t].begin(), neighbor_[t].end(), -1) == 2) corners.push_back(t);
    }
    if (corners.empty()) return false;
    mark_segments();
    std::vector<std::uint8_t> turned(triangles(), 0);
    const auto at = [&](std::int32_t n) -> const PlanPoint& { return mesh_.vertices[index(n)]; };
    const auto turn = [&](std::size_t t) {
        const auto i = static_cast<std::size_t>(
            std::max_element(neighbor_[t].begin(), neighbor_[t].end()) - neighbor_[t].begin());
        const auto other = index(neighbor_[t][i]);
        auto &own = mesh_.triangles[t], &beyond = mesh_.triangles[other];
        const std::int32_t a = own[i], b = own[(i + 1) % 3], apex = own[(i + 2) % 3],
                           far = corner_across(other, a, b);
        if (turned[other] != 0 || segment_[t][i] >= 0 ||
            std::count(neighbor_[other].begin(), neighbor_[other].end(), -1) > 1 ||
            exact::orient2d(at(apex), at(a), at(far)) <= 0 ||
            exact::orient2d(at(apex), at(far), at(b)) <= 0 ||
            std::min(least_angle(at(apex), at(a), at(far)), least_angle(at(apex), at(far), at(b))) <
                kLeastAngle)
            return false;
        own = {apex, a, far};
        beyond = {apex, far, b};
        turned[other] = 1;
        return true;
    };
    for (const std::size_t t : corners) {
        if (turned[t] != 0 || turn(t)) continue;
        const auto own = mesh_.triangles[t];
        const auto n = static_cast<std::int32_t>(nodes());
        PlanPoint center{};
        for (const std::int32_t corner : own) {
            for (std::size_t axis = 0; axis < 2; ++axis)
                center[axis] += at(corner)[axis] / 3;
        }
        mesh_.vertices.push_back(center);
        mesh_.triangles[t] = {own[0], own[1], n};
        mesh_.triangles.push_back({own[1], own[2], n});
        mesh_.triangles.push_back({own[2], own[0], n});
        turned[t] = 1;
    }
    return true;
}

void PlanTopology::improve() {
    turn_and_move();
    const auto sharp = [&] {
        return std::count_if(mesh_.triangles.begin(), mesh_.triangles.end(), [&](const auto& own) {
            return least_angle(mesh_.vertices[index(own[0])], mesh_.vertices[index(own[1])],
                               mesh_.vertices[index(own[2])]) < kLeastAngle;
        });
    };
    const auto before = sharp();
    if (before == 0) return;
    const meshing::PlanarMesh mesh = mesh_;
    if (!divide_lines()) return;
    refresh();
    turn_and_move();
    if (sharp() < before) return;
    mesh_ = mesh;
    refresh();
}

void PlanTopology::refresh() {
    link();
    mark_segments();
    find_posts();
}

/// Divides edges on lines and at the border that lie across from an obtuse angle beside one that is
/// too sharp.
bool PlanTopology::divide_lines() {
    const auto at = [&](std::int32_t n) -> const PlanPoint& { return mesh_.vertices[index(n)]; };
    std::vector<std::uint8_t> is_used(triangles(), 0);
    bool any = false;
    for (std::size_t t = 0, count = triangles(); t < count; ++t) {
        const auto own = mesh_.triangles[t];
        if (is_used[t] != 0 || least_angle(at(own[0]), at(own[1]), at(own[2])) >= kLeastAngle)
            continue;
        std::size_t i = 0;
        double longest = 0;
        for (std::size_t k = 0; k < 3; ++k) {
            const PlanPoint &p = at(own[k]), &q = at(own[(k + 1) % 3]);
            const double length = elementary::hypot(q[0] - p[0], q[1] - p[1]);
            if (length > longest) i = k;
            longest = std::max(longest, length);
        }
        const std::int32_t n = neighbor_[t][i], a = own[i], b = own[(i + 1) % 3];
        if ((segment_[t][i] < 0 && n >= 0) || (n >= 0 && is_used[index(n)] != 0)) continue;
        const std::int32_t apex = own[(i + 2) % 3],
                           far = n < 0 ? -1 : corner_across(index(n), a, b);
        // on a step the middle is divided, so it may have no edge to another such node
        if (n >= 0 && is_step(t, i) && (is_divided(apex) || is_divided(far))) continue;
        const auto middle = static_cast<std::int32_t>(nodes());
        const PlanPoint p = at(a), q = at(b);
        mesh_.vertices.push_back({(p[0] + q[0]) / 2, (p[1] + q[1]) / 2});
        mesh_.triangles[t] = {apex, a, middle};
        mesh_.triangles.push_back({apex, middle, b});
        is_used[t] = 1;
        if (n >= 0) {
            mesh_.triangles[index(n)] = {far, b, middle};
            mesh_.triangles.push_back({far, middle, a});
            is_used[index(n)] = 1;
        }
        any = true;
    }
    return any;
}

void PlanTopology::turn_and_move() {
    for (int round = 0; round < kImprovements; ++round) {
        const bool turned = turn_edges();
        if (turned) refresh();
        if (!move_nodes() && !turned) break;
    }
}

/// Nodes that are neither on lines nor at the border.
std::vector<std::uint8_t> PlanTopology::free_nodes() const {
    std::vector<std::uint8_t> is_free(nodes(), 1);
    for (std::size_t t = 0; t < triangles(); ++t) {
        for (std::size_t i = 0; i < 3; ++i) {
            if (segment_[t][i] < 0 && neighbor_[t][i] >= 0) continue;
            is_free[index(mesh_.triangles[t][i])] = 0;
            is_free[index(mesh_.triangles[t][(i + 1) % 3])] = 0;
        }
    }
    return is_free;
}

/// Turns the edge between two triangles, where that makes the least of their angles larger.
bool PlanTopology::turn_edges() {
    const auto at = [&](std::int32_t n) -> const PlanPoint& { return mesh_.vertices[index(n)]; };
    std::vector<std::uint8_t> turned(triangles(), 0);
    bool any = false;
    for (std::size_t t = 0; t < triangles(); ++t) {
        const auto own = mesh_.triangles[t];
        const double before = least_angle(at(own[0]), at(own[1]), at(own[2]));
        if (turned[t] != 0 || before > kSharpAngle) continue;
        std::size_t best = 3;
        double largest = 1.01 * before;
        for (std::size_t i = 0; i < 3; ++i) {
            const std::int32_t n = neighbor_[t][i];
            if (n < 0 || segment_[t][i] >= 0 || turned[index(n)] != 0) continue;
            const std::int32_t a = own[i], b = own[(i + 1) % 3], apex = own[(i + 2) % 3],
                               far = corner_across(index(n), a, b);
            if (is_divided(apex) && is_divided(far)) continue;
            // neither may get two edges at the border, which turn_border_triangles() has seen to
            if (exact::orient2d(at(apex), at(a), at(far)) <= 0 ||
                exact::orient2d(at(apex), at(far), at(b)) <= 0)
                continue;
            const double after = std::min(least_angle(at(apex), at(a), at(far)),
                                          least_angle(at(apex), at(far), at(b)));
            if (after <= largest || has_border_corner(t, index(n), i)) continue;
            largest = after;
            best = i;
        }
        if (best == 3) continue;
        const auto n = index(neighbor_[t][best]);
        const std::int32_t a = own[best], b = own[(best + 1) % 3], apex = own[(best + 2) % 3],
                           far = corner_across(n, a, b);
        mesh_.triangles[t] = {apex, a, far};
        mesh_.triangles[n] = {apex, far, b};
        turned[t] = turned[n] = 1;
        any = true;
    }
    return any;
}

std::int32_t PlanTopology::corner_across(std::size_t t, std::int32_t a, std::int32_t b) const {
    for (const std::int32_t c : mesh_.triangles[t]) {
        if (c != a && c != b) return c;
    }
    return -1;
}

/// Whether turning edge i between two triangles would leave one with two edges outside.
bool PlanTopology::has_border_corner(std::size_t t, std::size_t n, std::size_t i) const {
    const std::int32_t a = mesh_.triangles[t][i];
    std::size_t j = 0;
    while (mesh_.triangles[n][j] != a)
        ++j;  // the edge of n from a leads to the corner across, the one before it comes from b
    const bool at_a = neighbor_[t][(i + 2) % 3] < 0 && neighbor_[n][j] < 0,
               at_b = neighbor_[t][(i + 1) % 3] < 0 && neighbor_[n][(j + 1) % 3] < 0;
    return at_a || at_b;
}

/// Moves nodes at sharp angles to the middle of their neighbors, or part of the way, where that
/// makes the least angle around them larger.
bool PlanTopology::move_nodes() {
    const auto at = [&](std::int32_t n) -> PlanPoint& { return mesh_.vertices[index(n)]; };
    std::vector<std::uint8_t> wanted(nodes(), 0);
    bool any = false;
    for (const auto& t : mesh_.triangles) {
        if (least_angle(at(t[0]), at(t[1]), at(t[2])) > kSharpAngle) continue;
        for (const std::int32_t n : t)
            wanted[index(n)] = 1;
        any = true;
    }
    if (!any) return false;
    const std::vector<std::uint8_t> is_free = free_nodes();
    for (std::size_t n = 0; n < nodes(); ++n)
        wanted[n] &= is_free[n];
    const auto around = bucketize<std::int32_t>(nodes(), [&](const auto& put) {
        for (std::size_t c = 0; c < 3 * triangles(); ++c) {
            if (wanted[index(node(c))] != 0) put(index(node(c)), static_cast<std::int32_t>(c / 3));
        }
    });
    bool moved = false;
    for (std::size_t n = 0; n < nodes(); ++n) {
        if (around[n].empty()) continue;
        PlanPoint middle{};
        for (const std::int32_t t : around[n]) {
            for (const std::int32_t corner : mesh_.triangles[index(t)]) {
                if (index(corner) == n) continue;
                for (std::size_t axis = 0; axis < 2; ++axis)
                    middle[axis] +=
                        at(corner)[axis] / (2.0 * static_cast<double>(around[n].size()));
            }
        }
        const auto least_around = [&] {
            double least = std::numbers::pi;
            for (const std::int32_t t : around[n]) {
                const auto& own = mesh_.triangles[index(t)];
                if (exact::orient2d(at(own[0]), at(own[1]), at(own[2])) <= 0) return 0.0;
                least = std::min(least, least_angle(at(own[0]), at(own[1]), at(own[2])));
            }
            return least;
        };
        const PlanPoint start = mesh_.vertices[n];
        PlanPoint best = start;
        double largest = 1.01 * least_around();
        const auto try_at = [&](double x, double y) {
            mesh_.vertices[n] = {x, y};
            const double own = least_around();
            if (own <= largest) return;
            largest = own;
            best = {x, y};
        };
        for (const double share : {1.0, 0.5, 0.25})
            try_at(start[0] + share * (middle[0] - start[0]),
                   start[1] + share * (middle[1] - start[1]));
        const std::int32_t any_corner = mesh_.triangles[index(around[n][0])][0],
                           other = mesh_.triangles[index(around[n][0])][1];
        const double step = kStep * elementary::hypot(at(any_corner)[0] - at(other)[0],
                                                      at(any_corner)[1] - at(other)[1]);
        if (best == start) {
            for (const double x : {-step, 0.0, step}) {
                for (const double y : {-step, 0.0, step})
                    try_at(start[0] + x, start[1] + y);
            }
        }
        mesh_.vertices[n] = best;
        moved = moved || best != start;
    }
    return moved;
}

void PlanTopology::mark_segments() {
    segment_.assign(triangles(), {-1, -1, -1});
    const auto around = bucketize<std::int32_t>(nodes(), [&](const auto& put) {
        for (std::size_t c = 0; c < 3 * triangles(); ++c)
            put(index(node(c)), static_cast<std::int32_t>(c));
    });
    std::map<PlanPoint, std::int32_t> node_at;
    {
        std::vector<PlanPoint> wanted(lines_.points);
        std::sort(wanted.begin(), wanted.end());
        for (std::size_t n = 0; n < nodes(); ++n) {
            if (std::binary_search(wanted.begin(), wanted.end(), mesh_.vertices[n]))
                node_at.emplace(mesh_.vertices[n], static_cast<std::int32_t>(n));
        }
    }
    for (std::size_t s = 0; s < lines_.segments.size(); ++s) {
        const PlanPoint &from = lines_.points[index(lines_.segments[s].from)],
                        &to = lines_.points[index(lines_.segments[s].to)];
        const auto begin = node_at.find(from), end = node_at.find(to);
        if (begin == node_at.end() || end == node_at.end()) {
            throw InputError("bad_index", "the planar mesh lacks an end of a line", -1,
                             {static_cast<std::int64_t>(s)},
                             std::array<double, 3>{from[0], from[1], 0});
        }
        const double dx = to[0] - from[0], dy = to[1] - from[1], length = elementary::hypot(dx, dy);
        std::int32_t here = begin->second;
        for (std::size_t steps = 0; here != end->second && steps < nodes(); ++steps) {
            // the edge that leads on along the line
            std::int32_t next = -1;
            double nearest = 1e-6 * length;
            std::array<std::array<std::size_t, 2>, 2> found{};
            std::size_t sides = 0;
            for (const std::int32_t c : around[index(here)]) {
                const auto t = index(c) / 3, i = index(c) % 3;
                for (const std::size_t e : {i, (i + 2) % 3}) {
                    const std::int32_t other = mesh_.triangles[t][e == i ? (i + 1) % 3 : e];
                    const PlanPoint& q = mesh_.vertices[index(other)];
                    const PlanPoint& p = mesh_.vertices[index(here)];
                    if ((q[0] - p[0]) * dx + (q[1] - p[1]) * dy <= 0) continue;
                    const double off =
                        std::abs((q[0] - from[0]) * dy - (q[1] - from[1]) * dx) / length;
                    if (other == next) {
                        if (sides < 2) found[sides++] = {t, e};
                    } else if (off < nearest) {
                        nearest = off;
                        next = other;
                        found[0] = {t, e};
                        sides = 1;
                    }
                }
            }
            if (next < 0) break;  // a part that the mesher left out
            for (std::size_t i = 0; i < sides; ++i)
                segment_[found[i][0]][found[i][1]] = static_cast<std::int32_t>(s);
            here = next;
        }
    }
}

void PlanTopology::find_posts() {
    DisjointSets sets(3 * triangles());
    for (std::size_t t = 0; t < triangles(); ++t) {
        for (std::size_t i = 0; i < 3; ++i) {
            const std::int32_t n = neighbor_[t][i];
            if (n < 0 || is_step(t, i)) continue;
            for (const std::size_t k : {i, (i + 1) % 3}) {
                for (std::size_t j = 0; j < 3; ++j) {
                    if (mesh_.triangles[index(n)][j] == mesh_.triangles[t][k])
                        sets.join(static_cast<std::int32_t>(3 * t + k),
                                  3 * n + static_cast<std::int32_t>(j));
                }
            }
        }
    }
    std::vector<std::uint8_t> has_post(nodes(), 0);
    post_.assign(3 * triangles(), -1);
    post_node_.clear();
    is_divided_.assign(nodes(), 0);
    for (std::size_t t = 0; t < triangles(); ++t) {
        for (std::size_t i = 0; i < 3; ++i) {
            if (neighbor_[t][i] >= 0 && is_step(t, i)) {
                is_divided_[index(mesh_.triangles[t][i])] = 1;
                is_divided_[index(mesh_.triangles[t][(i + 1) % 3])] = 1;
            }
        }
    }
    for (std::size_t c = 0; c < 3 * triangles(); ++c) {
        const auto root = index(sets.find(static_cast<std::int32_t>(c)));
        if (root == c) {
            post_[c] = static_cast<std::int32_t>(post_node_.size());
            post_node_.push_back(node(c));
            std::uint8_t& seen = has_post[index(node(c))];
            if (seen != 0) is_divided_[index(node(c))] = 1;
            seen = 1;
        } else {
            post_[c] = post_[root];
        }
    }
}

bool PlanTopology::divide_between_steps() {
    std::map<Edge, std::int32_t> middles;
    std::vector<std::array<std::int32_t, 3>> made;
    std::vector<std::uint8_t> is_closed(triangles(), 0);
    bool any = false;
    for (std::size_t t = 0; t < triangles(); ++t) {
        is_closed[t] = 1;
        for (std::size_t i = 0; i < 3; ++i) {
            if (neighbor_[t][i] < 0 || !is_step(t, i)) is_closed[t] = 0;
        }
        any = any || is_closed[t] != 0;
        for (std::size_t i = 0; i < 3; ++i) {
            const std::int32_t a = mesh_.triangles[t][i], b = mesh_.triangles[t][(i + 1) % 3];
            if ((is_step(t, i) && neighbor_[t][i] >= 0) || !is_divided(a) || !is_divided(b))
                continue;
            if (middles.contains(edge_of(a, b))) continue;
            const PlanPoint p = mesh_.vertices[index(a)], q = mesh_.vertices[index(b)];
            middles[edge_of(a, b)] = static_cast<std::int32_t>(nodes());
            mesh_.vertices.push_back({(p[0] + q[0]) / 2, (p[1] + q[1]) / 2});
        }
    }
    if (middles.empty() && !any) return false;
    const std::size_t count = triangles();
    for (std::size_t t = 0; t < count; ++t) {
        const auto corner = mesh_.triangles[t];
        std::array<std::int32_t, 3> middle{-1, -1, -1};
        std::size_t divided = 0;
        for (std::size_t i = 0; i < 3; ++i) {
            const auto found = middles.find(edge_of(corner[i], corner[(i + 1) % 3]));
            if (found == middles.end()) continue;
            middle[i] = found->second;
            ++divided;
        }
        if (is_closed[t] != 0) {
            PlanPoint center{};
            for (const std::int32_t n : corner) {
                for (std::size_t axis = 0; axis < 2; ++axis)
                    center[axis] += mesh_.vertices[index(n)][axis] / 3;
            }
            const auto n = static_cast<std::int32_t>(nodes());
            mesh_.vertices.push_back(center);
            for (std::size_t i = 0; i < 3; ++i)
                made.push_back({corner[i], corner[(i + 1) % 3], n});
        } else if (divided == 0) {
            made.push_back(corner);
        } else if (divided == 3) {
            for (std::size_t i = 0; i < 3; ++i)
                made.push_back({corner[i], middle[i], middle[(i + 2) % 3]});
            made.push_back(middle);
        } else {
            std::size_t i = 0;  // the first divided edge, the one before it not
            while (middle[i] < 0 || middle[(i + 2) % 3] >= 0)
                ++i;
            const std::int32_t a = corner[i], b = corner[(i + 1) % 3], c = corner[(i + 2) % 3];
            if (divided == 1) {
                made.push_back({a, middle[i], c});
                made.push_back({middle[i], b, c});
            } else {
                const std::int32_t m = middle[i], n = middle[(i + 1) % 3];
                made.push_back({m, b, n});
                made.push_back({a, m, n});
                made.push_back({a, n, c});
            }
        }
    }
    mesh_.triangles = std::move(made);
    return true;
}

void PlanTopology::spread_rocks() {
    rock_.assign(triangles(), -1);
    std::vector<std::int32_t> waiting;
    for (std::size_t t = 0; t < triangles(); ++t) {
        for (std::size_t i = 0; i < 3; ++i) {
            if (segment_[t][i] < 0) continue;
            const PlanSegment& s = lines_.segments[index(segment_[t][i])];
            const PlanPoint &from = lines_.points[index(s.from)], &to = lines_.points[index(s.to)],
                            &a = mesh_.vertices[index(mesh_.triangles[t][i])],
                            &b = mesh_.vertices[index(mesh_.triangles[t][(i + 1) % 3])];
            const bool forward =
                (to[0] - from[0]) * (b[0] - a[0]) + (to[1] - from[1]) * (b[1] - a[1]) > 0;
            if (rock_[t] < 0) rock_[t] = forward ? s.left_rock : s.right_rock;
        }
        if (rock_[t] >= 0) waiting.push_back(static_cast<std::int32_t>(t));
    }
    while (!waiting.empty()) {
        const auto t = index(waiting.back());
        waiting.pop_back();
        for (std::size_t i = 0; i < 3; ++i) {
            const std::int32_t n = neighbor_[t][i];
            if (n < 0 || segment_[t][i] >= 0 || rock_[index(n)] >= 0) continue;
            rock_[index(n)] = rock_[t];
            waiting.push_back(n);
        }
    }
}

}  // namespace realmodel::simulation
