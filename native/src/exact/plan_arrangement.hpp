// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <array>
#include <atomic>
#include <bit>
#include <cassert>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "base/index.hpp"
#include "base/key_table.hpp"
#include "exact/orientation.hpp"
#include "realmodel/base/array.hpp"

namespace realmodel::exact {

/// Finds numbered things again, each among the few that have the same owner: an edge among those of
/// its lower vertex, a crossing among those of the younger of its lines. Neighbors are numbered
/// together, so what is asked for next mostly lies beside what was asked for last, where a hash
/// table would go to another page of memory; and it takes a third of one. Owners may have any
/// number of things: from `kMaxListed` on they have to be kept elsewhere, as lists are read from
/// end to end.
class OwnedNames {
public:
    /// Instead of a number: this owner's things are kept elsewhere from now on.
    static constexpr std::int32_t kElsewhere = -2;

    /// The number of the owner's thing of which `is_it` holds; or `next`, which is greater than all
    /// numbers before, where there is none: then that is its number.
    template <class IsIt>
    std::int32_t find_or_add(std::int32_t owner, std::int32_t next, const IsIt& is_it) {
        const auto o = static_cast<std::size_t>(owner);
        if (o >= last_.size()) last_.resize(o + 1, kNone);
        int count = 0;
        for (std::int32_t number = last_[o]; number != kNone; ++count) {
            if (is_it(number)) return number;
            number = before_[static_cast<std::size_t>(number)];
        }
        if (count == kMaxListed) return kElsewhere;
        assert(next >= 0 && static_cast<std::size_t>(next) >= before_.size());
        before_.resize(static_cast<std::size_t>(next) + 1);
        before_.back() = last_[o];
        last_[o] = next;
        return next;
    }

    /// What will be read first, to be fetched some time before, as memory takes its time.
    const void* slot_of(std::int32_t owner) const {
        const auto o = static_cast<std::size_t>(owner);
        return o < last_.size() ? &last_[o] : nullptr;
    }

private:
    static constexpr std::int32_t kNone = -1;
    static constexpr int kMaxListed = 8;

    Array<std::int32_t> last_;    ///< of each owner
    Array<std::int32_t> before_;  ///< of each thing, the owner's last one before it
};

/// Index of a plan vertex: an input position (x, y), the same for all surfaces that use it.
using VertexId = Id<struct VertexKind>;
/// Index of a space vertex: an input position (x, y, z).
using SpaceId = Id<struct SpaceVertex>;
/// Index of a plane: the input triangle that spans it.
using PlaneId = Id<struct SpannedPlane>;
/// Index of a plan line; ids from `kLocal` on belong to the LocalArrangement that made them.
using LineId = Id<class Line>;
/// Index of a plan point; ids below the number of plan vertices are those vertices.
using PointId = Id<struct PointKind>;
struct PointKind {};
struct VertexKind : PointKind {};

/// First id of lines and points that a LocalArrangement holds for itself; of all kinds of things
/// there may be as many as there are ids below it.
inline constexpr std::int32_t kLocal = 1 << 29;
template <class Kind>
bool is_local(Id<Kind> id) {
    return id.number() >= kLocal;
}

/// To be called before there are `count` things of a kind.
/// @param what  their name, for the user
/// @throws InputError kind too_large, where there are not so many ids
void check_ids(std::size_t count, const char* what,
               std::size_t most = static_cast<std::size_t>(kLocal));

/// A line with a direction. Its left side is positive.
class DirectedLine {
public:
    DirectedLine() = default;
    explicit DirectedLine(LineId line, bool is_reversed = false)
        : line_and_way_(line.number() * 2 + (is_reversed ? 1 : 0)) {}

    LineId id() const { return LineId(line_and_way_ >> 1); }
    bool is_reversed() const { return (line_and_way_ & 1) != 0; }
    DirectedLine reversed() const {
        DirectedLine other = *this;
        other.line_and_way_ ^= 1;
        return other;
    }
    friend bool operator==(DirectedLine, DirectedLine) = default;

private:
    std::int32_t line_and_way_;
};

/// A stretch of a directed line between two different points of it, in its direction.
struct DirectedEdge {
    DirectedLine line;
    PointId from, to;
};

/// What a plan line is made of, straight from the input. Nothing in the program stands on a line or
/// a point that was itself rounded, so every decision is exact on the input.
class Line {
public:
    Line() = default;
    /// Through two plan vertices, in ascending order; positive to the left of the way from the
    /// first to the second.
    Line(VertexId first, VertexId second) : is_edge_(1), of_{first.number(), second.number()} {
        assert(first < second);
    }
    /// The trace of two planes, in ascending order: where they are equally high; positive where the
    /// first is higher.
    Line(PlaneId first, PlaneId second) : is_edge_(0), of_{first.number(), second.number()} {}

