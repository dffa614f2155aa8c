// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <array>
#include <atomic>
#include <bit>
#include <cmath>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "base/key_table.hpp"
#include "exact/owned_names.hpp"
#include "realmodel/base/growing_array.hpp"

namespace realmodel::exact {

/// Index of a plan vertex: an input position (x, y), the same for all surfaces that use it.
using VertexId = std::int32_t;
/// Index of a space vertex: an input position (x, y, z).
using SpaceId = std::int32_t;
/// Index of a plane: the input triangle that spans it.
using PlaneId = std::int32_t;
/// Index of a plan line; ids from `kLocal` on belong to the LocalArrangement that made them.
using LineId = std::int32_t;
/// Index of a plan point; ids below the number of plan vertices are those vertices.
using PointId = std::int32_t;

/// First id of lines and points that a LocalArrangement holds for itself.
inline constexpr std::int32_t kLocal = 1 << 29;

/// A line with a direction: `line * 2 + reversed`. Its left side is positive.
using DirectedLine = std::int32_t;
inline DirectedLine directed(LineId line, bool reversed) {
    return line * 2 + (reversed ? 1 : 0);
}
inline LineId line_of(DirectedLine line) {
    return line >> 1;
}
inline bool is_reversed(DirectedLine line) {
    return (line & 1) != 0;
}
inline DirectedLine opposite(DirectedLine line) {
    return line ^ 1;
}

/// A stretch of a directed line between two different points of it, in its direction.
struct DirectedEdge {
    DirectedLine line;
    PointId from, to;
};

/// What a plan line is made of, straight from the input. Nothing in the program stands on a line or
/// a point that was itself rounded, so every decision is exact on the input.
struct Line {
    enum class Kind : std::int32_t {
        kEdge,  ///< through plan vertices `first` < `second`, positive to the left of first->second
        kTrace  ///< where planes `first` < `second` are equally high, positive where first is
                ///< higher
    };
    Kind kind = Kind::kEdge;
    std::int32_t first = 0;
    std::int32_t second = 0;
};

/// A line in doubles: a * (x - x0) + b * (y - y0) + c, each coefficient with a bound on its error.
struct LineFilter {
    double a = 0, b = 0, c = 0;
    double error_a = 0, error_b = 0, error_c = 0;
    double x0 = 0, y0 = 0;

    /// Bound on the error of the value at a point that is up to (dx, dy) from (x0, y0), and whose
    /// coordinates err by up to point_error.
    double error_at(double dx, double dy, double point_error) const {
        constexpr double kEpsilon = 0x1p-52;
        const double way_x = std::abs(dx), way_y = std::abs(dy);
        const double slope_x = std::abs(a), slope_y = std::abs(b);
        return (slope_x + error_a) * (point_error + kEpsilon * way_x) +
               (slope_y + error_b) * (point_error + kEpsilon * way_y) + error_a * way_x +
               error_b * way_y + error_c +
               4 * kEpsilon * (slope_x * way_x + slope_y * way_y + std::abs(c)) + 1e-290;
    }
};

/// A plan point: an input vertex, or the crossing of two lines.
struct Point {
    LineId first = -1;  ///< -1 for an input vertex
    LineId second = -1;
    /// Where an input edge (space vertices edge_from < edge_to) pierces a plane: known by name,
    /// since the traces of both triangles beside that edge run through it. edge_from is -1
    /// elsewhere.
    SpaceId edge_from = -1, edge_to = -1;
    PlaneId pierced = -1;
    /// Where the plane's triangle has an edge over the same plan edge, that edge stands for the
    /// plane, as the triangles beside it share it too: `pierced` is its lower space vertex and this
    /// the higher one. -1 elsewhere.
    SpaceId pierced_to = -1;
    double x = 0, y = 0;  ///< the doubles nearest to the true position

