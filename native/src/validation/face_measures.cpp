// SPDX-License-Identifier: GPL-3.0-or-later
#include "validation/face_measures.hpp"

#include <cmath>

#include "base/vectors.hpp"
#include "validation/chunked.hpp"
#include "validation/face_shape.hpp"

namespace realmodel::validation {

namespace {

using Position = std::array<double, 3>;

/// A corner of each cell.
std::vector<std::int32_t> cell_origins(const ComplexView& model, const SidesByCell& sides,
                                       const Execution& execution) {
    std::vector<std::int32_t> origin(model.cell_count());
    parallel_each(origin.size(), execution, [&](std::size_t c) {
        origin[c] = model.face(face_of(sides[c].front())).front();
    });
    return origin;
}

/// A unit in the last place of the largest coordinate on each axis.
Position coordinate_steps(const ComplexView& model) {
    Position largest{0, 0, 0};
    for (std::size_t i = 0; i < model.vertices.size(); i += 3) {
        for (std::size_t axis = 0; axis < 3; ++axis)
            largest[axis] = std::max(largest[axis], std::abs(model.vertices[i + axis]));
    }
    return {last_place(largest[0]), last_place(largest[1]), last_place(largest[2])};
}

}  // namespace

FaceMeasures::FaceMeasures(const ComplexView& model, const SidesByCell& sides,
                           const Execution& execution)
    : measures_(model.face_count()) {
    const auto origin = cell_origins(model, sides, execution);
    const Position step = coordinate_steps(model);
    findings_ = in_chunks(
        model.face_count(), execution, [&](std::size_t begin, std::size_t end, Findings& found) {
            FaceShape shape(model);
            for (std::size_t f = begin; f < end; ++f) {
                shape.load(f);
                const Position& area = shape.doubled_area();
                const Position& first = shape.corner(0);
                FaceMeasure& measure = measures_[f];
                for (std::size_t side = 0; side < 2; ++side) {
                    const std::int32_t cell = model.cell(f, side);
                    if (cell < 0) continue;
                    const Position o = model.vertex(origin[static_cast<std::size_t>(cell)]);
                    const double volume = dot(minus(first, o), area) / 6;
                    measure.volume[side] = side == 0 ? volume : -volume;
                }
                measure.rounding = (std::abs(area[0]) * step[0] + std::abs(area[1]) * step[1] +
                                    std::abs(area[2]) * step[2]) /
                                   2;
                const auto fault = shape.fault();
                if (!fault) continue;
                found.fail([&] {
                    return Offender{.text = "face " + std::to_string(f) + " " + *fault,
                                    .cell = model.cell(f, 0),
                                    .face = static_cast<std::int64_t>(f),
                                    .place = first};
                });
            }
        });
    findings_.examined = static_cast<std::int64_t>(model.face_count());
}

}  // namespace realmodel::validation
