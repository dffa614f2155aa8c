// SPDX-License-Identifier: GPL-3.0-or-later
// Faults and bodies as one cutter, with what continues faults beyond their borders.
#include "structures/structure_cutter.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <map>

#include "base/disjoint_sets.hpp"
#include "base/key_table.hpp"
#include "cutting/nearest_side.hpp"
#include "exact/orientation.hpp"
#include "meshing/winding.hpp"
#include "realmodel/base/elementary.hpp"
#include "realmodel/base/errors.hpp"

namespace realmodel::structures {

using cutting::Cutter;
using cutting::CutterBorderEdge;
using cutting::NodeId;
using cutting::Position;
using meshing::PlanPoint;
using spatial::Box;

namespace {

/// The directions of a plane and a point of it.
struct PlaneFrame {
    Position origin, strike, dip;

    Position at(const PlanPoint& p) const {
        Position position{};
        for (std::size_t k = 0; k < 3; ++k)
            position[k] = origin[k] + p[0] * strike[k] + p[1] * dip[k];
        return position;
    }
    PlanPoint seen(const Position& p) const {
        const Position off = minus(p, origin);
        return {dot(off, strike), dot(off, dip)};
    }
};

/// The plane through the middle of a surface, by areas, at right angles to its mean normal.
std::optional<PlaneFrame> mean_plane(const cutting::Cutter& cutter) {
    const auto at = [&](NodeId v) { return cutter.vertices[index(v)]; };
    const Position first = at(cutter.triangles[0][0]);  // exact where the plane is that of an axis
    Position normal{0, 0, 0}, total{0, 0, 0};
    double whole = 0;
    for (const auto& t : cutter.triangles) {
        const Position face_normal = triangle_normal(at(t[0]), at(t[1]), at(t[2]));
        const double area = length(face_normal);
        whole += area;
        for (std::size_t k = 0; k < 3; ++k) {
            normal[k] += face_normal[k];
            for (const NodeId v : t)
                total[k] += area * (at(v)[k] - first[k]);
        }
    }
    normal = unit(normal);
    if (normal == Position{}) return std::nullopt;
    Position strike{-normal[1], normal[0], 0};
    if (elementary::hypot(normal[0], normal[1]) < 1e-6) strike = cross({0, 1, 0}, normal);
    strike = unit(strike);
    Position middle = first;
    for (std::size_t k = 0; k < 3; ++k)
        middle[k] += total[k] / (3 * whole);
    return PlaneFrame{middle, strike, cross(normal, strike)};
}

/// The triangles of points in plan that lie outside what directed edges have on their left;
/// nothing where edges cross, or something is on the left of two or none too few.
std::optional<std::vector<std::array<std::int32_t, 3>>> outside(
    const std::vector<PlanPoint>& points, const std::vector<std::array<std::int32_t, 2>>& edges) {
    meshing::ConstrainedTriangulation mesh;
    try {
        mesh = meshing::constrained_delaunay(points, edges);
    } catch (const InputError&) {
        return std::nullopt;  // edges that cross, or points that are equal
    }
    // an edge through another point is in two parts, and gapes there
    if (mesh.covered.size() != edges.size()) return std::nullopt;
    std::vector<std::int32_t> ends(points.size());  // of edges, less those that begin there
    for (const auto& [from, to] : edges) {
        --ends[index(from)];
        ++ends[index(to)];
    }
    if (std::ranges::any_of(ends, [](std::int32_t n) { return n != 0; })) return std::nullopt;
    const std::vector<std::int32_t> once(edges.size(), 1);
    const auto depth = meshing::winding_numbers(mesh, points, edges, once);
    if (std::ranges::any_of(depth, [](std::int32_t n) { return n < 0 || n > 1; }))
        return std::nullopt;
    std::vector<std::array<std::int32_t, 3>> outer;
    for (std::size_t t = 0; t < depth.size(); ++t) {
        if (depth[t] == 0) outer.push_back(mesh.triangles[t]);
    }
    return outer;
}

}  // namespace

std::optional<std::vector<std::array<Position, 3>>> continued_in_mean_plane(
    const cutting::Cutter& fault, std::span<const std::array<NodeId, 2>> border,
    std::span<const double> lengths) {
    const auto plane = mean_plane(fault);
    if (!plane) return std::nullopt;
    std::map<NodeId, std::int32_t> number;
    std::vector<PlanPoint> points;
    std::vector<Position> corners;
    std::vector<std::array<std::int32_t, 2>> edges;
    std::array<double, 2> low{HUGE_VAL, HUGE_VAL}, high{-HUGE_VAL, -HUGE_VAL};
    const auto add = [&](const PlanPoint& seen, const Position& position) {
        points.push_back(seen);
        corners.push_back(position);
        for (std::size_t k = 0; k < 2; ++k) {
            low[k] = std::min(low[k], seen[k]);
            high[k] = std::max(high[k], seen[k]);
        }
    };
    for (const auto& edge : border) {
        auto& numbered = edges.emplace_back();
        for (std::size_t i = 0; i < 2; ++i) {
            const auto [known, is_new] =
                number.try_emplace(edge[i], static_cast<std::int32_t>(points.size()));
            const Position& position = fault.vertices[index(edge[i])];
            if (is_new) add(plane->seen(position), position);
            numbered[i] = known->second;
        }
    }
    if (edges.empty()) return std::nullopt;
    // wide enough for the surface to come down to the plane by and by
    const double margin = elementary::hypot(high[0] - low[0], high[1] - low[1]) / 2;
    std::array<PlanPoint, 4> inner{{{low[0] - margin, low[1] - margin},
                                    {high[0] + margin, low[1] - margin},
                                    {high[0] + margin, high[1] + margin},
                                    {low[0] - margin, high[1] + margin}}};
    const std::array<PlanPoint, 4> first = inner;
    for (const PlanPoint& corner : first)
        add(corner, plane->at(corner));
    const auto filled = outside(points, edges);
    if (!filled) return std::nullopt;
    std::vector<std::array<Position, 3>> triangles;
    for (const auto& t : *filled)
        triangles.push_back({corners[index(t[0])], corners[index(t[1])], corners[index(t[2])]});
    for (const double length : lengths) {
        std::array<PlanPoint, 4> outer = first;
        for (std::size_t i = 0; i < 4; ++i) {
            outer[i][0] += i == 1 || i == 2 ? length : -length;
            outer[i][1] += i >= 2 ? length : -length;
        }
        for (std::size_t i = 0; i < 4; ++i) {
            const std::size_t j = (i + 1) % 4;
            const Position a = plane->at(outer[i]), b = plane->at(outer[j]),
                           c = plane->at(inner[j]), d = plane->at(inner[i]);
            triangles.push_back({a, b, c});
            triangles.push_back({a, c, d});
        }
        inner = outer;
    }
    return triangles;
}

namespace {

constexpr double kBesideRock = 1e-6;  // of its size: what is farther away is beyond it

/// How far a continuation goes on, in two steps, by the size of a box around the rock and all
/// structures.
std::array<double, 2> reaches(double size) {
    return {1.25 * size, 8 * size};
}

/// Continues one fault beyond its border. What is nearest reaches out of the rock; what follows
/// goes on until no triangle of any structure that is in the rock, or of what is nearest, goes
/// farther: where they cross, they cross all through.
class Continuation {
public:
    /// @param beyond  for each fault at which it ends, of vertices: whether they are beyond that.
    ///                Edges between such ones are continued in its plane, those that hang together
    ///                all in one direction; so are edges at bays of the border, where what
    ///                continues them would overlap, and a point could be beside either
    /// @param size  of a box around the rock and all structures
    Continuation(const Cutter& fault, const std::vector<std::vector<std::uint8_t>>& beyond,
                 double size)
        : fault_(fault), border_(border_of(fault)), lengths_(reaches(size)) {
        find_directions(beyond);
    }