    /// Bound on the distance from the true position in x and in y.
    double error() const {
        return first < 0 ? 0 : std::max(std::abs(x), std::abs(y)) * 0x1p-53 + 1e-300;
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
    return {plan, hz[0], hz[1], 0};
}
/// What tells lines apart.
inline KeyTable::Key line_key_of(const Line& line) {
    return {static_cast<std::int32_t>(line.kind), line.first, line.second, 0};
}
/// The name of a crossing: the edge and the plane or edge that it meets, or its two lines.
inline KeyTable::Key point_key_of(const Point& point) {
    if (point.pierced_to >= 0)
        return {2 + point.edge_from, point.edge_to, point.pierced, point.pierced_to};
    if (point.edge_from >= 0) return {0, point.edge_from, point.edge_to, point.pierced};
    return {1, std::min(point.first, point.second), std::max(point.first, point.second), 0};
}

/// A number in extended precision and a bound on its error.
struct ExtendedInterval {
    long double value;
    double error;
};

/// A plan point relative to a plan vertex.
struct NearPoint {
    VertexId origin;
    ExtendedInterval x, y;
};

/// What is known of the height of a plane above a point without arithmetic; planes with equal names
/// are equally high there. A space vertex twice: it stands there; two of them, ascending: an input
/// edge between the two passes there; -1 and a plane: nothing but that it is as high as that plane.
struct HeightName {
    std::int32_t first, second;
    friend bool operator==(const HeightName&, const HeightName&) = default;
};

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
struct Plane {
    std::array<SpaceId, 3> corner;
    std::array<VertexId, 3> plan;

    /// The corner above a plan vertex, -1 where there is none.
    SpaceId above(VertexId vertex) const {
        for (std::size_t i = 0; i < 3; ++i) {
            if (plan[i] == vertex) return corner[i];
        }
        return -1;
    }
};

/// The box of all plan vertices, and a bound on the errors of points in it.
struct PlanReach {
    double low_x = HUGE_VAL, low_y = HUGE_VAL, high_x = -HUGE_VAL, high_y = -HUGE_VAL;
    double width = 0, height = 0, point_error = 0;
    /// |a| and |b| of an edge's filter times these, and a trifle for underflow, bound its error at
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

    /// Gives back the memory that finds lines and points by name, for when hardly any will be asked
    /// for; it is made again for the first that is.
    void forget_names();
    /// Gives all memory back, for when nothing but the vertex count and the counts of decisions
    /// will be asked for.
    void forget_all();

    /// The line through two plan vertices, made where it is new, directed from `from` to `to`.
    DirectedLine add_edge(VertexId from, VertexId to);
    LineId add_line(const Line& line);
    /// The crossing of two different lines that are not parallel, made where it is new.
    PointId add_point(const Point& point);
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
        prefetch(Line{Line::Kind::kEdge, std::min(from, to), std::max(from, to)});
    }
    [[gnu::always_inline]] void prefetch(const Line& line) const {
        __builtin_prefetch(line.kind == Line::Kind::kEdge ? edges_of_vertex_.place(line.first)
                                                          : line_table_.place(line_key_of(line)));
    }
    /// What is to be fetched before a point is added.
    const void* place_of_name(const Point& point) const {
        return point.edge_from < 0 ? crossings_of_line_.place(std::max(point.first, point.second))
                                   : point_table_.place(point_key_of(point));
    }

    VertexId vertex_count() const { return static_cast<VertexId>(vertex_count_); }
    std::size_t space_count() const { return space_.size(); }
    std::size_t plane_count() const { return planes_.size(); }
    std::size_t line_count() const { return lines_.size(); }
    std::size_t point_count() const { return points_.size(); }
    const Line& line(LineId id) const { return lines_[static_cast<std::size_t>(id)]; }
    LineFilter filter(LineId id) const {
        const Line& l = line(id);
        return l.kind == Line::Kind::kEdge ? edge_filter(l.first, l.second)
                                           : trace_filter(l.first, l.second);
    }
    const Point& point(PointId id) const { return points_[static_cast<std::size_t>(id)]; }
    const Plane& plane(PlaneId id) const { return planes_[static_cast<std::size_t>(id)]; }
    const PlaneFilter& plane_filter(PlaneId id) const {
        return plane_filters_[static_cast<std::size_t>(id)];
    }
    const SpaceVertex& space(SpaceId id) const { return space_[static_cast<std::size_t>(id)]; }

    /// The space vertex of a plane's triangle above a plan vertex, -1 where it has none there.
    SpaceId corner_above(PlaneId id, VertexId vertex) const { return plane(id).above(vertex); }

    LineFilter edge_filter(VertexId from, VertexId to) const;
    LineFilter trace_filter(PlaneId first, PlaneId second) const;

    const PlanReach& reach() const { return reach_; }

