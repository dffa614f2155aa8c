// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cassert>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "base/key_table.hpp"
#include "exact/plan_arrangement.hpp"

namespace realmodel::exact {

/// The lines and points that one thread finds, under ids from kLocal on until those that are needed
/// are committed: they are appended to the arrangement that all share.
class LocalIds {
public:
    explicit LocalIds(const PlanArrangement& shared) : shared_(shared) {}
    LocalIds(const LocalIds&) = delete;
    LocalIds& operator=(const LocalIds&) = delete;

    const PlanArrangement& shared() const { return shared_; }
    const Line& line(LineId id) const {
        return is_local(id) ? lines_[local_index(id)] : shared_.line(id);
    }
    LineFilter filter(LineId id) const {
        return is_local(id) ? filters_[local_index(id)] : shared_.filter(id);
    }
    const Point& point(PointId id) const {
        return is_local(id) ? points_[local_index(id)] : shared_.point(id);
    }
    bool is_vertex(PointId id) const { return shared_.is_vertex(id); }
    VertexId vertex(PointId id) const { return shared_.vertex(id); }

    /// Makes room for so many points at once.
    void expect_points(std::size_t count) {
        points_.reserve(count);
        point_table_.reserve(count);
    }

    /// Marks a line or point, which may be local, as needed.
    void mark_line_used(LineId id) {
        if (is_local(id) && is_unmarked(line_ids_, id)) mark_local_line(id);
    }
    void mark_point_used(PointId id) {
        if (is_local(id) && is_unmarked(point_ids_, id)) mark_local_point(id);
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
        return receiver.has_room(marked_lines_.size(), marked_points_.size());
    }
    /// The shared id of a line or point, which may be local; after commit(). One that was not
    /// marked is found by name, or added now, which only one thread may do.
    LineId shared_line(LineId id) {
        if (!is_local(id)) return id;
        const LineId shared = line_ids_[local_index(id)];
        return shared.has_value() ? shared : add_line_by_name(id);
    }
    DirectedLine shared_directed(DirectedLine id) {
        return DirectedLine(shared_line(id.id()), id.is_reversed());
    }
    PointId shared_point(PointId id) {
        if (!is_local(id)) return id;
        const PointId shared = point_ids_[local_index(id)];
        return shared.has_value() ? shared : add_point_by_name(id);
    }

protected:
    ~LocalIds() = default;

    /// The local trace of two planes, by name.
    LineId find_or_add_trace(PlaneId first, PlaneId second);
    /// The local point with a name; located(point) gives a new one its position.
    template <class Locate>
    PointId find_or_add_point(Point& point, const Locate& locate) {
        const auto found = point_table_.insert(point_key_of(point), [&](std::int32_t number) {
            return point_key_of(points_[static_cast<std::size_t>(number)]);
        });
        if (found.is_new) {
            locate(point);
            points_.push_back(point);
        }
        return PointId(kLocal + found.number);
    }

    const PlanArrangement& shared_;

private:
    /// Instead of a shared id: there will be one.
    template <class SomeId>
    static constexpr SomeId kMarked{-2};

    template <class SomeId>
    static std::size_t local_index(SomeId id) {
        return index(id.number() - kLocal);
    }
    template <class SomeId>
    static bool is_unmarked(const std::vector<SomeId>& ids, SomeId id) {
        return local_index(id) >= ids.size() || ids[local_index(id)] == kNone;
    }
    void mark_local_line(LineId id);
    void mark_local_point(PointId id);
    LineId add_line_by_name(LineId id);
    PointId add_point_by_name(PointId id);

    std::vector<Line> lines_;
    std::vector<LineFilter> filters_;
    std::vector<Point> points_;
    KeyTable line_table_, point_table_;
    PlanArrangement* receiver_ = nullptr;
    PlanArrangement::Appended appended_;
    std::vector<LineId> line_ids_;  ///< shared ones; none where not marked
    std::vector<PointId> point_ids_;
    std::vector<LineId> marked_lines_;  ///< in the order of marking
    std::vector<PointId> marked_points_;
};

}  // namespace realmodel::exact
