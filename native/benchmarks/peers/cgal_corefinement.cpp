// SPDX-License-Identifier: GPL-3.0-or-later
// A peer: the surfaces of a stack cut along one another by CGAL's corefinement with exact numbers
// (Polygon_mesh_processing, kernel EPECK), all pairs, one after another. It makes no blocks.
//
//   cgal_corefinement FILE
//
// FILE: the number of surfaces (int64), then for each the numbers of its vertices and triangles
// (int64), its coordinates (float64) and corners (int32), as scripts/benchmarks/peers.py writes
// them. Prints the seconds of construction and corefinement, and the faces at the end.
#include <CGAL/Exact_predicates_exact_constructions_kernel.h>
#include <CGAL/Polygon_mesh_processing/corefinement.h>
#include <CGAL/Surface_mesh.h>

#include <array>
#include <chrono>
#include <cstdint>
#include <cstdio>
#include <fstream>
#include <stdexcept>
#include <vector>

namespace {

using Kernel = CGAL::Exact_predicates_exact_constructions_kernel;
using Mesh = CGAL::Surface_mesh<Kernel::Point_3>;

struct Surface {
    std::vector<std::array<double, 3>> vertices;
    std::vector<std::array<std::int32_t, 3>> triangles;
};

template <class T>
void read(std::ifstream& file, T* values, std::size_t count) {
    file.read(reinterpret_cast<char*>(values), static_cast<std::streamsize>(count * sizeof(T)));
    if (!file) throw std::runtime_error("the file ends too early");
}

std::vector<Surface> read_stack(const char* path) {
    std::ifstream file(path, std::ios::binary);
    std::int64_t count = 0;
    read(file, &count, 1);
    std::vector<Surface> surfaces(static_cast<std::size_t>(count));
    for (Surface& surface : surfaces) {
        std::array<std::int64_t, 2> sizes{};
        read(file, sizes.data(), 2);
        surface.vertices.resize(static_cast<std::size_t>(sizes[0]));
        surface.triangles.resize(static_cast<std::size_t>(sizes[1]));
        read(file, surface.vertices.data(), surface.vertices.size());
        read(file, surface.triangles.data(), surface.triangles.size());
    }
    return surfaces;
}

Mesh mesh_of(const Surface& surface) {
    Mesh mesh;
    for (const auto& [x, y, z] : surface.vertices)
        mesh.add_vertex(Kernel::Point_3(x, y, z));
    for (const auto& corner : surface.triangles) {
        const auto vertex = [&](std::size_t i) {
            return Mesh::Vertex_index(static_cast<Mesh::size_type>(corner[i]));
        };
        mesh.add_face(vertex(0), vertex(1), vertex(2));
    }
    return mesh;
}

}  // namespace

int main(int count, char** arguments) {
    if (count != 2) {
        std::fprintf(stderr, "usage: cgal_corefinement FILE\n");
        return 2;
    }
    const std::vector<Surface> surfaces = read_stack(arguments[1]);
    const auto began = std::chrono::steady_clock::now();
    std::vector<Mesh> meshes;
    for (const Surface& surface : surfaces)
        meshes.push_back(mesh_of(surface));
    for (std::size_t i = 0; i < meshes.size(); ++i) {
        for (std::size_t j = i + 1; j < meshes.size(); ++j) {
            CGAL::Polygon_mesh_processing::corefine(meshes[i], meshes[j]);
        }
    }
    const double seconds =
        std::chrono::duration<double>(std::chrono::steady_clock::now() - began).count();
    std::size_t faces = 0;
    for (const Mesh& mesh : meshes)
        faces += mesh.number_of_faces();
    std::printf("{\"seconds\": %.6f, \"faces\": %zu}\n", seconds, faces);
    return 0;
}