    /// A difference of heights beside which nothing that rounding does shows. Where faces are so
    /// far apart, they need no vertices at each other's: a wall between them with rounded corners
    /// on one side only still stands upright to 2^-22.
    double clear_height(double largest_height) const {
        return 0x1p-40 * largest_height + 0x1p24 * reach_.point_error;
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
    GrowingArray<Point> points_;
    GrowingArray<SpaceVertex> space_;
    GrowingArray<Plane> planes_;
    GrowingArray<PlaneFilter> plane_filters_;
    GrowingArray<Line> lines_;
    void remember_names();
    std::int32_t find_or_add_line(const Line& line, std::int32_t next);
    std::int32_t find_or_add_crossing(const Point& point, std::int32_t next);

    KeyTable vertex_table_, space_table_;
    /// Edges by their lower vertex and crossings by the younger line. The tables have other lines,
    /// crossings with other names, and what their owners have too many of.
    OwnedNames edges_of_vertex_, crossings_of_line_;
    KeyTable line_table_, point_table_;
    bool names_forgotten_ = false;
    std::size_t vertex_count_ = 0;
    PlanReach reach_;
    int plan_exponent_ = 0, height_exponent_ = 0;
    mutable std::atomic<std::uint64_t> exact_decisions_{0}, all_decisions_{0};
};

/// One thread's view of the geometry: everything shared, and the lines and points that this thread
/// found, under ids from kLocal on until they are handed over. All questions are asked here.
class LocalArrangement {
public:
    explicit LocalArrangement(const PlanArrangement& geometry) : shared_(geometry) {}
    ~LocalArrangement() { shared_.count_decisions(decisions_, exact_); }
    LocalArrangement(const LocalArrangement&) = delete;
    LocalArrangement& operator=(const LocalArrangement&) = delete;

    /// Makes room for so many points that this scope may find, at once.
    void expect_points(std::size_t count) {
        points_.reserve(count);
        point_table_.reserve(count);
    }

    const PlanArrangement& shared() const { return shared_; }
    const Line& line(LineId id) const {
        return id < kLocal ? shared_.line(id) : lines_[static_cast<std::size_t>(id - kLocal)];
    }
    LineFilter filter(LineId id) const {
        return id < kLocal ? shared_.filter(id) : filters_[static_cast<std::size_t>(id - kLocal)];
    }
    const Point& point(PointId id) const {
        return id < kLocal ? shared_.point(id) : points_[static_cast<std::size_t>(id - kLocal)];
    }
    bool is_vertex(PointId id) const { return id < shared_.vertex_count(); }

    /// On which side of a directed line a point lies: 1 left, 0 on it, -1 right. The predicate that
    /// every decision comes down to: the sign of a 3 x 3 determinant of plan lines.
    int side(DirectedLine line, PointId point);
    /// The sign of the height of plane `upper` less that of plane `lower` above a point.
    int compare_heights(PlaneId upper, PlaneId lower, PointId point);
    /// The same with the filter of their trace at hand; the trace itself need not exist.
    int compare_heights(PlaneId upper, PlaneId lower, const LineFilter& trace, PointId point);
    /// Whether a point lies to the left of a line, or a trace, that need not exist; where floating
    /// point does not tell, it says no.
    bool is_left_for_certain(const LineFilter& line, PointId id) const {
        return filtered_side(line, point(id)) == 1;
    }
    /// Whether a point lies to the right of a trace by more than a difference of heights and many
    /// times what rounding makes of it.
    bool is_right_by(const LineFilter& trace, PointId id, double difference) const;
    /// Whether two points are in the same place.
    bool same_place(PointId a, PointId b);
    /// Whether two lines run through the same places.
    bool same_line(LineId a, LineId b);
    /// Signs of the direction (x, y) in which a line runs.
    std::array<int, 2> direction_signs(LineId line);
    /// The sign of b - a in x (axis 0) or y (axis 1), exactly.
    int compare(int axis, PointId a, PointId b);

    /// The point where two lines cross, which must exist. Input vertices and edges that pierce a
    /// plane are recognised by name.
    PointId crossing(LineId a, LineId b);
    /// The same where no input vertex is the crossing: between the ends of an edge on one of them
    /// and the ends of an edge on the other.
    PointId crossing_between_ends(LineId a, LineId b);
    /// Where two planes are equally high; positive where `upper` is above `lower`.
    DirectedLine trace(PlaneId upper, PlaneId lower);

