// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cassert>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "base/key_table.hpp"
#include "exact/plan_arrangement.hpp"

namespace realmodel::exact {

/// Lines or points that one thread finds: the first has the id kLocal until it is shared.
template <class SomeId, class Thing>
class LocalThings {
public:
    const Thing& operator[](SomeId id) const { return things_[local_index(id)]; }
    /// The thing with a name; complete(thing) is called where it is new.
    template <class Complete>
    SomeId find_or_add(Thing& thing, const Complete& complete) {
        const auto entry = table_.insert(
            thing.key(), [&](std::int32_t number) { return things_[index(number)].key(); });
        if (entry.is_new) {
            complete(thing);
            things_.push_back(thing);
        }
        return SomeId(kLocal + entry.number);
    }
    void reserve(std::size_t count) {
        things_.reserve(count);
        table_.reserve(count);
    }

    /// Marks a thing as needed.
    /// @return whether it was not marked yet
    bool mark(SomeId id) {
        make_shared_ids();
        if (shared(id) != kNone) return false;
        shared(id) = SomeId(-2);
        marked_.push_back(id);
        return true;
    }
    const std::vector<SomeId>& marked() const { return marked_; }  ///< in the order of marking
    void make_shared_ids() { shared_.resize(things_.size(), kNone); }
    /// The shared id, below 0 where there is none.
    SomeId& shared(SomeId id) { return shared_[local_index(id)]; }

private:
    static std::size_t local_index(SomeId id) { return index(id.number() - kLocal); }

    std::vector<Thing> things_;
    KeyTable table_;
    std::vector<SomeId> shared_, marked_;
};

/// The lines and points that one thread finds, under ids of its own until those that are needed are
/// committed: they are appended to the arrangement that all share.
class LocalIds {
public:
    explicit LocalIds(const PlanArrangement& shared) : shared_(shared) {}
    LocalIds(const LocalIds&) = delete;
    LocalIds& operator=(const LocalIds&) = delete;

    const PlanArrangement& shared() const { return shared_; }
    const Line& line(LineId id) const { return is_local(id) ? lines_[id] : shared_.line(id); }
    LineFilter filter(LineId id) const {
        return is_local(id) ? filters_[index(id.number() - kLocal)] : shared_.filter(id);
    }
    const Point& point(PointId id) const { return is_local(id) ? points_[id] : shared_.point(id); }
    bool is_vertex(PointId id) const { return shared_.is_vertex(id); }
    VertexId vertex(PointId id) const { return shared_.vertex(id); }

    /// Makes room for so many points at once.
    void expect_points(std::size_t count) { points_.reserve(count); }

    /// Marks a line or point, which may be local, as needed.
    void mark_line_used(LineId id) {
        if (is_local(id)) lines_.mark(id);
    }
    void mark_point_used(PointId id) {
        if (!is_local(id) || !points_.mark(id)) return;
        mark_line_used(points_[id].first);
        mark_line_used(points_[id].second);
    }
    /// Appends the marked lines and points to the shared arrangement; the others stay behind.
    /// Nothing new may be found afterwards. In two steps: the ids in the order that is wanted, then
    /// the lines and points by any thread.
    void reserve_ids(PlanArrangement& receiver);
    void write_marked();
    void commit(PlanArrangement& receiver) {
        reserve_ids(receiver);
        write_marked();
    }
    /// Whether there is room for what is marked.
    bool has_room_in(const PlanArrangement& receiver) const {
        return receiver.has_room(lines_.marked().size(), points_.marked().size());
    }
    /// The shared id of a line or point, which may be local; after commit(). One that was not
    /// marked is found by name, or added now, which only one thread may do.
    LineId shared_line(LineId id) {
        if (!is_local(id)) return id;
        const LineId shared = lines_.shared(id);
        return shared.has_value() ? shared : add_line_by_name(id);
    }
    DirectedLine shared_directed(DirectedLine id) {
        return DirectedLine(shared_line(id.id()), id.is_reversed());
    }
    PointId shared_point(PointId id) {
        if (!is_local(id)) return id;
        const PointId shared = points_.shared(id);
        return shared.has_value() ? shared : add_point_by_name(id);
    }

protected:
    ~LocalIds() = default;

