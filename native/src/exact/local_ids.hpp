// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cassert>
#include <cstddef>
#include <cstdint>
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
        const auto found = table_.insert(
            thing.key(), [&](std::int32_t number) { return things_[index(number)].key(); });
        if (found.is_new) {
            complete(thing);
            things_.push_back(thing);
        }
        return SomeId(kLocal + found.number);
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

}  // namespace realmodel::exact
