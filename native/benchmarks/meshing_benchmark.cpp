// SPDX-License-Identifier: GPL-3.0-or-later
// Speed and quality of mesh_region on a square with two holes: meshing_benchmark [TRIANGLES ...]
#include <sys/resource.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <numbers>
#include <vector>

#include "realmodel/meshing/region_mesh.hpp"

namespace {

using realmodel::meshing::PlanarMesh;
using realmodel::meshing::Ring;

std::vector<Ring> square_with_two_holes() {
    const auto circle = [](double x, double y, double radius, int corners) {
        Ring ring;
        for (int i = 0; i < corners; ++i) {
            const double turn = 2 * std::numbers::pi * i / corners;
            ring.push_back({x + radius * std::cos(turn), y + radius * std::sin(turn)});
        }
        return ring;
    };
    return {{{0, 0}, {1000, 0}, {1000, 1000}, {0, 1000}},
            circle(300, 300, 120, 64),
            circle(650, 700, 150, 7)};
}

struct Quality {
    double mean_edge, least_angle, mean_ratio;
};

Quality quality_of(const PlanarMesh& mesh) {
    double edges = 0, ratios = 0, least = 180;
    for (const auto& t : mesh.triangles) {
        double squares = 0, lengths[3];
        for (int i = 0; i < 3; ++i) {
            const auto &a = mesh.vertices[t[i]], &b = mesh.vertices[t[(i + 1) % 3]];
            lengths[i] = std::hypot(b[0] - a[0], b[1] - a[1]);
            edges += lengths[i];
            squares += lengths[i] * lengths[i];
        }
        const auto &a = mesh.vertices[t[0]], &b = mesh.vertices[t[1]], &c = mesh.vertices[t[2]];
        const double area = 0.5 * ((b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]));
        ratios += 4 * std::numbers::sqrt3 * area / squares;
        std::sort(lengths, lengths + 3);
        const double sine = 2 * area / (lengths[1] * lengths[2]);
        least = std::min(least, std::asin(sine) * 180 / std::numbers::pi);
    }
    const auto count = static_cast<double>(mesh.triangles.size());
    return {edges / (3 * count), least, ratios / count};
}

}  // namespace

int main(int argc, char** argv) {
    std::vector<double> wanted;
    for (int i = 1; i < argc; ++i)
        wanted.push_back(std::atof(argv[i]));
    if (wanted.empty()) wanted = {1e4, 1e5, 1e6, 4e6};
    const std::vector<Ring> rings = square_with_two_holes();
    constexpr double area = 1e6 - 120 * 120 * std::numbers::pi - 61570;
    std::printf("%10s %9s %12s %10s %11s %10s %9s\n", "triangles", "seconds", "triangles/s",
                "mean edge", "least angle", "mean ratio", "peak MB");
    for (const double count : wanted) {
        const double edge = std::sqrt(area / count / (std::numbers::sqrt3 / 4));
        const auto start = std::chrono::steady_clock::now();
        const PlanarMesh mesh = realmodel::meshing::mesh_region(rings, {.edge_length = edge});
        const double seconds =
            std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
        const Quality quality = quality_of(mesh);
        rusage usage{};
        getrusage(RUSAGE_SELF, &usage);
        std::printf("%10zu %9.3f %12.0f %10.4f %11.2f %10.4f %9.0f\n", mesh.triangles.size(),
                    seconds, static_cast<double>(mesh.triangles.size()) / seconds,
                    quality.mean_edge / edge, quality.least_angle, quality.mean_ratio,
                    static_cast<double>(usage.ru_maxrss) / 1024);
    }
}
