// SPDX-License-Identifier: GPL-3.0-or-later
#include "realmodel/interpolation/surface_heights.hpp"

#include <limits>

#include "base/algorithms.hpp"
#include "base/parallel.hpp"
#include "interpolation/data_points.hpp"
#include "interpolation/node_loop.hpp"
#include "spatial/mesh_locator.hpp"

namespace realmodel::interpolation {

PlacesOnSurface places_on_surface(std::span<const std::array<double, 3>> vertices,
                                  std::span<const std::array<std::int32_t, 3>> triangles,
                                  std::span<const std::array<double, 2>> nodes,
                                  const Execution& execution) {
    require_finite_nodes(nodes);
    const auto positions = transformed(vertices, [](const auto& p) {
        return PlanPosition{p[0], p[1]};
    });
    // On the border of a fault, which is asked of each surface, most places lie beside it.
    const spatial::MeshLocator locator(positions, triangles, spatial::box_around(nodes));
    PlacesOnSurface places{std::vector<std::int32_t>(nodes.size(), -1),
                           std::vector<std::array<double, 2>>(nodes.size())};
    const NodeLoop loop{nodes.size(), 1024, execution};
    loop.over_nodes([] { return 0; },
                    [&](int, std::size_t i) {
                        const auto position = locator.find(nodes[i]);
                        if (!position) return;
                        places.triangle[i] = position->triangle;
                        places.weights[i] = {position->weights[1], position->weights[2]};
                    });
    return places;
}

std::vector<double> heights_on_surface(std::span<const std::array<double, 3>> vertices,
                                       std::span<const std::array<std::int32_t, 3>> triangles,
                                       std::span<const std::array<double, 2>> nodes,
                                       const Execution& execution) {
    const PlacesOnSurface places = places_on_surface(vertices, triangles, nodes, execution);
    std::vector<double> z(nodes.size(), std::numeric_limits<double>::quiet_NaN());
    parallel_for_each(z.size(), execution, [&](std::size_t i) {
        if (places.triangle[i] < 0) return;
        const auto& corners = triangles[static_cast<std::size_t>(places.triangle[i])];
        // From the first corner: heights far from 0 lose no digits, a flat triangle is flat.
        const double base = vertices[static_cast<std::size_t>(corners[0])][2];
        z[i] = base;
        for (std::size_t k = 1; k < 3; ++k) {
            z[i] += places.weights[i][k - 1] *
                    (vertices[static_cast<std::size_t>(corners[k])][2] - base);
        }
    });
    return z;
}

}  // namespace realmodel::interpolation
