// SPDX-License-Identifier: GPL-3.0-or-later
#include "strata/cells/exact_positions.hpp"

#include <algorithm>
#include <array>

#include "base/algorithms.hpp"
#include "base/floating_point.hpp"
#include "base/parallel.hpp"
#include "exact/arithmetic.hpp"
#include "strata/conform/plan_vertices.hpp"

namespace realmodel::strata {

using exact::PlanArrangement;

namespace {

/// Whole multiples of a fraction of a power of two.
mpq_class fraction(const mpz_class& numerator, const mpz_class& denominator, int exponent) {
    mpq_class result(numerator, denominator);
    result.canonicalize();
    if (exponent < 0) return result >> static_cast<unsigned>(-exponent);
    return result << static_cast<unsigned>(exponent);
}

/// Exact coordinates of points and heights, as reduced fractions.
class ExactPositions {
public:
    explicit ExactPositions(const exact::PlanArrangement& geometry)
        : geometry_(geometry), in_{geometry}, scope_(geometry) {}

    std::array<mpq_class, 2> plan(PointId id) const {
        const int unit = geometry_.plan_exponent();
        if (geometry_.is_vertex(id)) {
            const exact::Point& p = geometry_.point(id);
            return {fraction(in_.plan(p.x), 1, unit), fraction(in_.plan(p.y), 1, unit)};
        }
        const exact::VertexId origin =
            exact::anchor(geometry_, scope_.line(scope_.point(id).first));
        const exact::Point& o = geometry_.point(origin);
        const auto h = exact::position_of<mpz_class>(in_, scope_, id, origin);
        return {fraction(h.x + in_.plan(o.x) * h.w, h.w, unit),
                fraction(h.y + in_.plan(o.y) * h.w, h.w, unit)};
    }
    mpq_class height(PlaneId plane, PointId id) const {
        const exact::SpaceVertex& corner = geometry_.space(geometry_.plane(plane).corner[0]);
        const auto n = exact::plane_normal<mpz_class>(in_, geometry_, plane);
        const auto h = exact::position_of<mpz_class>(in_, scope_, id, corner.plan);
        const mpz_class w = n.c * h.w;
        return fraction(in_.height(corner.z) * w - n.a * h.x - n.b * h.y, w,
                        geometry_.height_exponent());
    }

private:
    const exact::PlanArrangement& geometry_;
    exact::IntegerArithmetic in_;
    exact::LocalArrangement scope_;
};

double nearest(const mpq_class& value) {
    return exact::nearest_double(value.get_num(), value.get_den(), 0);
}

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
        const exact::DoubleDoubleArithmetic in{geometry};
        const ExactPositions exactly(geometry);
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
            const auto at = exactly.plan(point);
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
    parallel_for_each(offsets.size(), execution, [&](std::size_t p) {
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

namespace {

constexpr std::array<std::array<double Window::*, 2>, 2> kLines{
    {{&Window::low_x, &Window::high_x}, {&Window::low_y, &Window::high_y}}};

bool is_on_line(const Window& window, std::size_t axis, double coordinate) {
    return coordinate == window.*kLines[axis][0] || coordinate == window.*kLines[axis][1];
}

/// The plan vertices that are on lines when rounded, as all are that are there exactly.
std::vector<TileBorder::PlanVertex> plan_vertices_on(const Window& window,
                                                     const PlanVertices& plan_vertices) {
    std::vector<TileBorder::PlanVertex> vertices;
    for (std::size_t p = 0; p < plan_vertices.size(); ++p) {
        const auto [x, y] = plan_vertices.position[p];
        const std::array is_on{is_on_line(window, 0, x), is_on_line(window, 1, y)};
        if (is_on[0] || is_on[1]) vertices.push_back({static_cast<PlanVertexId>(p), is_on});
    }
    return vertices;
}

/// For each vertex from the first one of each of some plan vertices on, a plane that it lies in.
std::vector<std::vector<PlaneId>> planes_at(const std::vector<TileBorder::PlanVertex>& on,
                                            const FaceList& faces,
                                            const ConformedFaces& conformed) {
    const auto first = [&](std::size_t i) {
        return conformed.vertex_offsets[static_cast<std::size_t>(on[i].number)];
    };
    const auto last = [&](std::size_t i) {
        return conformed.vertex_offsets[static_cast<std::size_t>(on[i].number) + 1];
    };
    std::vector<std::vector<PlaneId>> planes;
    std::vector<bool> is_asked(static_cast<std::size_t>(*(conformed.vertex_offsets.end() - 1)));
    for (std::size_t i = 0; i < on.size(); ++i) {
        planes.emplace_back(static_cast<std::size_t>(last(i) - first(i)), PlaneId(kNone));
        std::fill(is_asked.begin() + first(i), is_asked.begin() + last(i), true);
    }
    for (std::size_t f = 0; f < faces.size(); ++f) {
        for (auto e = conformed.face_offsets[f]; e < conformed.face_offsets[f + 1]; ++e) {
            const std::int32_t v = conformed.vertices[e];
            if (v < 0 || !is_asked[static_cast<std::size_t>(v)]) continue;
            is_asked[static_cast<std::size_t>(v)] = false;
            const auto after =
                std::upper_bound(on.begin(), on.end(), v, [&](std::int32_t vertex, const auto& p) {
                    return vertex < conformed.vertex_offsets[static_cast<std::size_t>(p.number)];
                });
            const auto i = static_cast<std::size_t>(after - on.begin()) - 1;
            planes[i][static_cast<std::size_t>(v - first(i))] = faces.plane[f];
        }
    }
    return planes;
}

}  // namespace

const TileBorder::PlanVertex* TileBorder::find(PlanVertexId number) const {
    const auto at =
        std::lower_bound(plan_vertices.begin(), plan_vertices.end(), number,
                         [](const PlanVertex& p, PlanVertexId other) { return p.number < other; });
    return at != plan_vertices.end() && at->number == number ? &*at : nullptr;
}

bool TileBorder::allows(std::size_t number, const PlanPosition& position) const {
    const PlanVertex* const vertex = find(static_cast<PlanVertexId>(number));
    for (std::size_t axis = 0; axis < 2; ++axis) {
        const double low = window.*kLines[axis][0], high = window.*kLines[axis][1];
        const bool is_on = position[axis] == low || position[axis] == high;
        const bool has_to_be = vertex != nullptr && vertex->is_on[axis];
        if (is_on != has_to_be || position[axis] < low || position[axis] > high) return false;
    }
    return true;
}

void TileBorder::renumber(const std::vector<std::int32_t>& number) {
    for (BorderVertex& vertex : vertices)
        vertex.vertex = number[static_cast<std::size_t>(vertex.vertex)];
    std::erase_if(vertices, [](const BorderVertex& vertex) { return vertex.vertex < 0; });
}

TileBorder find_tile_border(const PlanArrangement& geometry, const FaceList& faces,
                            const PlanVertices& plan_vertices, const ConformedFaces& conformed,
                            const Window& window, const Execution& execution) {
    TileBorder border{window, plan_vertices_on(window, plan_vertices), {}};
    const auto planes = planes_at(border.plan_vertices, faces, conformed);
    constexpr std::size_t kGrain = 64;
    const auto find = [&](std::size_t begin, std::size_t end, auto& vertices) {
        const ExactPositions exactly(geometry);
        for (std::size_t i = begin; i < end; ++i) {
            TileBorder::PlanVertex& vertex = border.plan_vertices[i];
            const auto p = static_cast<std::size_t>(vertex.number);
            const PointId point = plan_vertices.representative[p];
            const auto at = exactly.plan(point);
            for (std::size_t axis = 0; axis < 2; ++axis) {
                vertex.is_on[axis] =
                    vertex.is_on[axis] && at[axis] == plan_vertices.position[p][axis];
            }
            if (!vertex.is_on[0] && !vertex.is_on[1]) continue;
            const std::array rounded{nearest(at[0]), nearest(at[1])};
            const std::array text{at[0].get_str(16), at[1].get_str(16)};
            for (std::size_t rank = 0; rank < planes[i].size(); ++rank) {
                const mpq_class z = exactly.height(planes[i][rank], point);
                vertices.push_back({conformed.vertex_offsets[p] + static_cast<std::int32_t>(rank),
                                    {rounded[0], rounded[1], nearest(z)},
                                    {text[0], text[1], z.get_str(16)}});
            }
        }
    };
    border.vertices = collect_ranges<BorderVertex>(planes.size(), kGrain, execution, find);
    return border;
}

}  // namespace realmodel::strata