    /// The local trace of two planes, by name.
    LineId find_or_add_trace(PlaneId first, PlaneId second) {
        Line trace(first, second);
        return lines_.find_or_add(
            trace, [&](const Line&) { filters_.push_back(shared_.trace_filter(first, second)); });
    }

    const PlanArrangement& shared_;
    LocalThings<PointId, NamedPoint> points_;

private:
    LineId add_line_by_name(LineId id);
    PointId add_point_by_name(PointId id);
    Point with_shared_lines(PointId id);

    LocalThings<LineId, Line> lines_;
    std::vector<LineFilter> filters_;
    PlanArrangement* receiver_ = nullptr;
    PlanArrangement::Appended appended_;
};

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
/// are equally high there. An input edge or vertex is there; of a plane no more is known than that
/// it is as high as that one.
using HeightName = EdgeOrPlane;

/// One thread's view of the arrangement: all questions are asked here, and answered exactly. What
/// is shared is only read; lines and points that answers need are this thread's own (LocalIds).
class LocalArrangement : public LocalIds {
public:
    explicit LocalArrangement(const PlanArrangement& shared) : LocalIds(shared) {}
    ~LocalArrangement() { shared_.count_decisions(decisions_, exact_); }

    /// On which side of a directed line a point lies: 1 left, 0 on it, -1 right. The predicate that
    /// every decision comes down to: the sign of a 3 x 3 determinant of plan lines.
    int side(DirectedLine line, PointId point);
    /// The sign of the height of plane `upper` less that of plane `lower` above a point.
    int compare_heights(PlaneId upper, PlaneId lower, PointId point);
    /// The same with a given filter of their trace; the trace itself need not exist.
    int compare_heights(PlaneId upper, PlaneId lower, const LineFilter& trace, PointId point);
    /// Whether a point lies to the left of a line, or a trace, that need not exist; where floating
    /// point does not tell, it says no.
    bool is_left_for_certain(const LineFilter& line, PointId id) const {
        return filtered_side(line, point(id)) == 1;
    }
    /// Whether a point lies to the right of a trace by more than a difference of heights and many
    /// times what rounding makes of it.
    bool is_right_by(const LineFilter& trace, PointId id, double difference) const;
    /// Whether two points are in the same position.
    bool same_place(PointId a, PointId b);
    /// Whether two lines run through the same positions.
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

    /// The doubles nearest to a point's true coordinates: the same for every way to name the
    /// position.
    std::array<double, 2> rounded(PointId point);
    /// By what the height of a plane above a point is known; planes that are equally high may still
    /// have different names.
    HeightName height_name(PlaneId plane, PointId point) const;

    /// Where a point lies, as closely as is cheap to say; for several heights above it.
    NearPoint approximate(PointId point) const;
    /// The same of the crossing of two lines that need not be a point.
    NearPoint approximate_crossing(LineId a, LineId b) const { return approximate(Point{a, b}); }
    /// The double nearest to the height of a plane above a point.
    double rounded_height(PlaneId plane, PointId point);
    /// The same of a plane whose height there is known by a name.
    double rounded_height(PlaneId plane, const HeightName& name, PointId point,
                          const NearPoint& near);
    /// Slope and offset of a line, rounded: equal for lines that run through the same positions.
    std::array<double, 3> line_key(LineId line);

    /// Counts signs that were found without `side`.
    void count_decisions(std::size_t count) { decisions_ += count; }
    /// How many decisions floating point left to exact arithmetic here.
    std::uint64_t exact_decisions() const { return exact_; }

private:
    int filtered_side(const LineFilter& line, const Point& point) const;
    bool vanishes(const LineFilter& edge, const Point& vertex) const;
    bool runs_along(const LineFilter& edge, const Point& crossing) const;
    int exact_side(const Line& line, PointId point);
    std::optional<int> compare_corners(PlaneId upper, PlaneId lower, VertexId vertex) const;
    bool on_trace_by_name(PlaneId a, PlaneId b, const Point& point) const;
    NearPoint approximate(const Point& point) const;
    void locate(Point& point);

    std::uint64_t decisions_ = 0, exact_ = 0;
};

}  // namespace realmodel::exact
