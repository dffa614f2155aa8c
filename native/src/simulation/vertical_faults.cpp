// SPDX-License-Identifier: GPL-3.0-or-later
#include "simulation/vertical_faults.hpp"

#include <algorithm>
#include <cmath>

#include "base/index.hpp"
#include "base/vectors.hpp"
#include "realmodel/base/elementary.hpp"
#include "simulation/column_heights.hpp"

namespace realmodel::simulation {

namespace {

/// Lines are moved by about an edge length where they are simplified.
constexpr double kReach = 1.5;
/// Of its area, in plan: a face with less is vertical but for the rounding of its vertices.
constexpr double kUpright = 1e-6;
constexpr double kSame = 1e-9;  ///< of an edge: distances that differ by less are the same

struct Nearest {
    double distance, share;  ///< of the way along a line
};

Nearest nearest_on(const std::array<PlanPoint, 2>& line, const PlanPoint& p) {
    const double share = nearest_share(line[0], line[1], p);
    return {distance(p, moved(line[0], share, minus(line[1], line[0]))), share};
}

bool is_upright(const ComplexView& model, std::size_t face) {
    const auto loop = model.face(face);
    const Vec3 area =
        polygon_normal(loop.size(), [&](std::size_t i) { return model.vertex(loop[i]); });
    return std::abs(area[2]) < kUpright * elementary::hypot(area[0], area[1]);
}

PlanPoint farthest_from(const ComplexView& model, std::span<const std::int32_t> loop,
                        const PlanPoint& from) {
    PlanPoint found = from;
    double most = 0;
    for (const std::int32_t v : loop) {
        const PlanPoint p = plan_of(model, v);
        const double own = distance(from, p);
        if (own <= most) continue;
        most = own;
        found = p;
    }
    return found;
}

spatial::Box plan_box(std::span<const PlanPoint> points, double by) {
    spatial::Box box;
    for (const PlanPoint& p : points)
        box.include(spatial::Box::Position{p[0], p[1], 0.0});
    box.widen(by);
    return box;
}

template <class Rows, class LineOf>
spatial::BoxTree tree_of(const Rows& rows, const LineOf& line_of) {
    std::vector<spatial::Box> boxes;
    for (const auto& row : rows)
        boxes.push_back(plan_box(line_of(row), 0));
    return spatial::BoxTree(std::move(boxes));
}

}  // namespace

VerticalFaults::VerticalFaults(const ComplexView& model,
                               std::span<const std::array<PlanPoint, 2>> steps)
    : model_(model),
      steps_(steps),
      faces_([&] {
          std::vector<Face> found;
          for (std::size_t f = 0; f < model.face_count(); ++f) {
              if (model.face_surface[f] < 0 || !is_upright(model, f)) continue;
              const auto loop = model.face(f);
              const PlanPoint end = farthest_from(model, loop, plan_of(model, loop[0]));
              const std::array<PlanPoint, 2> line{end, farthest_from(model, loop, end)};
              found.push_back({static_cast<std::int32_t>(f), line});
          }
          return found;
      }()),
      face_tree_(tree_of(
          faces_, [](const Face& face) -> const auto& { return face.line; })),
      step_tree_(tree_of(
          faces_.empty() ? std::span<const std::array<PlanPoint, 2>>() : steps_,
          [](const auto& step) -> const auto& { return step; })) {}

std::int32_t VerticalFaults::fault_at(const PlanPoint& from, const PlanPoint& to,
                                      double height) const {
    const PlanPoint middle{(from[0] + to[0]) / 2, (from[1] + to[1]) / 2};
    const double edge = distance(from, to);
    const spatial::Box box = plan_box(std::array<PlanPoint, 1>{middle}, kReach * edge);
    double least = kReach * edge;
    face_tree_.find(box, [&](std::int32_t n) {
        least = std::min(least, nearest_on(faces_[index(n)].line, middle).distance);
    });
    bool is_other = false;
    step_tree_.find(box, [&](std::int32_t n) {
        is_other = is_other || nearest_on(steps_[index(n)], middle).distance < least - kSame * edge;
    });
    if (is_other) return kWall;
    std::int32_t found = kWall;
    face_tree_.find(box, [&](std::int32_t n) {
        const Face& face = faces_[index(n)];
        const Nearest near = nearest_on(face.line, middle);
        if (near.distance <= least + kSame * edge &&
            reaches(face, near.share, height, kSame * edge))
            found = std::max(found, model_.face_surface[index(face.number)]);
    });
    return found;
}

/// Whether a face has this height, at a share of its way in plan.
bool VerticalFaults::reaches(const Face& face, double share, double height, double rounding) const {
    const auto loop = model_.face(index(face.number));
    const PlanPoint way = minus(face.line[1], face.line[0]);
    const auto share_of = [&](const Vec3& p) {
        return dot(minus({p[0], p[1]}, face.line[0]), way) / dot(way, way);
    };
    double low = HUGE_VAL, high = -HUGE_VAL;
    const auto include = [&](double z) {
        low = std::min(low, z);
        high = std::max(high, z);
    };
    auto p = model_.vertex(loop.back());
    double s = share_of(p);
    for (const std::int32_t v : loop) {
        const auto q = model_.vertex(v);
        const double t = share_of(q);
        if (std::abs(t - share) <= kSame) include(q[2]);
        if (std::min(s, t) < share && share < std::max(s, t))
            include(p[2] + (share - s) / (t - s) * (q[2] - p[2]));
        p = q;
        s = t;
    }
    return low - rounding <= height && height <= high + rounding;
}

}  // namespace realmodel::simulation
