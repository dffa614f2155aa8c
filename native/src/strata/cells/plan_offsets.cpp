// SPDX-License-Identifier: GPL-3.0-or-later
#include "strata/cells/plan_offsets.hpp"

#include <algorithm>

#include "base/parallel.hpp"
#include "base/ulp.hpp"
#include "strata/cells/exact_places.hpp"

namespace realmodel::strata {

namespace {

constexpr std::size_t kOffsets = 1 << 12;

/// Whether a unit in the last place of the coordinates is so large a part of the model's extent
/// that a volume may be off by as much: some 1e-13.
bool is_far_from_origin(const PlanVertices& plan_vertices) {
    const auto& positions = plan_vertices.position;
    const PlanBox box = spatial::box_around({positions.begin(), positions.end()});
    const double unit =
        std::max({ulp(box.low_x), ulp(box.low_y), ulp(box.high_x), ulp(box.high_y)});
    return unit > std::min(box.width(), box.height()) * 0x1p-43;
}

/// Whether an offset from a coordinate is known to a small part of it.
bool is_close(const exact::DoubleDoubleInterval& offset, double coordinate) {
    return offset.error < 0x1p-20 * ulp(coordinate);
}

}  // namespace

Array<PlanOffset> find_plan_offsets(const exact::PlanArrangement& geometry,
                                    const PlanVertices& plan_vertices, const Execution& execution) {
    Array<PlanOffset> offsets;
    if (!is_far_from_origin(plan_vertices)) return offsets;
    offsets.resize(plan_vertices.size());
    parallel_ranges(offsets.size(), kOffsets, execution, [&](std::size_t begin, std::size_t end) {
        using Number = exact::DoubleDoubleInterval;
        const exact::LocalArrangement scope(geometry);
        const exact::BallArithmetic in{geometry};
        const ExactPlaces places(geometry);
        for (std::size_t p = begin; p < end; ++p) {
            offsets[p] = {0, 0};
            const PointId point = plan_vertices.representative[p];
            if (geometry.is_vertex(point)) continue;
            const auto origin = exact::anchor(geometry, geometry.line(geometry.point(point).first));
            const exact::Point& o = geometry.point(origin);
            const auto h = exact::position_of<Number>(in, scope, point, origin);
            const auto [x, y] = plan_vertices.position[p];
            const Number off_x = h.x / h.w + Number::difference(o.x, x),
                         off_y = h.y / h.w + Number::difference(o.y, y);
            if (is_close(off_x, x) && is_close(off_y, y)) {
                offsets[p] = {static_cast<float>(off_x.high), static_cast<float>(off_y.high)};
                continue;
            }
            const auto at = places.plan(point);
            offsets[p] = {static_cast<float>(nearest(at[0] - x)),
                          static_cast<float>(nearest(at[1] - y))};
        }
    });
    return offsets;
}

Array<PlanOffset> vertex_offsets(const Array<PlanOffset>& offsets,
                                 const PlanVertices& plan_vertices, const ConformedFaces& conformed,
                                 const Execution& execution) {
    Array<PlanOffset> result;
    if (offsets.empty()) return result;
    result.resize(conformed.positions.size());
    parallel_each(offsets.size(), execution, [&](std::size_t p) {
        const auto [x, y] = plan_vertices.position[p];
        for (auto v = conformed.vertex_offsets[p]; v < conformed.vertex_offsets[p + 1]; ++v) {
            const auto& moved = conformed.positions[static_cast<std::size_t>(v)];
            result[static_cast<std::size_t>(v)] = {
                offsets[p][0] + static_cast<float>(x - moved[0]),
                offsets[p][1] + static_cast<float>(y - moved[1])};
        }
    });
    return result;
}

void renumber(Array<PlanOffset>& offsets, const std::vector<std::int32_t>& number) {
    std::size_t count = 0;
    for (std::size_t v = 0; v < offsets.size(); ++v) {
        if (number[v] < 0) continue;
        offsets[static_cast<std::size_t>(number[v])] = offsets[v];
        ++count;
    }
    offsets.resize(count);
}

}  // namespace realmodel::strata