    bool is_edge() const { return is_edge_ != 0; }
    std::array<VertexId, 2> ends() const {
        assert(is_edge());
        return {VertexId(of_[0]), VertexId(of_[1])};
    }
    std::array<PlaneId, 2> planes() const {
        assert(!is_edge());
        return {PlaneId(of_[0]), PlaneId(of_[1])};
    }
    /// What tells lines apart.
    KeyTable::Key key() const { return {is_edge_, of_[0], of_[1], 0}; }
    friend bool operator==(const Line&, const Line&) = default;

private:
    std::int32_t is_edge_;
    std::array<std::int32_t, 2> of_;
};

/// An input edge by the space vertices over the ends of its plan line, a vertex as an edge from it
/// to itself, or a plane: what tells in which position something lies, or how high.
class EdgeOrPlane {
public:
    EdgeOrPlane() = default;  ///< neither
    EdgeOrPlane(SpaceId from, SpaceId to) : from_(from), other_(to.number()) {}
    explicit EdgeOrPlane(PlaneId plane) : other_(plane.number()) {}

    bool is_edge() const { return from_ != kNone; }
    SpaceId from() const { return from_; }
    SpaceId to() const {
        assert(is_edge());
        return SpaceId(other_);
    }
    PlaneId plane() const {
        assert(!is_edge());
        return PlaneId(other_);
    }
    std::array<std::int32_t, 2> key() const { return {from_.number(), other_}; }
    friend auto operator<=>(const EdgeOrPlane&, const EdgeOrPlane&) = default;

private:
    SpaceId from_ = kNone;  ///< none of a plane
    std::int32_t other_ = -1;
};

/// A line in doubles: a * (x - x0) + b * (y - y0) + c, each coefficient with a bound on its error.
struct LineFilter {
    double a = 0, b = 0, c = 0;
    double error_a = 0, error_b = 0, error_c = 0;
    double x0 = 0, y0 = 0;

    /// Bound on the error of the value at a point that is up to (dx, dy) from (x0, y0), and whose
    /// coordinates err by up to point_error.
    double error_at(double dx, double dy, double point_error) const {
        const double way_x = std::abs(dx), way_y = std::abs(dy);
        const double slope_x = std::abs(a), slope_y = std::abs(b);
        return ((slope_x + error_a) * (point_error + kEpsilon * way_x) +
                (slope_y + error_b) * (point_error + kEpsilon * way_y) + error_a * way_x +
                error_b * way_y + error_c +
                kLineValue * (slope_x * way_x + slope_y * way_y + std::abs(c)) + kTermUnderflow) *
               kBoundSlack;
    }
};

/// How far a coordinate may be from the double of this size that is nearest to it.
inline double rounding_error(double size) {
    return size * kUnitRoundoff + kCoordinateUnderflow;
}

/// A plan point: an input vertex, or the crossing of two lines.
struct Point {
    LineId first = kNone, second = kNone;  ///< none of an input vertex
    double x = 0, y = 0;                   ///< the doubles nearest to the true position

    /// Bound on the distance from the true position in x and in y.
    double error() const {
        return first == kNone ? 0 : rounding_error(std::max(std::abs(x), std::abs(y)));
    }
};

/// Where an input edge pierces a plane: known by name, since the traces of both triangles beside
/// that edge run through it. Where the plane's triangle has an edge over the same plan edge, that
/// edge stands for the plane, as the triangles beside it share it too. Neither elsewhere.
struct Piercing {
    EdgeOrPlane edge, pierced;
};

/// A crossing with what names it: the edge and the plane or edge that it meets, or its two lines.
struct NamedPoint : Point {
    NamedPoint(const Point& point, const Piercing& piercing) : Point(point), by(piercing) {}

    Piercing by;