    std::vector<std::array<Position, 3>> triangles() {
        std::map<NodeId, std::vector<std::pair<NodeId, Position>>> arriving, leaving;
        for (std::size_t i = 0; i < border_.size(); ++i) {
            const CutterBorderEdge& edge = border_[i];
            const Position& way = direction_[i];
            Position a = at(edge.from), b = at(edge.to);
            for (const double length : lengths_) {
                const Position far_a = moved(at(edge.from), length, way);
                const Position far_b = moved(at(edge.to), length, way);
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
                const Position away = plus(unit(minus(at(v), at(ins[i].first))),
                                           unit(minus(at(v), at(outs[i].first))));
                add_fan(at(v), ins[i].second, outs[i].second, away, 0);
            }
        }
        return std::move(triangles_);
    }

private:
    Position at(NodeId v) const { return fault_.vertices[index(v)]; }

    void find_directions(const std::vector<std::vector<std::uint8_t>>& beyond) {
        const auto are_beyond = [](const std::vector<std::uint8_t>& is_beyond,
                                   const CutterBorderEdge& edge) {
            return is_beyond[index(edge.from)] != 0 && is_beyond[index(edge.to)] != 0;
        };
        std::vector<std::vector<std::int32_t>> leaving(fault_.vertices.size());
        for (const CutterBorderEdge& edge : border_) {
            const Position away = cutting::away_from(fault_, edge);
            const bool is_steep = std::abs(away[2]) >= 0.5;
            const bool in_plane = std::ranges::any_of(
                beyond, [&](const auto& is_beyond) { return are_beyond(is_beyond, edge); });
            direction_.push_back(is_steep && !in_plane ? Position{0, 0, away[2] > 0 ? 1.0 : -1.0}
                                                       : away);
            leaving[index(edge.from)].push_back(static_cast<std::int32_t>(direction_.size()) - 1);
        }
        const std::vector<Position> directions = direction_;
        DisjointSets chains(border_.size());
        const auto for_each_pair = [&](const auto& visit) {
            for (std::int32_t i = 0; index(i) < border_.size(); ++i) {
                for (const std::int32_t next : leaving[index(border_[index(i)].to)])
                    visit(i, next);
            }
        };
        for (const auto& is_beyond : beyond) {
            for_each_pair([&](std::int32_t i, std::int32_t next) {
                if (are_beyond(is_beyond, border_[index(i)]) &&
                    are_beyond(is_beyond, border_[index(next)]))
                    chains.join(i, next);
            });
        }
        take_means(directions, chains);
        for (bool any = true; any;) {
            any = false;
            for_each_pair([&](std::int32_t i, std::int32_t next) {
                if (chains.find(i) == chains.find(next) || !overlap(i, next)) return;
                chains.join(i, next);
                any = true;
            });
            if (any) take_means(directions, chains);
        }
    }

