// SPDX-License-Identifier: GPL-3.0-or-later
// Merging and kriging on two threads of the CPU, and beside them on a GPU where the program was
// built with REALMODEL_CUDA. Each line: what, how many, then seconds on the CPU, in all on the GPU,
// of these for copying, and whether both gave the same bytes; "-" without a GPU.
//   device_benchmark merge|krige COUNT [cpu]
#include <array>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <memory>
#include <random>
#include <string>
#include <vector>

#include "realmodel/interpolation/kriging.hpp"
#include "structures/merge_vertices.hpp"
#ifdef REALMODEL_CUDA
#include "../cuda/opened_device.hpp"
#endif

namespace {

using namespace realmodel;

constexpr int kThreads = 2;

template <class Run>
double seconds(const Run& run) {
    const auto begin = std::chrono::steady_clock::now();
    run();
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
}

/// A device and what is asked of it here.
struct DeviceHere {
#ifdef REALMODEL_CUDA
    std::unique_ptr<cuda::OpenedDevice> opened = cuda::open_device();
    const Device* functions() {
        return &opened->device();
    }
    double transfer() {
        return opened->transfer_seconds();
    }
    /// Whether it left something to the CPU or took it in tiles, which is said.
    bool declined() {
        const auto messages = opened->take_messages();
        for (const std::string& message : messages)
            std::fprintf(stderr, "%s\n", message.c_str());
        return !messages.empty();
    }
#else
    const Device* functions() {
        return nullptr;
    }
    double transfer() {
        return 0;
    }
    bool declined() {
        return false;
    }
#endif
};

/// run(prepared, device) is timed, on what prepare() gives it.
template <class Prepare, class Run>
void compare(const char* what, std::size_t count, bool only_cpu, const Prepare& prepare,
             const Run& run) {
    auto expected = prepare();
    const double cpu = seconds([&] { run(expected, nullptr); });
    std::printf("%s %zu %.4f ", what, count, cpu);
    if (only_cpu) {
        std::puts("- - -");
        return;
    }
    DeviceHere device;
    auto found = prepare();
    run(found, device.functions());  // its first call loads the kernels
    found = prepare();
    const double copied_before = device.transfer();
    const double all = seconds([&] { run(found, device.functions()); });
    const bool same = found == expected && !device.declined();
    std::printf("%.4f %.4f %s\n", all, device.transfer() - copied_before, same ? "yes" : "NO");
}

struct Mesh {
    std::vector<double> vertices;
    std::vector<std::int32_t> corners;
    bool operator==(const Mesh&) const = default;
};

/// Each position twice, as between two models, in no order; two triangles for each vertex.
Mesh mesh(std::size_t count) {
    Mesh made;
    std::mt19937_64 random(1);
    for (std::size_t v = 0; v < count; ++v) {
        const auto at = static_cast<double>(v % ((count + 1) / 2) * 2654435761U % 4294967291U);
        made.vertices.insert(made.vertices.end(), {at * 0x1p-20, std::sqrt(at), at * 0x1p-10});
    }
    made.corners.resize(6 * count);
    for (std::int32_t& corner : made.corners)
        corner = static_cast<std::int32_t>(random() % count);
    return made;
}

void merge(std::size_t count, bool only_cpu) {
    const Mesh given = mesh(count);
    const std::vector<std::uint8_t> is_shared(count, 1);
    compare(
        "merge", count, only_cpu, [&] { return given; },
        [&](Mesh& made, const Device* device) {
            structures::merge_vertices({made.vertices.data(), count, is_shared.data(),
                                        made.corners.data(), made.corners.size()},
                                       {kThreads, nullptr, device});
        });
}

/// 20,000 points, of which 16 count at a node of a square lattice.
void krige(std::size_t count, bool only_cpu) {
    std::mt19937 random(1);
    const auto uniform = [&] { return static_cast<double>(random()) * 0x1p-32; };
    std::vector<std::array<double, 3>> points;
    for (int i = 0; i < 20'000; ++i) {
        const double x = uniform(), y = uniform();
        points.push_back({4e5 + 5000 * x, 5e6 + 5000 * y, 100 * std::sin(6 * x) * std::cos(5 * y)});
    }
    const auto side = static_cast<std::size_t>(std::sqrt(static_cast<double>(count)));
    std::vector<std::array<double, 2>> nodes;
    for (std::size_t i = 0; i < count; ++i) {
        nodes.push_back({4e5 + 5000 * static_cast<double>(i % side) / static_cast<double>(side),
                         5e6 + 5000 * static_cast<double>(i / side) / static_cast<double>(side)});
    }
    const interpolation::Variogram variogram{interpolation::VariogramModel::kMatern32, 900, 2000};
    const interpolation::KrigingOptions options{{16, 0, 0}};
    compare(
        "krige", count, only_cpu, [] { return std::vector<double>(); },
        [&](std::vector<double>& z, const Device* device) {
            z = interpolation::krige(points, nodes, variogram, options, {kThreads, nullptr, device})
                    .z;
        });
}

}  // namespace

int main(int argc, char** argv) {
    const std::string what = argc > 2 ? argv[1] : "";
    const std::size_t count = argc > 2 ? std::strtoull(argv[2], nullptr, 10) : 0;
#ifdef REALMODEL_CUDA
    const bool only_cpu = argc > 3;
#else
    const bool only_cpu = true;
#endif
    if (count == 0 || (what != "merge" && what != "krige")) {
        std::fputs("usage: device_benchmark merge|krige COUNT [cpu]\n", stderr);
        return 2;
    }
    try {
        what == "merge" ? merge(count, only_cpu) : krige(count, only_cpu);
    } catch (const std::exception& error) {
        std::fprintf(stderr, "device_benchmark: %s\n", error.what());
        return 1;
    }
    return 0;
}