    KeyTable::Key key() const {
        const auto of_edge = by.edge.key(), of_pierced = by.pierced.key();
        if (by.edge.is_edge()) return {of_edge[0], of_edge[1], of_pierced[0], of_pierced[1]};
        return {-1, std::min(first, second).number(), std::max(first, second).number(), 0};
    }
};

/// The halves of a double as a part of a key; -0 is 0.
inline std::array<std::int32_t, 2> halves(double value) {
    const auto bits = std::bit_cast<std::uint64_t>(value == 0.0 ? 0.0 : value);
    return {static_cast<std::int32_t>(bits >> 32), static_cast<std::int32_t>(bits)};
}
/// What tells plan vertices apart, and space vertices.
inline KeyTable::Key position_key(double x, double y) {
    const auto hx = halves(x), hy = halves(y);
    return {hx[0], hx[1], hy[0], hy[1]};
}
inline KeyTable::Key height_key(VertexId plan, double z) {
    const auto hz = halves(z);
    return {plan.number(), hz[0], hz[1], 0};
}

/// A space vertex: a plan vertex and a height.
struct SpaceVertex {
    VertexId plan;
    double z;
};

/// The gradient of a plane in doubles, with a bound on its error.
struct PlaneFilter {
    double gx = 0, gy = 0, error_x = 0, error_y = 0;
};

/// A triangle that spans a plane: space vertices, counter-clockwise in plan, and the plan vertices
/// that they stand on.
struct SpannedPlane {
    std::array<SpaceId, 3> corner;
    std::array<VertexId, 3> plan;

    /// The corner above a plan vertex, if there is one.
    SpaceId above(VertexId vertex) const {
        for (std::size_t i = 0; i < 3; ++i) {
            if (plan[i] == vertex) return corner[i];
        }
        return kNone;
    }
    /// The side above an input edge, neither where there is none.
    EdgeOrPlane above(const Line& line) const {
        if (!line.is_edge()) return {};
        const auto [first, second] = line.ends();
        const SpaceId from = above(first);
        if (from == kNone) return {};
        const SpaceId to = above(second);
        return to == kNone ? EdgeOrPlane() : EdgeOrPlane(from, to);
    }
};

/// The box of all plan vertices, and a bound on the errors of points in it.
struct PlanReach {
    double low_x = HUGE_VAL, low_y = HUGE_VAL, high_x = -HUGE_VAL, high_y = -HUGE_VAL;
    double width = 0, height = 0, point_error = 0;
    /// |a| and |b| of an edge's filter times these, and what underflow may take, bound its error at
    /// any point in the box: LineFilter::error_at with all that the edges have in common taken out.
    double edge_x = 0, edge_y = 0;

    bool has(double x, double y) const {
        return x >= low_x && x <= high_x && y >= low_y && y <= high_y;
    }
};

/// The exact geometry that a whole stack is decided on: input vertices, planes, and the lines and
/// points that follow from them. Filling it is for one thread; reading it for any number.
class PlanArrangement {
public:
    PlanArrangement() = default;
    PlanArrangement(const PlanArrangement&) = delete;
    PlanArrangement& operator=(const PlanArrangement&) = delete;

    /// Makes room for so many vertices, planes, or lines.
    void expect_vertices(std::size_t count);
    void expect_planes(std::size_t count);
    void expect_lines(std::size_t count);
    /// The vertex at (x, y), made where it is new. All vertices come before the first crossing.
    VertexId add_vertex(double x, double y);
    /// The space vertex at a plan vertex and a height, made where it is new.
    SpaceId add_space_vertex(VertexId plan, double z);
    /// A plane through three space vertices that turn counter-clockwise in plan.
    PlaneId add_plane(const std::array<SpaceId, 3>& corner);
    /// Makes room for so many planes; the first of them. Each has to be set before it is used, by
    /// any thread.
    PlaneId make_planes(std::size_t count);
    void set_plane(PlaneId plane, const std::array<SpaceId, 3>& corner);
    /// To be called once, when all vertices are there and before any other question is asked. From
    /// then on none may be added.
    void freeze_vertices();

    /// Gives back the memory that finds lines and points by name, and that of gradients, which are
    /// found anew each time. No edge and no plane may be added any more; other lines and points
    /// become new ones, whatever their names.
    void forget_names();
    /// Gives all memory back, for when nothing but the vertex count and the counts of decisions
    /// will be asked for.
    void forget_all();

