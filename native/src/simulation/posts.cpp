// SPDX-License-Identifier: GPL-3.0-or-later
#include "simulation/posts.hpp"

#include "base/disjoint_sets.hpp"

namespace realmodel::simulation {

using meshing::HalfEdge;

Posts::Posts(const meshing::FlatMesh& mesh, const LineEdges& edges)
    : of_corner(3 * mesh.corners.size(), -1), is_divided(mesh.points.size(), 0) {
    DisjointSets sets(of_corner.size());
    const auto corner = [](HalfEdge edge) { return 3 * edge.triangle() + edge.index(); };
    mesh.for_each_edge([&](HalfEdge edge) {
        const HalfEdge twin = mesh.twin(edge);
        if (twin.is_none()) return;
        const std::int32_t a = mesh.from(edge), b = mesh.to(edge);
        if (edges.is_step(a, b)) {
            is_divided[index(a)] = is_divided[index(b)] = 1;
        } else {
            sets.join(corner(edge), corner(twin.next()));
            sets.join(corner(edge.next()), corner(twin));
        }
    });
    std::vector<std::uint8_t> has_post(mesh.points.size(), 0);
    mesh.for_each_edge([&](HalfEdge edge) {
        const std::int32_t c = corner(edge), first = sets.find(c);
        if (first != c) {
            of_corner[index(c)] = of_corner[index(first)];
            return;
        }
        const std::int32_t n = mesh.from(edge);
        of_corner[index(c)] = static_cast<std::int32_t>(node.size());
        node.push_back(n);
        if (has_post[index(n)] != 0) is_divided[index(n)] = 1;
        has_post[index(n)] = 1;
    });
}

}  // namespace realmodel::simulation
