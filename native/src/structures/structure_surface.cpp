// SPDX-License-Identifier: GPL-3.0-or-later
// Faults and bodies as one surface that cuts.
#include "structures/structure_surface.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <span>

#include "cutting/nearest_side.hpp"
#include "realmodel/base/errors.hpp"

namespace realmodel::structures {

using cutting::CutterSurface;
using cutting::dot;
using cutting::minus;
using cutting::NodeId;
using cutting::Position;
using cutting::unordered;
using spatial::Box;

namespace {

Position unit(const Position& p) {
    const double size = std::sqrt(dot(p, p));
    return size > 0 ? Position{p[0] / size, p[1] / size, p[2] / size} : Position{0, 0, 0};
}

Position sum(const Position& a, const Position& b) {
    return {a[0] + b[0], a[1] + b[1], a[2] + b[2]};
}

Position beyond(const Position& p, const Position& direction, double length) {
    return {p[0] + length * direction[0], p[1] + length * direction[1],
            p[2] + length * direction[2]};
}

/// An edge of one triangle, as that triangle runs.
struct BorderEdge {
    NodeId from, to, corner;
};

std::vector<BorderEdge> border_of(const CutterSurface& surface) {
    std::map<std::array<NodeId, 2>, std::pair<int, BorderEdge>> users;
    for (const auto& t : surface.triangles) {
        for (std::size_t i = 0; i < 3; ++i) {
            auto& [count, edge] = users[unordered(t[i], t[(i + 1) % 3])];
            ++count;
            edge = {t[i], t[(i + 1) % 3], t[(i + 2) % 3]};
        }
    }
    std::vector<BorderEdge> border;
    for (const auto& [key, use] : users) {
        if (use.first % 2 == 1) border.push_back(use.second);
    }
    return border;
}

Position cross(const Position& a, const Position& b) {
    return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}

/// The edges of a border one after another where it is one ring; nothing where it is not.
std::vector<BorderEdge> ring_of(std::span<const BorderEdge> border) {
    std::map<NodeId, const BorderEdge*> leaving;
    for (const BorderEdge& edge : border)
        leaving[edge.from] = &edge;
    std::vector<BorderEdge> ring;
    if (border.empty() || leaving.size() != border.size()) return ring;
    for (const BorderEdge* edge = &border[0]; edge != nullptr && ring.size() < border.size();) {
        ring.push_back(*edge);
        const auto next = leaving.find(edge->to);
        edge = next == leaving.end() ? nullptr : next->second;
        if (edge == &border[0]) break;
    }
    if (ring.size() != border.size() || ring.back().to != ring.front().from) ring.clear();
    return ring;
}

/// How much rather an edge counts to the upper or the lower border than to a side: at 65 degrees
/// from the strike either is as good.
constexpr double kSide = 0.5;

/// Of each edge of a ring one of four classes that follow one another round it once, at the least
/// cost.
std::vector<std::size_t> least_turns(std::span<const std::array<double, 4>> cost) {
    const std::size_t count = cost.size();
    std::vector<std::size_t> best;
    double least = HUGE_VAL;
    for (std::size_t start = 0; start < 4; ++start) {
        // after each edge: what it costs when the class has changed so often, and whether it just
        // did
        std::array<double, 5> total{0, HUGE_VAL, HUGE_VAL, HUGE_VAL, HUGE_VAL};
        std::vector<std::array<std::uint8_t, 5>> changed(count);
        for (std::size_t i = 0; i < count; ++i) {
            std::array<double, 5> next{};
            for (std::size_t c = 0; c < 5; ++c) {
                changed[i][c] = c > 0 && total[c - 1] < total[c] ? 1 : 0;
                next[c] = total[c - changed[i][c]] + cost[i][(start + c) % 4];
            }
            total = next;
        }
        if (!(total[4] < least)) continue;
        least = total[4];
        best.assign(count, 0);
        std::size_t c = 4;
        for (std::size_t i = count; i-- > 0;) {
            best[i] = (start + c) % 4;
            c -= changed[i][c];
        }
    }
    if (best.empty()) best.assign(count, 0);
    return best;
}

/// Where a fault that dies out goes on from each edge of its border: up and down the dip, and along
/// the strike, of its mean plane, so that what is continued does not cross itself however the fault
/// bends. Its border is one ring, which four corners divide; where it is not, nothing.
std::map<NodeId, Position> ways_in_mean_plane(const CutterSurface& fault,
                                              std::span<const BorderEdge> border) {
    std::map<NodeId, Position> ways;
    const std::vector<BorderEdge> ring = ring_of(border);
    Position normal{0, 0, 0};
    for (const auto& t : fault.triangles) {
        const Position own = cross(minus(fault.vertices[index(t[1])], fault.vertices[index(t[0])]),
                                   minus(fault.vertices[index(t[2])], fault.vertices[index(t[0])]));
        normal = sum(normal, own);
    }
    normal = unit(normal);
    if (ring.empty() || dot(normal, normal) == 0) return ways;
    Position strike = unit({-normal[1], normal[0], 0});
    if (std::hypot(normal[0], normal[1]) < 1e-6) strike = unit(cross({0, 1, 0}, normal));
    const Position dip = cross(normal, strike);  // upward
    const auto opposite = [](const Position& p) { return Position{-p[0], -p[1], -p[2]}; };
    // as the ring runs: the lower border, then the sides between it and the upper one
    const std::array<Position, 4> way{opposite(dip), strike, dip, opposite(strike)};
    std::vector<std::array<double, 4>> cost;
    for (const BorderEdge& edge : ring) {
        const Position along =
            minus(fault.vertices[index(edge.to)], fault.vertices[index(edge.from)]);
        const Position away = unit(cross(along, normal));
        const double length = std::sqrt(dot(along, along));
        auto& own = cost.emplace_back();
        for (std::size_t c = 0; c < 4; ++c)
            own[c] = length * (1 - dot(away, way[c]) + (c % 2 == 1 ? kSide : 0));
    }
    const std::vector<std::size_t> turn = least_turns(cost);
    for (std::size_t i = 0; i < ring.size(); ++i)
        ways[ring[i].from] = way[turn[i]];
    return ways;
}

/// Continues one fault beyond its border. What is nearest reaches out of the rock; what follows
/// goes on until no triangle of any structure that is in the rock, or of what is nearest, goes
/// farther: where they cross, they cross all through.
class Continuation {
public:
    /// @param in_its_plane  of vertices: edges between such ones are continued so
    /// @param size  of a box around the rock and all structures
    Continuation(const CutterSurface& fault, std::vector<std::uint8_t> in_its_plane, double size)
        : fault_(fault), in_its_plane_(std::move(in_its_plane)), lengths_{1.25 * size, 8 * size} {}

