// SPDX-License-Identifier: GPL-3.0-or-later
#include "exact/local_ids.hpp"

namespace realmodel::exact {

LineId LocalIds::find_or_add_trace(PlaneId first, PlaneId second) {
    const Line trace{Line::Kind::kTrace, first, second};
    const auto found = line_table_.insert(line_key_of(trace), [&](std::int32_t number) {
        return line_key_of(lines_[static_cast<std::size_t>(number)]);
    });
    if (found.is_new) {
        lines_.push_back(trace);
        filters_.push_back(shared_.trace_filter(first, second));
    }
    return kLocal + found.number;
}

void LocalIds::mark_local_line(LineId id) {
    if (line_ids_.size() < lines_.size()) line_ids_.resize(lines_.size(), kUnmarked);
    line_ids_[local_index(id)] = kMarked;
    marked_lines_.push_back(id - kLocal);
}

void LocalIds::mark_local_point(PointId id) {
    if (point_ids_.size() < points_.size()) point_ids_.resize(points_.size(), kUnmarked);
    point_ids_[local_index(id)] = kMarked;
    marked_points_.push_back(id - kLocal);
    const Point& point = points_[local_index(id)];
    mark_line_used(point.first);
    mark_line_used(point.second);
}

void LocalIds::reserve_ids(PlanArrangement& receiver) {
    receiver_ = &receiver;
    appended_ = receiver.append(marked_lines_.size(), marked_points_.size());
}

void LocalIds::write_marked() {
    line_ids_.resize(lines_.size(), kUnmarked);
    point_ids_.resize(points_.size(), kUnmarked);
    LineId line = appended_.line;
    for (const std::int32_t local : marked_lines_) {
        receiver_->set_line(line, lines_[static_cast<std::size_t>(local)]);
        line_ids_[static_cast<std::size_t>(local)] = line++;
    }
    PointId point = appended_.point;
    for (const std::int32_t local : marked_points_) {
        Point own = points_[static_cast<std::size_t>(local)];
        own.first = shared_line(own.first);
        own.second = shared_line(own.second);
        receiver_->set_point(point, own);
        point_ids_[static_cast<std::size_t>(local)] = point++;
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