    /// The doubles nearest to a point's true coordinates: the same for every way to name the place.
    std::array<double, 2> rounded(PointId point);
    /// By what the height of a plane above a point is known; planes that are equally high may still
    /// have different names.
    HeightName height_name(PlaneId plane, PointId point) const;

    /// Where a point lies, as closely as is cheap to say; for several heights above it.
    NearPoint near(PointId point) const;
    /// The double nearest to the height of a plane above a point.
    double rounded_height(PlaneId plane, PointId point);
    /// The same where the name says an input edge, and the point is where it crosses another; or
    /// nothing. The quickest of all.
    std::optional<double> rounded_height_of_crossing(const HeightName& name, PointId point) const;
    double rounded_height(PlaneId plane, PointId point, const NearPoint& near);
    /// The same of a plane whose height there is known by a name.
    double rounded_height(PlaneId plane, const HeightName& name, PointId point,
                          const NearPoint& near);
    /// Slope and offset of a line, rounded: equal for lines that run through the same places.
    std::array<double, 3> line_key(LineId line);

    /// Counts signs that were told without `side`.
    void count_decisions(std::size_t count) { decisions_ += count; }
    /// How many decisions of this scope floating point left to exact arithmetic.
    std::uint64_t exact_decisions() const { return exact_; }

    /// Asks for a line or point, which may be local, to be handed over.
    void mark_line_used(LineId id) {
        if (id >= kLocal && is_kept(line_ids_, id)) ask_for_local_line(id);
    }
    void mark_point_used(PointId id) {
        if (id >= kLocal && is_kept(point_ids_, id)) ask_for_local_point(id);
    }
    /// Hands the local lines and points over to the geometry that were asked for; what nobody asks
    /// for stays behind. Nothing new may be found afterwards.
    void commit(PlanArrangement& geometry);
    /// Whether the geometry has room for what was asked for.
    bool has_room_in(const PlanArrangement& geometry) const {
        return geometry.has_room(asked_lines_.size(), asked_points_.size());
    }
    /// The shared id of a line or point, which may be local; handed over now if nobody asked
    /// before.
    LineId shared_line(LineId id) {
        if (id < kLocal) return id;
        const LineId shared = line_ids_[static_cast<std::size_t>(id - kLocal)];
        return shared >= 0 ? shared : shared_local_line(id);
    }
    DirectedLine shared_directed(DirectedLine id) {
        return directed(shared_line(line_of(id)), is_reversed(id));
    }
    PointId shared_point(PointId id) {
        if (id < kLocal) return id;
        const PointId shared = point_ids_[static_cast<std::size_t>(id - kLocal)];
        return shared >= 0 ? shared : shared_local_point(id);
    }

private:
    /// Instead of a shared id.
    static constexpr std::int32_t kKept = -1, kAsked = -2;
    static bool is_kept(const std::vector<std::int32_t>& ids, std::int32_t id) {
        const auto local = static_cast<std::size_t>(id - kLocal);
        return local >= ids.size() || ids[local] == kKept;
    }
    void ask_for_local_line(LineId id);
    void ask_for_local_point(PointId id);
    LineId shared_local_line(LineId id);
    PointId shared_local_point(PointId id);
    int filtered_side(const LineFilter& line, const Point& point) const;
    bool vanishes(const LineFilter& edge, const Point& vertex) const;
    bool runs_along(const LineFilter& edge, const Point& crossing) const;
    int exact_side(const Line& line, PointId point);
    bool on_trace_by_name(PlaneId a, PlaneId b, const Point& point) const;
    NearPoint near(const Point& point) const;
    void locate(Point& point);

    const PlanArrangement& shared_;
    std::vector<Line> lines_;
    std::vector<LineFilter> filters_;
    std::vector<Point> points_;
    KeyTable line_table_, point_table_;
    PlanArrangement* receiver_ = nullptr;
    std::vector<LineId> line_ids_;  ///< shared ones, or kKept or kAsked
    std::vector<PointId> point_ids_;
    std::vector<std::int32_t> asked_lines_, asked_points_;  ///< local, in order
    std::uint64_t decisions_ = 0, exact_ = 0;
};

}  // namespace realmodel::exact
