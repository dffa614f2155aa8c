// SPDX-License-Identifier: GPL-3.0-or-later
// The triangles of a surface cut along one another by geogram, exactly; scripts/benchmark.sh
// compiles it with the library of the Python package.
//
//   geogram_arrangement FILE    two int64 (vertices, triangles), doubles x, y, z, int32 corners
//
// Prints seconds from arrays to the result, those of the processors, triangles and bytes at most.
#include <geogram/basic/command_line.h>
#include <geogram/basic/command_line_args.h>
#include <geogram/basic/common.h>
#include <geogram/basic/logger.h>
#include <geogram/mesh/mesh.h>
#include <geogram/mesh/mesh_surface_intersection.h>
#include <sys/resource.h>

#include <array>
#include <chrono>
#include <cstdint>
#include <cstdio>
#include <exception>
#include <fstream>
#include <vector>

// the library was made by a newer compiler, whose run-time library has this
extern "C" void __cxa_call_terminate(void*) noexcept {
    std::terminate();
}

namespace {

rusage used() {
    rusage now;
    getrusage(RUSAGE_SELF, &now);
    return now;
}

double processor() {
    const rusage now = used();
    return static_cast<double>(now.ru_utime.tv_sec + now.ru_stime.tv_sec) +
           1e-6 * static_cast<double>(now.ru_utime.tv_usec + now.ru_stime.tv_usec);
}

}  // namespace

int main(int argc, char** argv) {
    if (argc != 2) return 2;
    GEO::initialize(GEO::GEOGRAM_INSTALL_NONE);
    GEO::CmdLine::import_arg_group("standard");
    GEO::CmdLine::import_arg_group("algo");
    GEO::Logger::instance()->set_quiet(true);
    std::ifstream file(argv[1], std::ios::binary);
    std::array<std::int64_t, 2> counts{};
    file.read(reinterpret_cast<char*>(counts.data()), sizeof counts);
    std::vector<std::array<double, 3>> vertices(static_cast<std::size_t>(counts[0]));
    std::vector<std::array<std::int32_t, 3>> triangles(static_cast<std::size_t>(counts[1]));
    file.read(reinterpret_cast<char*>(vertices.data()), 24 * counts[0]);
    file.read(reinterpret_cast<char*>(triangles.data()), 12 * counts[1]);
    if (!file) return 2;

    const auto began = std::chrono::steady_clock::now();
    const double before = processor();
    GEO::Mesh mesh;
    mesh.vertices.set_dimension(3);
    mesh.vertices.create_vertices(GEO::index_t(vertices.size()));
    for (GEO::index_t i = 0; i < vertices.size(); ++i)
        mesh.vertices.point(i) = GEO::vec3(vertices[i][0], vertices[i][1], vertices[i][2]);
    mesh.facets.create_triangles(GEO::index_t(triangles.size()));
    for (GEO::index_t i = 0; i < triangles.size(); ++i) {
        for (GEO::index_t k = 0; k < 3; ++k)
            mesh.facets.set_vertex(i, k, GEO::index_t(triangles[i][k]));
    }
    mesh.facets.connect();
    {
        GEO::MeshSurfaceIntersection intersection(mesh);
        intersection.set_verbose(false);
        intersection.set_radial_sort(false);
        intersection.intersect();
    }
    const double seconds =
        std::chrono::duration<double>(std::chrono::steady_clock::now() - began).count();
    std::printf(R"({"seconds": %.6f, "processor": %.6f, "triangles": %u, "peak": %lld})"
                "\n",
                seconds, processor() - before, mesh.facets.nb(),
                1024LL * static_cast<long long>(used().ru_maxrss));
    return 0;
}