    std::vector<std::array<Position, 3>> triangles() {
        std::map<NodeId, std::vector<std::pair<NodeId, Position>>> arriving, leaving;
        const std::vector<BorderEdge> border = border_of(fault_);
        std::map<NodeId, Position> ways;
        if (std::ranges::find(in_its_plane_, 0) == in_its_plane_.end())
            ways = ways_in_mean_plane(fault_, border);
        for (const BorderEdge& edge : border) {
            const auto known = ways.find(edge.from);
            const Position way = known == ways.end() ? direction(edge) : known->second;
            Position a = at(edge.from), b = at(edge.to);
            for (const double length : lengths_) {
                const Position far_a = beyond(at(edge.from), way, length);
                const Position far_b = beyond(at(edge.to), way, length);
                triangles_.push_back({b, a, far_a});
                triangles_.push_back({b, far_a, far_b});
                a = far_a;
                b = far_b;
            }
            arriving[edge.to].push_back({edge.from, way});
            leaving[edge.from].push_back({edge.to, way});
        }
        for (const auto& [v, ins] : arriving) {
            const auto& outs = leaving[v];
            for (std::size_t i = 0; i < std::min(ins.size(), outs.size()); ++i) {
                // both edges run back from v: their middle points away from the surface
                const Position away = sum(unit(minus(at(v), at(ins[i].first))),
                                          unit(minus(at(v), at(outs[i].first))));
                add_fan(at(v), ins[i].second, outs[i].second, away, 0);
            }
        }
        return std::move(triangles_);
    }

private:
    Position at(NodeId v) const { return fault_.vertices[index(v)]; }

