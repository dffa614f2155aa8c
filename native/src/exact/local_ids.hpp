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
        return id < kLocal ? shared_.line(id) : lines_[local_index(id)];
    }
    LineFilter filter(LineId id) const {
        return id < kLocal ? shared_.filter(id) : filters_[local_index(id)];
    }
    const Point& point(PointId id) const {
        return id < kLocal ? shared_.point(id) : points_[local_index(id)];
    }
    bool is_vertex(PointId id) const { return id < shared_.vertex_count(); }

    /// Makes room for so many points at once.
    void expect_points(std::size_t count) {
        points_.reserve(count);
        point_table_.reserve(count);
    }

    /// Marks a line or point, which may be local, as needed.
    void mark_line_used(LineId id) {
        if (id >= kLocal && is_unmarked(line_ids_, id)) mark_local_line(id);
    }
    void mark_point_used(PointId id) {
        if (id >= kLocal && is_unmarked(point_ids_, id)) mark_local_point(id);
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
        if (id < kLocal) return id;
        const LineId shared = line_ids_[local_index(id)];
        return shared >= 0 ? shared : add_line_by_name(id);
    }
    DirectedLine shared_directed(DirectedLine id) {
        return directed(shared_line(line_of(id)), is_reversed(id));
    }
    PointId shared_point(PointId id) {
        if (id < kLocal) return id;
        const PointId shared = point_ids_[local_index(id)];
        return shared >= 0 ? shared : add_point_by_name(id);
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
        return kLocal + found.number;
    }

    const PlanArrangement& shared_;

private:
    /// Instead of a shared id.
    static constexpr std::int32_t kUnmarked = -1, kMarked = -2;

    static std::size_t local_index(std::int32_t id) {
        assert(id >= kLocal);
        return static_cast<std::size_t>(id - kLocal);
    }
    static bool is_unmarked(const std::vector<std::int32_t>& ids, std::int32_t id) {
        return local_index(id) >= ids.size() || ids[local_index(id)] == kUnmarked;
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
    PlanArrangement::Appended appended_{0, 0};
    std::vector<LineId> line_ids_;  ///< shared ones, or kUnmarked or kMarked
    std::vector<PointId> point_ids_;
    std::vector<std::int32_t> marked_lines_, marked_points_;  ///< indices, in the order of marking
};

}  // namespace realmodel::exact
