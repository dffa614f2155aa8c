// SPDX-License-Identifier: GPL-3.0-or-later
// Two surfaces intersected: seconds, what they consist of, and a digest of the refinement.
//
//   boolean_benchmark spheres RINGS [THREADS]        two spheres of 4 RINGS (RINGS - 1) triangles
//   boolean_benchmark shifted FILE ULPS [THREADS]    a surface and a copy moved by so many doubles
//   boolean_benchmark files THREADS FILE...          one file, or all of them together, with
//   itself;
//                                                    .obj or .ts (GOCAD)
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <map>
#include <sstream>
#include <string>
#include <vector>

#include "../tests/booleans/small_meshes.hpp"
#include "realmodel/booleans/intersect.hpp"

namespace {

using realmodel::TriangleView;

using realmodel::booleans::Mesh;
using realmodel::booleans::sphere;

/// Appends the triangles of a file: of an .obj its faces in fans, of a .ts its TRGL.
void read(const char* name, Mesh& s) {
    std::ifstream file(name);
    if (!file) throw std::runtime_error(std::string(name) + " cannot be read");
    const auto first = static_cast<std::int32_t>(s.vertices.size() / 3);
    std::map<int, std::int32_t> gocad;  // vertices by their numbers
    for (std::string line, word; std::getline(file, line);) {
        std::istringstream in(line);
        in >> word;
        double x = 0, y = 0, z = 0;
        if (word == "v" && in >> x >> y >> z) {
            s.vertices.insert(s.vertices.end(), {x, y, z});
        } else if (word == "f") {
            std::vector<std::int32_t> face;
            while (in >> word)
                face.push_back(first + std::stoi(word) - 1);
            for (std::size_t k = 2; k < face.size(); ++k)
                s.triangles.insert(s.triangles.end(), {face[0], face[k - 1], face[k]});
        } else if (word == "VRTX" || word == "PVRTX") {
            int number = 0;
            in >> number >> x >> y >> z;
            gocad[number] = static_cast<std::int32_t>(s.vertices.size() / 3);
            s.vertices.insert(s.vertices.end(), {x, y, z});
        } else if (word == "TRGL") {
            for (int k = 0, number = 0; k < 3 && in >> number; ++k)
                s.triangles.push_back(gocad.at(number));
        } else if (word == "TFACE") {
            continue;
        }
    }
}

/// FNV-1a of the bytes of an array.
template <class Array>
void digest(std::uint64_t& value, const Array& array) {
    const auto* bytes = reinterpret_cast<const unsigned char*>(array.data());
    for (std::size_t i = 0; i < array.size() * sizeof(*array.data()); ++i)
        value = (value ^ bytes[i]) * 0x100000001b3ULL;
}

void measure(const TriangleView& a, const TriangleView& b, int threads) {
    const auto start = std::chrono::steady_clock::now();
    const auto r = realmodel::booleans::intersect(a, b, {threads});
    const double seconds =
        std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    std::uint64_t value = 0xcbf29ce484222325ULL;
    digest(value, r.vertices);
    digest(value, r.triangles);
    digest(value, r.source_triangle);
    std::printf(
        "%.3f s: %zu and %zu triangles, %zu in the refinement, %zu loops, %zu sub-surfaces, "
        "%zu sub-blocks, digest %016llx\n",
        seconds, a.triangle_count(), b.triangle_count(), r.triangles.size(), r.loops.size(),
        r.sub_surfaces.size(), r.sub_blocks.size(), static_cast<unsigned long long>(value));
}

}  // namespace

int main(int argc, char** argv) {
    const auto number = [&](int i, int otherwise) {
        return argc > i ? std::atoi(argv[i]) : otherwise;
    };
    try {
        if (argc > 2 && std::strcmp(argv[1], "spheres") == 0) {
            const Mesh a = sphere({0, 0, 0}, 1, number(2, 100)),
                       b = sphere({0.31, 0.22, 0.13}, 0.93, number(2, 100));
            measure(a.view(), b.view(), number(3, 0));
        } else if (argc > 3 && std::strcmp(argv[1], "shifted") == 0) {
            Mesh a;
            read(argv[2], a);
            Mesh b = a;
            for (double& x : b.vertices) {
                for (int i = 0; i < number(3, 1); ++i)
                    x = std::nextafter(x, HUGE_VAL);
            }
            measure(a.view(), b.view(), number(4, 0));
        } else if (argc > 3 && std::strcmp(argv[1], "files") == 0) {
            Mesh a;
            for (int i = 3; i < argc; ++i)
                read(argv[i], a);
            // all cross each other within the first surface; the second one is one of its triangles
            const Mesh b{{a.vertices.begin(), a.vertices.end()},
                         {a.triangles.begin(), a.triangles.begin() + 3}};
            measure(a.view(), b.view(), number(2, 0));
        } else {
            std::fprintf(stderr, "boolean_benchmark spheres|shifted|files ...\n");
            return 2;
        }
    } catch (const std::exception& error) {
        std::fprintf(stderr, "boolean_benchmark: %s\n", error.what());
        return 1;
    }
    return 0;
}
