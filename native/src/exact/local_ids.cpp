// SPDX-License-Identifier: GPL-3.0-or-later
#include "exact/local_ids.hpp"

namespace realmodel::exact {

LineId LocalIds::find_or_add_trace(PlaneId first, PlaneId second) {
    const Line trace(first, second);
    const auto found = line_table_.insert(
        trace.key(), [&](std::int32_t number) { return lines_[index(number)].key(); });
    if (found.is_new) {
        lines_.push_back(trace);
        filters_.push_back(shared_.trace_filter(first, second));
    }
    return LineId(kLocal + found.number);
}

void LocalIds::mark_local_line(LineId id) {
    if (line_ids_.size() < lines_.size()) line_ids_.resize(lines_.size(), kNone);
    line_ids_[local_index(id)] = kMarked<LineId>;
    marked_lines_.push_back(id);
}

void LocalIds::mark_local_point(PointId id) {
    if (point_ids_.size() < points_.size()) point_ids_.resize(points_.size(), kNone);
    point_ids_[local_index(id)] = kMarked<PointId>;
    marked_points_.push_back(id);
    const Point& point = points_[local_index(id)];
    mark_line_used(point.first);
    mark_line_used(point.second);
}

void LocalIds::reserve_ids(PlanArrangement& receiver) {
    receiver_ = &receiver;
    appended_ = receiver.append(marked_lines_.size(), marked_points_.size());
}

void LocalIds::write_marked() {
    line_ids_.resize(lines_.size(), kNone);
    point_ids_.resize(points_.size(), kNone);
    LineId line = appended_.line;
    for (const LineId local : marked_lines_) {
        receiver_->set_line(line, lines_[local_index(local)]);
        line_ids_[local_index(local)] = line;
        ++line;
    }
    PointId point = appended_.point;
    for (const PointId local : marked_points_) {
        Point own = points_[local_index(local)];
        own.first = shared_line(own.first);
        own.second = shared_line(own.second);
        receiver_->set_point(point, own);
        point_ids_[local_index(local)] = point;
        ++point;
    }
}

LineId LocalIds::add_line_by_name(LineId id) {
    assert(receiver_ != nullptr);
    LineId& shared = line_ids_[local_index(id)];
    shared = receiver_->add_line(lines_[local_index(id)]);
    return shared;
}

PointId LocalIds::add_point_by_name(PointId id) {
    assert(receiver_ != nullptr);
    Point own = points_[local_index(id)];
    own.first = shared_line(own.first);
    own.second = shared_line(own.second);
    PointId& shared = point_ids_[local_index(id)];
    shared = receiver_->add_point(own);
    return shared;
}

}  // namespace realmodel::exact