    Position direction(const BorderEdge& edge) const {
        const Position along = minus(at(edge.to), at(edge.from));
        const Position inward = minus(at(edge.corner), at(edge.from));
        const double share = dot(inward, along) / dot(along, along);
        Position away;
        for (std::size_t k = 0; k < 3; ++k)
            away[k] = share * along[k] - inward[k];
        away = unit(away);
        if (in_its_plane_[index(edge.from)] != 0 && in_its_plane_[index(edge.to)] != 0) return away;
        if (std::abs(away[2]) < 0.5) return away;
        return {0, 0, away[2] > 0 ? 1.0 : -1.0};
    }

    /// What lies between two neighboring edges' continuations, from that of the edge that arrives
    /// to that of the one that leaves, so narrow that its far side is far away.
    void add_fan(const Position& p, const Position& from, const Position& to, const Position& away,
                 int depth) {
        if (from == to) return;
        if (depth < 4 && dot(from, to) < 0.5) {
            Position middle = sum(from, to);
            if (dot(middle, middle) < 0.1) middle = away;
            middle = unit(middle);
            if (dot(middle, middle) > 0) {
                add_fan(p, from, middle, away, depth + 1);
                add_fan(p, middle, to, away, depth + 1);
                return;
            }
        }
        const Position a = beyond(p, from, lengths_[0]), b = beyond(p, to, lengths_[0]);
        const Position far_a = beyond(p, from, lengths_[1]), far_b = beyond(p, to, lengths_[1]);
        triangles_.push_back({p, a, b});
        triangles_.push_back({b, a, far_a});
        triangles_.push_back({b, far_a, far_b});
    }