    /// The line through two plan vertices, made where it is new, directed from `from` to `to`.
    DirectedLine add_edge(VertexId from, VertexId to);
    /// A line, and the crossing of two different lines that are not parallel; found by name where
    /// it was added by these before.
    LineId add_line(const Line& line);
    PointId add_point(const Point& point);
    /// The first ids of lines and points that are appended.
    struct Appended {
        LineId line;
        PointId point;
    };
    /// Appends so many lines and points that nobody looks for by name. Each has to be set before it
    /// is used, by any thread.
    /// @throws InputError kind too_large
    Appended append(std::size_t lines, std::size_t points);
    void set_line(LineId id, const Line& line) { lines_[index(id)] = line; }
    void set_point(PointId id, const Point& point) { points_[index(id)] = point; }
    /// Makes room for so many more lines and points than there are. While there is room for what is
    /// added, what was there may be read by other threads.
    void make_room(std::size_t lines, std::size_t points);
    bool has_room(std::size_t lines, std::size_t points) const {
        return lines_.capacity() - lines_.size() >= lines &&
               points_.capacity() - points_.size() >= points;
    }
    /// To be called some time before one of these is added, as memory takes its time.
    [[gnu::always_inline]] void prefetch_vertex(double x, double y) const {
        vertex_table_.prefetch(position_key(x, y));
    }
    [[gnu::always_inline]] void prefetch_space_vertex(VertexId plan, double z) const {
        space_table_.prefetch(height_key(plan, z));
    }
    [[gnu::always_inline]] void prefetch_edge(VertexId from, VertexId to) const {
        __builtin_prefetch(edges_of_vertex_.slot_of(std::min(from, to).number()));
    }

    std::size_t vertex_count() const { return vertex_count_; }
    bool is_vertex(PointId id) const { return index(id) < vertex_count_; }
    /// The plan vertex that a point is.
    VertexId vertex(PointId id) const {
        assert(is_vertex(id));
        return VertexId(id.number());
    }
    std::size_t space_count() const { return space_.size(); }
    std::size_t plane_count() const { return planes_.size(); }
    std::size_t line_count() const { return lines_.size(); }
    std::size_t point_count() const { return points_.size(); }
    const Line& line(LineId id) const { return lines_[index(id)]; }
    LineFilter filter(LineId id) const {
        const Line& l = line(id);
        return l.is_edge() ? edge_filter(l.ends()[0], l.ends()[1])
                           : trace_filter(l.planes()[0], l.planes()[1]);
    }
    const Point& point(PointId id) const { return points_[index(id)]; }
    /// What an edge pierces at the crossing of two lines.
    Piercing piercing(const Line& first, const Line& second) const;
    const SpannedPlane& plane(PlaneId id) const { return planes_[index(id)]; }
    PlaneFilter plane_filter(PlaneId id) const {
        return plane_filters_.empty() ? filter_of(plane(id).corner) : plane_filters_[index(id)];
    }
    const SpaceVertex& space(SpaceId id) const { return space_[index(id)]; }

    LineFilter edge_filter(VertexId from, VertexId to) const;
    LineFilter trace_filter(PlaneId first, PlaneId second) const;

    const PlanReach& reach() const { return reach_; }

    /// A difference of heights beside which all rounding is small. Where faces are so far apart,
    /// they need no vertices at each other's: a wall between them with rounded corners on one side
    /// only is still vertical to 2^-22.
    double clear_height(double largest_height) const {
        return kClearHeight * largest_height + kClearPositions * reach_.point_error;
    }

    /// Binary exponents that make every x and y, and every z, a whole number.
    int plan_exponent() const { return plan_exponent_; }
    int height_exponent() const { return height_exponent_; }

    /// How many decisions floating point left to exact arithmetic so far.
    std::uint64_t exact_decisions() const {
        return exact_decisions_.load(std::memory_order_relaxed);
    }
    std::uint64_t all_decisions() const { return all_decisions_.load(std::memory_order_relaxed); }
    void count_decisions(std::uint64_t all, std::uint64_t exact) const {
        all_decisions_.fetch_add(all, std::memory_order_relaxed);
        exact_decisions_.fetch_add(exact, std::memory_order_relaxed);
    }

private:
    Array<Point> points_;
    Array<SpaceVertex> space_;
    Array<SpannedPlane> planes_;
    Array<PlaneFilter> plane_filters_;
    Array<Line> lines_;
    PlaneFilter filter_of(const std::array<SpaceId, 3>& corner) const;
    LineId find_or_add_line(const Line& line, LineId next);

    KeyTable vertex_table_, space_table_;
    /// Edges by their lower vertex. The table has the other lines, and edges of which a vertex has
    /// too many.
    OwnedNames edges_of_vertex_;
    KeyTable line_table_, point_table_;
    std::size_t vertex_count_ = 0;
    PlanReach reach_;
    int plan_exponent_ = 0, height_exponent_ = 0;
    mutable std::atomic<std::uint64_t> exact_decisions_{0}, all_decisions_{0};
};

}  // namespace realmodel::exact
