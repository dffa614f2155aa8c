// SPDX-License-Identifier: GPL-3.0-or-later
// Prints one line for each of a fixed set of stacks, meshes and interpolations: its name and a
// digest of what came out. scripts/compare_builds.sh compares what different compilers and settings
// make of them; nothing is stored, so that an improvement may change them all.
//
//   build_digests [THREADS]
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>

#include "digest.hpp"
#include "generate.hpp"
#include "judge.hpp"
#include "mutate.hpp"
#include "realmodel/interpolation/distances.hpp"
#include "realmodel/interpolation/kriging.hpp"
#include "realmodel/interpolation/variogram_fit.hpp"
#include "realmodel/meshing/region_mesh.hpp"

namespace {

using namespace realmodel;
using fuzz::Digest;

int threads = 0;

void print(const std::string& name, std::uint64_t digest) {
    std::printf("%016llx  %s\n", static_cast<unsigned long long>(digest), name.c_str());
}

void print_stack(const std::string& name, fuzz::StackCase stack) {
    bool usable = false;
    if (!fuzz::make_valid(stack, usable).empty() || !usable) {
        print(name + ", not built", 0);
        return;
    }
    const auto built = [&](strata::CellKind cells) {
        return strata::build_rock_masses(fuzz::views_of(stack), {threads, nullptr}, cells);
    };
    print(name + ", columns", fuzz::digest(built(strata::CellKind::kColumns)));
    print(name + ", blocks", fuzz::digest(built(strata::CellKind::kBlocks)));
}

void print_stacks() {
    const std::vector<std::string> families = fuzz::families();
    for (std::size_t family = 0; family < families.size(); ++family) {
        for (std::uint64_t seed = 0; seed < 4; ++seed) {
            fuzz::RandomSource random(seed);
            print_stack(families[family] + " " + std::to_string(seed),
                        fuzz::make_stack(random, family, 2, 4));
        }
    }
    for (std::uint64_t seed = 0; seed < 6; ++seed) {
        fuzz::RandomSource random(seed);
        print_stack("rock masses " + std::to_string(seed), fuzz::make_rock_masses(random, 3));
    }
    for (std::uint64_t number = 0; number < 60; ++number)
        print_stack("case " + std::to_string(number), fuzz::case_number(11, number, {}));
    for (const std::size_t family : {0U, 1U, 7U, 8U, 16U, 18U}) {  // several chunks of work
        fuzz::RandomSource random(family);
        print_stack("large " + families[family], fuzz::make_stack(random, family, 20, 24));
    }
}

void print_mesh_and_heights() {
    const std::vector<meshing::Ring> rings{{{0, 0}, {100, 3}, {120, 70}, {55, 40}, {-7, 66}},
                                           {{30, 15}, {50, 17}, {44, 30}}};
    const meshing::PlanarMesh mesh = meshing::mesh_region(rings, {.edge_length = 2.5});
    print("region mesh", Digest().add(mesh.vertices).add(mesh.triangles).value());

    fuzz::RandomSource random(5);
    std::vector<std::array<double, 3>> points;
    for (int i = 0; i < 300; ++i) {
        const double x = random.uniform(0, 120), y = random.uniform(0, 70);
        points.push_back({x, y, 20 + 3 * std::sin(x / 20) + y / 30 + random.uniform()});
    }
    const auto fitted = interpolation::fit_variogram(points, {}).variogram;
    print("fitted variogram",
          Digest()
              .add(std::array{fitted.range, fitted.sill, fitted.nugget,
                              static_cast<double>(static_cast<int>(fitted.model))})
              .value());
    const interpolation::Variogram spherical{.range = 60, .sill = 4, .nugget = 0.1};
    for (const int neighbours : {0, 16, 32}) {
        const interpolation::KrigingOptions options{{neighbours}};
        const auto kriged =
            interpolation::krige(points, mesh.vertices, spherical, options, {threads});
        print("kriging, " + std::to_string(neighbours) + " neighbours",
              Digest().add(kriged.z).add(kriged.variance).value());
        const auto left_out = interpolation::krige_left_out(points, fitted, options, {threads});
        print("kriging left out points, " + std::to_string(neighbours) + " neighbours",
              Digest().add(left_out.z).add(left_out.variance).value());
    }
    print("inverse distance",
          Digest()
              .add(interpolation::inverse_distance(points, mesh.vertices, {}, {threads}))
              .value());
}

}  // namespace

int main(int count, char** arguments) {
#if !defined(_WIN32)
    setenv("OMP_WAIT_POLICY", "passive", 0);
#endif
    if (count > 1) threads = std::atoi(arguments[1]);
    print_stacks();
    print_mesh_and_heights();
    return 0;
}