    const CutterSurface& fault_;
    std::vector<std::uint8_t> in_its_plane_;
    std::array<double, 2> lengths_;
    std::vector<std::array<Position, 3>> triangles_;
};

/// Whether a part of a segment is in a box.
bool passes(const Box& box, const Position& from, const Position& to) {
    double begin = 0, end = 1;
    for (std::size_t k = 0; k < 3; ++k) {
        const double step = to[k] - from[k];
        if (step == 0) {
            if (from[k] < box.low[k] || from[k] > box.high[k]) return false;
            continue;
        }
        const double low = (box.low[k] - from[k]) / step, high = (box.high[k] - from[k]) / step;
        begin = std::max(begin, std::min(low, high));
        end = std::min(end, std::max(low, high));
    }
    return begin <= end;
}

/// Whether a part of a triangle is in a box: what its six planes leave of the triangle.
bool passes(const Box& box, const std::array<Position, 3>& triangle) {
    std::vector<Position> left(triangle.begin(), triangle.end());
    for (std::size_t plane = 0; plane < 6 && !left.empty(); ++plane) {
        const std::size_t k = plane / 2;
        const auto inward = [&](const Position& p) {
            return plane % 2 == 0 ? p[k] - box.low[k] : box.high[k] - p[k];
        };
        std::vector<Position> kept;
        for (std::size_t i = 0; i < left.size(); ++i) {
            const Position &a = left[i], &b = left[(i + 1) % left.size()];
            const double at_a = inward(a), at_b = inward(b);
            if (at_a >= 0) kept.push_back(a);
            if ((at_a < 0) != (at_b < 0)) {
                const double share = at_a / (at_a - at_b);
                kept.push_back(beyond(a, minus(b, a), share));
            }
        }
        left = std::move(kept);
    }
    return !left.empty();
}

/// Whether a fault divides some rock by itself: it passes it, and its border is away from it.
bool divides(const CutterSurface& fault, const Box& rock) {
    const Position extent = minus(rock.high, rock.low);
    Box near = rock;
    near.widen(1e-6 * std::sqrt(dot(extent, extent)));
    const auto at = [&fault](NodeId v) { return fault.vertices[index(v)]; };
    return std::ranges::none_of(
               border_of(fault),
               [&](const BorderEdge& edge) { return passes(near, at(edge.from), at(edge.to)); }) &&
           std::ranges::any_of(fault.triangles, [&](const auto& t) {
               return passes(rock, std::array{at(t[0]), at(t[1]), at(t[2])});
           });
}

/// Of the vertices of a fault: whether its continuation there must go on in its plane. Where it
/// dies out that is so everywhere, and beyond a fault that it ends at: straight up or down it might
/// come back through that.
std::vector<std::uint8_t> in_its_plane(const Structure& structure,
                                       std::span<const CutterSurface> given,
                                       const CutterSurface& own) {
    std::vector<std::uint8_t> found(own.vertices.size(), structure.dies_out ? 1 : 0);
    if (structure.dies_out) return found;
    for (const std::int32_t other : structure.ends_at) {
        const cutting::NearestSide nearest(given[index(other)]);
        double above = 0;
        for (const auto& t : own.triangles) {
            const std::array corners{own.vertices[index(t[0])], own.vertices[index(t[1])],
                                     own.vertices[index(t[2])]};
            const Position normal = cutting::polygon_normal(corners);
            Position middle{0, 0, 0};
            for (std::size_t k = 0; k < 3; ++k)
                middle[k] = (corners[0][k] + corners[1][k] + corners[2][k]) / 3;
            above += nearest(middle) * std::sqrt(dot(normal, normal));
        }
        for (std::size_t v = 0; v < found.size(); ++v) {
            if (nearest(own.vertices[v]) * above < 0) found[v] = 1;
        }
    }
    return found;
}

}  // namespace

CutterSurface checked_surface(const Structure& structure, std::int32_t number) {
    try {
        CutterSurface surface = cutting::oriented_surface(structure.surface, false);
        if (structure.is_body && !surface.is_closed) {
            const auto border = border_of(surface);
            const Position place = surface.vertices[border.empty() ? 0 : index(border[0].from)];
            throw InputError("not_closed", "the body is not closed: its surface ends at an edge",
                             -1, {}, place);
        }
        if (!structure.is_body && surface.is_closed)
            throw InputError("is_closed", "the fault is a closed surface: it has no border");
        return surface;
    } catch (InputError& error) {
        error.surface = number;
        throw;
    }
}

StructureSurface structure_surface(std::span<const Structure> structures, const Box& rock,
                                   bool continues_all) {
    std::vector<CutterSurface> given;
    Box whole = rock;
    for (std::int32_t s = 0; index(s) < structures.size(); ++s) {
        given.push_back(checked_surface(structures[index(s)], s));
        for (const Position& p : given.back().vertices)
            whole.include(p);
    }
    const Position extent = minus(whole.high, whole.low);
    const double size = std::sqrt(dot(extent, extent));
    StructureSurface all;
    std::map<Position, NodeId> number;
    const auto node = [&](const Position& p) {
        const auto [found, is_new] =
            number.try_emplace(p, static_cast<NodeId>(all.surface.vertices.size()));
        if (is_new) all.surface.vertices.push_back(p);
        return found->second;
    };
    for (std::int32_t s = 0; index(s) < structures.size(); ++s) {
        const CutterSurface& own = given[index(s)];
        const auto add = [&](const std::array<Position, 3>& corners, bool is_continuation) {
            const std::array<NodeId, 3> t{node(corners[0]), node(corners[1]), node(corners[2])};
            if (t[0] == t[1] || t[1] == t[2] || t[2] == t[0]) return;
            all.surface.triangles.push_back(t);
            all.structure.push_back(s);
            all.is_continuation.push_back(is_continuation ? 1 : 0);
        };
        const std::size_t first = all.surface.triangles.size();
        for (const auto& t : own.triangles)
            add({own.vertices[index(t[0])], own.vertices[index(t[1])], own.vertices[index(t[2])]},
                false);
        if (!structures[index(s)].is_body && (continues_all || !divides(own, rock))) {
            for (const auto& t :
                 Continuation(own, in_its_plane(structures[index(s)], given, own), size)
                     .triangles())
                add(t, true);
        }
        CutterSurface& single = all.single.emplace_back();
        single.is_closed = own.is_closed;
        for (std::size_t t = first; t < all.surface.triangles.size(); ++t) {
            std::array<NodeId, 3> corners{};
            for (std::size_t i = 0; i < 3; ++i) {
                corners[i] = static_cast<NodeId>(single.vertices.size());
                single.vertices.push_back(all.surface.vertices[index(all.surface.triangles[t][i])]);
            }
            single.triangles.push_back(corners);
        }
    }
    return all;
}

}  // namespace realmodel::structures