    /// Whether what continues two edges overlaps, as at a bay of the border: seen at right angles
    /// to the fault, directions turn the way that the border does not.
    bool overlap(std::int32_t i, std::int32_t next) const {
        constexpr double kTurns = 0.25;  // a little overlap, nearly in one plane, parts nothing
        const CutterBorderEdge &one = border_[index(i)], &other = border_[index(next)];
        const Position normal = unit(plus(normal_of(one), normal_of(other)));
        return dot(normal, cross(direction_[index(i)], direction_[index(next)])) < -kTurns;
    }
    Position normal_of(const CutterBorderEdge& edge) const {
        return unit(
            cross(minus(at(edge.to), at(edge.from)), minus(at(edge.corner), at(edge.from))));
    }

    /// Gives the edges of each chain the mean of their own directions, unless they go round.
    void take_means(const std::vector<Position>& directions, DisjointSets& chains) {
        constexpr double kRound = 0.25;  // of all directions: their sum, at least
        struct DirectionSum {
            Position way{0, 0, 0};
            double whole = 0;
            std::size_t edges = 0;
        };
        std::vector<DirectionSum> sums(border_.size());
        const auto sum_of = [&](std::size_t i) -> DirectionSum& {
            return sums[index(chains.find(static_cast<std::int32_t>(i)))];
        };
        for (std::size_t i = 0; i < border_.size(); ++i) {
            const Position along = minus(at(border_[i].to), at(border_[i].from));
            const double size = length(along);
            DirectionSum& all = sum_of(i);
            all.way = moved(all.way, size, directions[i]);
            all.whole += size;
            ++all.edges;
        }
        for (std::size_t i = 0; i < border_.size(); ++i) {
            const DirectionSum& all = sum_of(i);
            if (all.edges > 1 && length(all.way) >= kRound * all.whole)
                direction_[i] = unit(all.way);
        }
    }

