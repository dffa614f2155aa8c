// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <utility>
#include <vector>

#include "realmodel/meshing/region_mesh.hpp"
#include "realmodel/simulation/layered_mesh.hpp"
#include "realmodel/strata/stack.hpp"

namespace realmodel::simulation {

struct Plane {
    std::vector<double> vertices;
    std::vector<std::int32_t> triangles{0, 1, 2, 0, 2, 3};
    /// Over a rectangle of 10 by 6, with heights at its west and its east side.
    Plane(double west, double east) : vertices{0, 0, west, 10, 0, east, 10, 6, east, 0, 6, west} {}
    TriangleView view() const { return {vertices, triangles}; }
};

/// The model of some planes, whose blocks are numbered from 0.
struct Model {
    CellComplex complex;
    std::vector<std::int32_t> block_rock;
    ComplexView view;

    explicit Model(const std::vector<Plane>& planes) {
        strata::StackInput input;
        for (const Plane& plane : planes)
            input.surfaces.push_back(plane.view());
        complex = strata::build_stack(input, {1, nullptr});
        for (std::int32_t& block : complex.cell_block)
            --block;
        block_rock.assign(planes.size() - 1, 0);
        view = complex;
        view.blocks = block_rock.size();
    }
    PlanLines lines(double edge_length) const {
        return plan_lines(view, block_rock, edge_length, {}, {1, nullptr});
    }
    LayeredMesh mesh(double edge_length, const Layering& layering) const {
        const PlanLines found = lines(edge_length);
        meshing::MeshRequest request;
        request.edge_length = edge_length;
        for (const PlanSegment& s : found.segments) {
            if (s.left_rock >= 0 && s.right_rock >= 0)
                request.constraints.lines.push_back({found.points[static_cast<std::size_t>(s.from)],
                                                     found.points[static_cast<std::size_t>(s.to)]});
        }
        return layered_mesh(view, block_rock, found, meshing::mesh_region(found.rings, request),
                            layering, {1, nullptr});
    }
};

}  // namespace realmodel::simulation
