// SPDX-License-Identifier: GPL-3.0-or-later
#include "realmodel/validation/cells_at.hpp"

#include <algorithm>

#include "base/algorithms.hpp"
#include "exact/space_points.hpp"
#include "spatial/plan_tiles.hpp"

namespace realmodel::validation {

namespace {

/// How often a ray upward from a position leaves a cell through a face: 1 or -1.
struct Passage {
    std::size_t position;
    std::int32_t cell;
    std::int32_t times;
};

}  // namespace

std::vector<std::int32_t> cells_at(const ComplexView& model,
                                   std::span<const std::array<double, 3>> positions,
                                   const Execution& execution) {
    std::vector<spatial::PlanPosition> plan;
    for (const auto& p : positions)
        plan.push_back({p[0], p[1]});
    const spatial::PointBins bins(plan);
    const auto look = [&](std::size_t face, std::vector<Passage>& passages) {
        const auto loop = model.face(face);
        spatial::PlanBox box = spatial::kNoBox;
        for (const std::int32_t v : loop) {
            const auto [x, y, z] = model.vertex(v);
            box = box.united({x, y, x, y});
        }
        bins.within(box, [&](std::size_t position, const spatial::PlanPosition&) {
            exact::SpacePoints points;
            const exact::SpacePointId p = points.add(positions[position]);
            std::vector<exact::SpacePointId> corners;
            for (const std::int32_t v : loop)
                corners.push_back(points.add(model.vertex(v)));
            int times = 0;
            for (std::size_t i = 1; i + 1 < corners.size(); ++i)
                times += exact::ray_crosses(points, 2, p, {corners[0], corners[i], corners[i + 1]},
                                            false);
            for (std::size_t side = 0; side < 2; ++side) {
                if (times != 0 && model.cell(face, side) >= 0)
                    passages.push_back(
                        {position, model.cell(face, side), side == 0 ? times : -times});
            }
        });
    };
    auto all = collect_items<Passage>(model.face_count(), execution, look);
    const auto position_and_cell = [](const Passage& p) { return std::pair{p.position, p.cell}; };
    std::ranges::sort(all, {}, position_and_cell);
    std::vector<std::int32_t> cells(positions.size(), -1);
    for (const auto passages : groups_of(all, position_and_cell)) {
        std::int32_t times = 0;
        for (const Passage& passage : passages)
            times += passage.times;
        std::int32_t& cell = cells[passages[0].position];
        if (times > 0 && cell < 0) cell = passages[0].cell;
    }
    return cells;
}

}  // namespace realmodel::validation