    /// What lies between two neighboring edges' continuations, from that of the edge that arrives
    /// to that of the one that leaves, so narrow that its far side is far away.
    void add_fan(const Position& p, const Position& from, const Position& to, const Position& away,
                 int depth) {
        if (from == to) return;
        if (depth < 4 && dot(from, to) < 0.5) {
            Position middle = plus(from, to);
            if (dot(middle, middle) < 0.1) middle = away;
            middle = unit(middle);
            if (dot(middle, middle) > 0) {
                add_fan(p, from, middle, away, depth + 1);
                add_fan(p, middle, to, away, depth + 1);
                return;
            }
        }
        const Position a = moved(p, lengths_[0], from), b = moved(p, lengths_[0], to);
        const Position far_a = moved(p, lengths_[1], from), far_b = moved(p, lengths_[1], to);
        triangles_.push_back({p, a, b});
        triangles_.push_back({b, a, far_a});
        triangles_.push_back({b, far_a, far_b});
    }

    const Cutter& fault_;
    std::vector<CutterBorderEdge> border_;
    std::vector<Position> direction_;  ///< of these
    std::array<double, 2> lengths_;
    std::vector<std::array<Position, 3>> triangles_;
};

/// Whether a part of a triangle, or of a segment, is in a box: what its six planes leave of that.
bool passes(const Box& box, std::span<const Position> corners) {
    std::vector<Position> left(corners.begin(), corners.end());
    for (std::size_t plane = 0; plane < 6 && !left.empty(); ++plane) {
        const std::size_t k = plane / 2;
        const auto inward = [&](const Position& p) {
            return plane % 2 == 0 ? p[k] - box.low[k] : box.high[k] - p[k];
        };
        std::vector<Position> inside;
        for (std::size_t i = 0; i < left.size(); ++i) {
            const Position &a = left[i], &b = left[(i + 1) % left.size()];
            const double at_a = inward(a), at_b = inward(b);
            if (at_a >= 0) inside.push_back(a);
            if ((at_a < 0) != (at_b < 0)) {
                const double share = at_a / (at_a - at_b);
                inside.push_back(moved(a, share, minus(b, a)));
            }
        }
        left = std::move(inside);
    }
    return !left.empty();
}

/// Whether a fault divides some rock by itself: it passes it, and its border is away from it.
bool divides(const Cutter& fault, const Box& rock) {
    const Position extent = minus(rock.high, rock.low);
    Box near = rock;
    near.widen(kBesideRock * length(extent));
    const auto at = [&fault](NodeId v) { return fault.vertices[index(v)]; };
    return std::ranges::none_of(border_of(fault),
                                [&](const CutterBorderEdge& edge) {
                                    return passes(near, std::array{at(edge.from), at(edge.to)});
                                }) &&
           std::ranges::any_of(fault.triangles, [&](const auto& t) {
               return passes(rock, std::array{at(t[0]), at(t[1]), at(t[2])});
           });
}

/// For each fault that a fault ends at, of the vertices of the latter: whether they are beyond it.
/// There its continuation must go on in its plane: straight up or down it might come back.
std::vector<std::vector<std::uint8_t>> beyond_others(const Structure& structure,
                                                     std::span<const Cutter> faults,
                                                     const Cutter& fault) {
    std::vector<std::vector<std::uint8_t>> all;
    for (const std::int32_t other : structure.ends_at) {
        std::vector<std::uint8_t>& is_beyond = all.emplace_back(fault.vertices.size(), 0);
        const cutting::NearestSide nearest(faults[index(other)]);
        double above = 0;
        for (std::size_t t = 0; t < fault.triangles.size(); ++t) {
            const auto corners = fault.corners(t);
            const Position middle = middle_of(corners[0], corners[1], corners[2]);
            above += nearest(middle) * length(polygon_normal(corners));
        }
        for (std::size_t v = 0; v < is_beyond.size(); ++v) {
            if (nearest(fault.vertices[v]) * above < 0) is_beyond[v] = 1;
        }
    }
    return all;
}

/// What continues a fault beyond its border.
std::vector<std::array<Position, 3>> continuation(std::span<const Structure> structures,
                                                  std::span<const Cutter> faults,
                                                  std::int32_t number, double size) {
    const Structure& structure = structures[index(number)];
    const Cutter& fault = faults[index(number)];
    if (!structure.dies_out)
        return Continuation(fault, beyond_others(structure, faults, fault), size).triangles();
    std::vector<std::array<NodeId, 2>> border;
    for (const CutterBorderEdge& edge : border_of(fault))
        border.push_back({edge.from, edge.to});
    auto triangles = continued_in_mean_plane(fault, border, reaches(size));
    if (!triangles)
        throw InputError("folded",
                         "what is beyond its tip is not known: seen at right angles to the fault "
                         "its border crosses itself",
                         number, {}, fault.vertices[index(border[0][0])]);
    return *std::move(triangles);
}

/// Puts triangles of structures together, one structure after another.
class CutterOfTriangles {
public:
    void begin(bool is_closed) { all_.single.emplace_back().is_closed = is_closed; }
    void add(const std::array<Position, 3>& corners, bool is_continuation) {
        if (exact::in_one_line(corners[0], corners[1], corners[2])) return;
        put({vertices_.add(corners[0]), vertices_.add(corners[1]), vertices_.add(corners[2])},
            is_continuation);
        Cutter& single = all_.single.back();
        const auto first = static_cast<NodeId>(single.vertices.size());
        single.vertices.insert(single.vertices.end(), corners.begin(), corners.end());
        single.triangles.push_back({first, first + 1, first + 2});
    }
    void add_fault(const Cutter& fault, std::span<const std::array<Position, 3>> continuation) {
        for (std::size_t t = 0; t < fault.triangles.size(); ++t)
            add(fault.corners(t), false);
        for (const auto& t : continuation)
            add(t, true);
    }
    /// @param rock  what of the body is away from it cuts nothing; nullopt: all cuts
    void add_body(const Cutter& body, const std::optional<Box>& rock) {
        std::vector<NodeId> nodes(body.vertices.size(), -1);
        for (std::size_t t = 0; t < body.triangles.size(); ++t) {
            const auto corners = body.corners(t);
            if ((rock && !spatial::bounding_box(corners).meets(*rock)) ||
                exact::in_one_line(corners[0], corners[1], corners[2]))
                continue;
            std::array<NodeId, 3> numbers{};
            for (std::size_t i = 0; i < 3; ++i) {
                NodeId& known = nodes[index(body.triangles[t][i])];
                if (known < 0) known = vertices_.add(corners[i]);
                numbers[i] = known;
            }
            put(numbers, false);
        }
        all_.single.back() = body;
    }
    StructureCutter cutter() && {
        all_.combined.vertices = vertices_.keys();
        return std::move(all_);
    }

private:
    void put(const std::array<NodeId, 3>& triangle, bool is_continuation) {
        all_.combined.triangles.push_back(triangle);
        all_.structure.push_back(static_cast<std::int32_t>(all_.single.size()) - 1);
        all_.is_continuation.push_back(is_continuation ? 1 : 0);
    }

