// SPDX-License-Identifier: GPL-3.0-or-later
#include "validation/model_columns.hpp"

#include <algorithm>
#include <cmath>

#include "base/index.hpp"
#include "exact/double_double_interval.hpp"
#include "exact/orient2d.hpp"
#include "spatial/point_bins.hpp"
#include "validation/chunked.hpp"
#include "validation/plan_tests.hpp"

namespace realmodel::validation {

using exact::DoubleDoubleInterval;

namespace {

/// A face's corners, and its loop seen from above.
class FaceInPlan {
public:
    explicit FaceInPlan(const ComplexView& model) : model_(model) {}

    void load(std::size_t face) {
        const auto loop = model_.face(face);
        corners.resize(loop.size());
        plan.resize(loop.size());
        for (std::size_t i = 0; i < loop.size(); ++i) {
            corners[i] = model_.vertex(loop[i]);
            plan[i] = {corners[i][0], corners[i][1]};
        }
    }

    /// The height of the face at a place within it: of the triangle of its fan there.
    double height(const PlanPosition& place) const {
        for (std::size_t i = 1; i + 1 < corners.size(); ++i) {
            const int a = exact::orient2d(plan[0], plan[i], place);
            const int b = exact::orient2d(plan[i], plan[i + 1], place);
            const int c = exact::orient2d(plan[i + 1], plan[0], place);
            if (exact::orient2d(plan[0], plan[i], plan[i + 1]) == 0) continue;
            if ((a >= 0 && b >= 0 && c >= 0) || (a <= 0 && b <= 0 && c <= 0))
                return triangle_height(i, place);
        }
        return corners[0][2];
    }

    std::vector<std::array<double, 3>> corners;
    std::vector<PlanPosition> plan;

private:
    // to twice the precision of doubles, for needles
    double triangle_height(std::size_t i, const PlanPosition& place) const {
        const auto &o = corners[0], &p = corners[i], &q = corners[i + 1];
        const auto d = [&](double a, double b) { return DoubleDoubleInterval::difference(a, b); };
        const DoubleDoubleInterval ux = d(p[0], o[0]), uy = d(p[1], o[1]), vx = d(q[0], o[0]),
                                   vy = d(q[1], o[1]);
        const DoubleDoubleInterval wx = d(place[0], o[0]), wy = d(place[1], o[1]);
        const DoubleDoubleInterval area = ux * vy - uy * vx;
        const DoubleDoubleInterval s = (wx * vy - wy * vx) / area, t = (ux * wy - uy * wx) / area;
        return (DoubleDoubleInterval(o[2]) + s * d(p[2], o[2]) + t * d(q[2], o[2])).high;
    }

    const ComplexView& model_;
};

bool same_stretch(const WallSample& wall, const PlanPosition& p, const PlanPosition& q) {
    return (wall.from == p && wall.to == q) || (wall.from == q && wall.to == p);
}

}  // namespace

ModelColumns::ModelColumns(const ComplexView& model, const Probes& probes,
                           const PlanRounding& rounding, const Execution& execution)
    : near_edge_(probes.probes.size(), 0), coincident_(probes.walls.size(), 0) {
    const std::size_t count = probes.probes.size();
    std::vector<PlanPosition> places;
    for (const Probe& probe : probes.probes)
        places.push_back(probe.place);
    for (const WallSample& wall : probes.walls)
        places.push_back(wall.middle);
    const spatial::PointBins bins(places);
    const double beside = rounding.step + rounding.near;
    std::vector<std::vector<Crossing>> found((model.face_count() + kItemsOfChunk - 1) /
                                             kItemsOfChunk);
    parallel_ranges(
        model.face_count(), kItemsOfChunk, execution, [&](std::size_t begin, std::size_t end) {
            auto& own = found[begin / kItemsOfChunk];
            FaceInPlan face(model);
            const auto edge_passes = [&](std::size_t i, double reach, const auto& leave_out) {
                for (std::size_t k = 0; k < face.plan.size(); ++k) {
                    const PlanPosition& p = face.plan[k];
                    const PlanPosition& q = face.plan[k + 1 < face.plan.size() ? k + 1 : 0];
                    if (p != q && !leave_out(p, q) && passes(p, q, places[i], reach)) return true;
                }
                return false;
            };
            for (std::size_t f = begin; f < end; ++f) {
                face.load(f);
                const spatial::PlanBox box = spatial::box_around(face.plan).widened(beside);
                bins.within(box, [&](std::size_t i, const PlanPosition&) {
                    if (i >= count) {
                        const WallSample& wall = probes.walls[i - count];
                        const auto its_own = [&](const auto& p, const auto& q) {
                            return same_stretch(wall, p, q);
                        };
                        if (edge_passes(i, beside, its_own)) mark(coincident_[i - count]);
                        return;
                    }
                    const auto none = [](const auto&, const auto&) { return false; };
                    if (edge_passes(i, rounding.near, none)) mark(near_edge_[i]);
                    const int turns = winding(face.plan, places[i]);
                    if (turns == 0) return;
                    const bool up = turns > 0;
                    own.push_back({static_cast<std::int32_t>(i), static_cast<std::int32_t>(f),
                                   model.cell(f, up ? 0 : 1), model.cell(f, up ? 1 : 0),
                                   face.height(places[i])});
                });
            }
        });
    crossings_ = bucketize<Crossing>(count, [&](const auto& put) {
        for (const auto& part : found) {
            for (const Crossing& c : part)
                put(index(c.probe), c);
        }
    });
}

}  // namespace realmodel::validation
