// SPDX-License-Identifier: GPL-3.0-or-later
#include "strata/cells/tile_border.hpp"

#include <algorithm>
#include <array>
#include <utility>

#include "base/parallel.hpp"
#include "strata/cells/exact_places.hpp"

namespace realmodel::strata {

namespace {

using exact::PlanArrangement;

constexpr std::array<std::array<double Window::*, 2>, 2> kLines{
    {{&Window::low_x, &Window::high_x}, {&Window::low_y, &Window::high_y}}};

bool is_on_line(const Window& window, std::size_t axis, double coordinate) {
    return coordinate == window.*kLines[axis][0] || coordinate == window.*kLines[axis][1];
}

/// The plan vertices that are on lines when rounded, as all are that are there exactly.
std::vector<TileBorder::PlanVertex> plan_vertices_on(const Window& window,
                                                     const PlanVertices& plan_vertices) {
    std::vector<TileBorder::PlanVertex> found;
    for (std::size_t p = 0; p < plan_vertices.size(); ++p) {
        const auto [x, y] = plan_vertices.position[p];
        const std::array is_on{is_on_line(window, 0, x), is_on_line(window, 1, y)};
        if (is_on[0] || is_on[1]) found.push_back({static_cast<PlanVertexId>(p), is_on});
    }
    return found;
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
    constexpr std::size_t kTogether = 64;
    std::vector<std::vector<BorderVertex>> found((planes.size() + kTogether - 1) / kTogether);
    parallel_ranges(planes.size(), kTogether, execution, [&](std::size_t begin, std::size_t end) {
        const ExactPlaces places(geometry);
        for (std::size_t i = begin; i < end; ++i) {
            TileBorder::PlanVertex& vertex = border.plan_vertices[i];
            const auto p = static_cast<std::size_t>(vertex.number);
            const PointId point = plan_vertices.representative[p];
            const auto at = places.plan(point);
            for (std::size_t axis = 0; axis < 2; ++axis) {
                vertex.is_on[axis] =
                    vertex.is_on[axis] && at[axis] == plan_vertices.position[p][axis];
            }
            if (!vertex.is_on[0] && !vertex.is_on[1]) continue;
            const std::array rounded{nearest(at[0]), nearest(at[1])};
            const std::array text{at[0].get_str(16), at[1].get_str(16)};
            for (std::size_t rank = 0; rank < planes[i].size(); ++rank) {
                const mpq_class z = places.height(planes[i][rank], point);
                found[begin / kTogether].push_back(
                    {conformed.vertex_offsets[p] + static_cast<std::int32_t>(rank),
                     {rounded[0], rounded[1], nearest(z)},
                     {text[0], text[1], z.get_str(16)}});
            }
        }
    });
    for (auto& some : found) {
        border.vertices.insert(border.vertices.end(), std::make_move_iterator(some.begin()),
                               std::make_move_iterator(some.end()));
    }
    return border;
}

}  // namespace realmodel::strata