    StructureCutter all_;
    KeyNumbers<Position> vertices_;
};

/// @param all_of_bodies  the cutter of all has what of bodies is beyond the rock
StructureCutter cutter_of(std::span<const Structure> structures, const Box& rock,
                          bool all_of_bodies) {
    const std::vector<Cutter> cutters = checked_cutters(structures);
    const double size = size_with(rock, cutters);
    Box near = rock;
    near.widen(kBesideRock * length(minus(rock.high, rock.low)));
    CutterOfTriangles all;
    for (std::int32_t s = 0; index(s) < structures.size(); ++s) {
        const Cutter& cutter = cutters[index(s)];
        all.begin(cutter.is_closed);
        if (cutter.is_closed)
            all.add_body(cutter, all_of_bodies ? std::nullopt : std::optional(near));
        else if (divides(cutter, rock))
            all.add_fault(cutter, {});
        else
            all.add_fault(cutter, continuation(structures, cutters, s, size));
    }
    return std::move(all).cutter();
}

/// One structure alone, checked and oriented.
Cutter checked_cutter(const Structure& structure, std::int32_t number) {
    try {
        Cutter cutter = cutting::oriented_cutter(structure.surface, false);
        if (structure.is_body && !cutter.is_closed) {
            const auto border = border_of(cutter);
            const Position place = cutter.vertices[border.empty() ? 0 : index(border[0].from)];
            throw InputError("not_closed", "the body is not closed: its surface ends at an edge",
                             -1, {}, place);
        }
        if (!structure.is_body && cutter.is_closed)
            throw InputError("is_closed", "the fault is a closed surface: it has no border");
        return cutter;
    } catch (InputError& error) {
        error.surface = number;
        throw;
    }
}

}  // namespace

std::vector<Cutter> checked_cutters(std::span<const Structure> structures) {
    std::vector<Cutter> cutters;
    for (std::int32_t s = 0; index(s) < structures.size(); ++s)
        cutters.push_back(checked_cutter(structures[index(s)], s));
    return cutters;
}

double size_with(const Box& rock, std::span<const Cutter> structures) {
    Box whole = rock;
    for (const Cutter& cutter : structures)
        whole.include(spatial::bounding_box(cutter.vertices));
    return length(minus(whole.high, whole.low));
}

StructureCutter structure_cutter(std::span<const Structure> structures, const Box& rock) {
    return cutter_of(structures, rock, false);
}

StructureCutter structure_cutter(std::span<const Structure> structures,
                                 std::span<const ContinuedStructure> continued) {
    CutterOfTriangles all;
    std::vector<std::vector<std::int8_t>> end_sides;
    for (std::size_t s = 0; s < structures.size(); ++s) {
        all.begin(structures[s].is_body);
        for (std::size_t t = 0; t < continued[s].triangles.size(); ++t)
            all.add(continued[s].triangles[t], continued[s].is_continuation[t] != 0);
        end_sides.push_back(continued[s].end_sides);
    }
    StructureCutter cutter = std::move(all).cutter();
    cutter.end_sides = std::move(end_sides);
    return cutter;
}

std::vector<ContinuedStructure> continued_structures(
    std::span<const Structure> structures, const std::array<std::array<double, 3>, 2>& corners) {
    const StructureCutter cutter = cutter_of(structures, spatial::bounding_box(corners), true);
    std::vector<ContinuedStructure> continued(structures.size());
    for (std::size_t s = 0; s < structures.size(); ++s) {
        for (const std::int32_t other : structures[s].ends_at)
            continued[s].end_sides.push_back(
                larger_side(cutter, static_cast<std::int32_t>(s), other));
    }
    for (std::size_t t = 0; t < cutter.structure.size(); ++t) {
        ContinuedStructure& structure = continued[index(cutter.structure[t])];
        structure.triangles.push_back(cutter.combined.corners(t));
        structure.is_continuation.push_back(cutter.is_continuation[t]);
    }
    return continued;
}

StructureCutter cutter_of_first(std::span<const Structure> structures, const Box& rock) {
    const std::vector<Cutter> cutters = checked_cutters(structures);
    return cutter_of_first(structures, cutters, size_with(rock, cutters));
}

StructureCutter cutter_of_first(std::span<const Structure> structures,
                                std::span<const Cutter> cutters, double size) {
    CutterOfTriangles all;
    all.begin(cutters[0].is_closed);
    if (cutters[0].is_closed)
        all.add_body(cutters[0], std::nullopt);
    else
        all.add_fault(cutters[0], continuation(structures, cutters, 0, size));
    return std::move(all).cutter();
}

}  // namespace realmodel::structures
