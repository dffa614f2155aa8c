// SPDX-License-Identifier: GPL-3.0-or-later
// Two layers of rock: the surface between them is interpolated from four boreholes, and the upper
// surface, erosional and flat, cuts it. Prints the volumes of the layers, which can be worked out
// by hand: 148,000 and 32,000.
#include <array>
#include <cstdint>
#include <cstdio>
#include <span>
#include <vector>

#include "realmodel/base/errors.hpp"
#include "realmodel/interpolation/triangulated.hpp"
#include "realmodel/meshing/region_mesh.hpp"
#include "realmodel/strata/stack.hpp"

namespace {

using realmodel::meshing::PlanarMesh;

/// A surface on the planar mesh, with one height for each of its vertices.
struct Surface {
    std::vector<double> coordinates;

    Surface(const PlanarMesh& mesh, const std::vector<double>& heights) {
        for (std::size_t v = 0; v < heights.size(); ++v) {
            const auto& [x, y] = mesh.vertices[v];
            coordinates.insert(coordinates.end(), {x, y, heights[v]});
        }
    }
};

void print_volumes() {
    const realmodel::meshing::Ring outline{{0, 0}, {100, 0}, {100, 100}, {0, 100}};
    const PlanarMesh mesh =
        realmodel::meshing::mesh_region(std::span(&outline, 1), {.edge_length = 10.0});
    std::vector<std::int32_t> triangles;
    for (const auto& corners : mesh.triangles) {
        triangles.insert(triangles.end(), corners.begin(), corners.end());
    }

    // Heights in four boreholes: the surface rises from 10 in the west to 20 in the east.
    const std::vector<std::array<double, 3>> boreholes{
        {0, 0, 10}, {100, 0, 20}, {100, 100, 20}, {0, 100, 10}};
    const std::vector<double> heights =
        realmodel::interpolation::linear_on_triangulation(boreholes, mesh.vertices);

    const std::size_t count = mesh.vertices.size();
    const std::array surfaces{Surface(mesh, std::vector<double>(count, 0.0)),
                              Surface(mesh, heights),
                              Surface(mesh, std::vector<double>(count, 18.0))};
    realmodel::strata::StackInput input;
    for (const Surface& surface : surfaces) {
        input.surfaces.push_back({surface.coordinates, triangles});
    }
    const auto model = realmodel::strata::build_stack(input, {0, nullptr});

    std::printf("lower layer %.1f\n", model.volumes[1]);
    std::printf("upper layer %.1f\n", model.volumes[2]);
}

}  // namespace

int main() {
    try {
        print_volumes();
    } catch (const realmodel::InputError& error) {
        std::fprintf(stderr, "%s\n", error.what());
        return 1;
    }
}
