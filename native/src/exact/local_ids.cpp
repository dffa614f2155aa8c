// SPDX-License-Identifier: GPL-3.0-or-later
#include "exact/local_ids.hpp"

namespace realmodel::exact {

void LocalIds::reserve_ids(PlanArrangement& receiver) {
    receiver_ = &receiver;
    appended_ = receiver.append(lines_.marked().size(), points_.marked().size());
}

/// A local point whose lines are known by their shared ids.
Point LocalIds::with_shared_lines(PointId id) {
    Point point = points_[id];
    point.first = shared_line(point.first);
    point.second = shared_line(point.second);
    return point;
}

void LocalIds::write_marked() {
    lines_.make_shared_ids();
    points_.make_shared_ids();
    LineId line = appended_.line;
    for (const LineId local : lines_.marked()) {
        receiver_->set_line(line, lines_[local]);
        lines_.shared(local) = line;
        ++line;
    }
    PointId point = appended_.point;
    for (const PointId local : points_.marked()) {
        receiver_->set_point(point, with_shared_lines(local));
        points_.shared(local) = point;
        ++point;
    }
}

LineId LocalIds::add_line_by_name(LineId id) {
    assert(receiver_ != nullptr);
    return lines_.shared(id) = receiver_->add_line(lines_[id]);
}

PointId LocalIds::add_point_by_name(PointId id) {
    assert(receiver_ != nullptr);
    return points_.shared(id) = receiver_->add_point(with_shared_lines(id));
}

}  // namespace realmodel::exact
