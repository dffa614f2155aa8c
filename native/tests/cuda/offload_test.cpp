// SPDX-License-Identifier: GPL-3.0-or-later
// What a device computes, by the same functions in this process. That joined models and kriged
// nodes have the same bytes with and without is tested where these are: structures_test.cpp and
// lane_kriging_test.cpp.
#include "../../cuda/offload.hpp"

#include <gtest/gtest.h>

#include <barrier>
#include <cmath>
#include <limits>
#include <map>
#include <random>
#include <thread>
#include <vector>

namespace realmodel::cuda {
namespace {

/// Vertices on a lattice, so that many coincide, and faces of them.
struct SomeVertices {
    std::vector<std::array<double, 3>> vertices;
    std::vector<std::uint8_t> is_shared;
    std::vector<std::int32_t> corners;

    SomeVertices(std::size_t count, unsigned seed) {
        std::mt19937 random(seed);
        const auto below = [&](unsigned end) { return static_cast<std::int32_t>(random() % end); };
        for (std::size_t v = 0; v < count; ++v) {
            vertices.push_back({0.1 * below(5) - 0.2 + 0.0, 1e-300 * below(4), -7.0 * below(3)});
            for (double& x : vertices.back())
                x += 0.0;  // no -0
            is_shared.push_back(below(4) > 0 ? 1 : 0);
            for (int corner = 0; corner < 3; ++corner)
                corners.push_back(below(static_cast<unsigned>(count)));
        }
    }
    VertexMerging task() {
        return {vertices[0].data(), vertices.size(), is_shared.data(), corners.data(),
                corners.size()};
    }
    bool operator==(const SomeVertices&) const = default;

    /// The k-th position of those that are shared gets the k-th of their numbers.
    SomeVertices merged() const {
        SomeVertices result = *this;
        std::map<std::array<double, 3>, std::int32_t> number;
        std::vector<std::int32_t> shared;
        for (std::size_t v = 0; v < vertices.size(); ++v) {
            if (is_shared[v] == 0) continue;
            number[vertices[v]];
            shared.push_back(static_cast<std::int32_t>(v));
        }
        std::size_t next = 0;
        for (auto& [position, of_position] : number) {
            of_position = shared[next++];
            result.vertices[static_cast<std::size_t>(of_position)] = position;
        }
        for (std::int32_t& v : result.corners) {
            if (is_shared[static_cast<std::size_t>(v)] != 0)
                v = number[vertices[static_cast<std::size_t>(v)]];
        }
        return result;
    }
};

TEST(Offload, KeysHaveTheOrderOfNumbers) {
    const double inf = std::numeric_limits<double>::infinity();
    const std::vector<double> ascending{-inf, -1e300, -1, -1e-310, 0, 5e-324, 0.5, 1, 1e300, inf};
    for (std::size_t i = 1; i < ascending.size(); ++i)
        EXPECT_LT(key_of(ascending[i - 1]), key_of(ascending[i]));
    EXPECT_EQ(key_of(-0.0), key_of(0.0));
}

TEST(Offload, VerticesAreMergedWithAnyMemory) {
    std::map<std::string, int> outcomes;
    for (const std::size_t count : {1U, 2U, 37U, 500U}) {
        for (const std::size_t memory : {0U, 600U, 3'000U, 9'000U, 20'000U, 1'000'000U}) {
            SCOPED_TRACE(std::to_string(count) + " in " + std::to_string(memory));
            SomeVertices given(count, static_cast<unsigned>(count)), found = given;
            Offload<CpuBackend> offload("", std::make_unique<CpuBackend>(memory), 2);
            const Device& device = offload.device();
            const bool did = device.merge(device.state, found.task());
            EXPECT_EQ(found, did ? given.merged() : given);
            const auto messages = offload.take_messages();
            EXPECT_TRUE(offload.take_messages().empty());
            ASSERT_LE(messages.size(), 1U);
            ++outcomes[!did ? "cpu" : messages.empty() ? "at once" : "tiles"];
            EXPECT_EQ(!did, !messages.empty() &&
                                messages[0].find("the CPU does it") != std::string::npos);
        }
    }
    EXPECT_GT(outcomes["cpu"], 1);
    EXPECT_GT(outcomes["tiles"], 1);
    EXPECT_GT(outcomes["at once"], 1);
}

/// A device that breaks down.
struct BrokenBackend : CpuBackend {
    template <class Function>
    void each(std::size_t /*count*/, const Function& /*function*/) {
        throw std::runtime_error("CUDA: unspecified launch failure");
    }
};

TEST(Offload, WhereADeviceFailsNothingIsChanged) {
    const SomeVertices given(20, 1);
    SomeVertices found = given;
    Offload<BrokenBackend> offload("", std::make_unique<BrokenBackend>());
    EXPECT_FALSE(offload.device().merge(offload.device().state, found.task()));
    EXPECT_EQ(found, given);
    EXPECT_FALSE(offload.device().merge(offload.device().state, found.task()));
    EXPECT_EQ(offload.take_messages(),
              std::vector<std::string>{"merging vertices: CUDA: unspecified launch failure; the "
                                       "CPU does it, with the same result"});
}

/// One of several threads that share a system.
struct OneOfThreads {
    std::size_t thread, threads;
    std::barrier<>& all;
    void sync() const { all.arrive_and_wait(); }
};

TEST(Offload, ThreadsOfABlockGiveTheBytesOfOne) {
    constexpr std::size_t kPoints = 40, kNodes = 3, kNeighbors = 9;
    std::mt19937 random(3);
    std::vector<double> points, values, nodes{0.5, 0.5, 0.1, 0.9};
    std::vector<std::int32_t> neighbors;
    for (std::size_t p = 0; p < kPoints; ++p) {
        points.push_back(static_cast<double>(random()) * 0x1p-32);
        points.push_back(static_cast<double>(random()) * 0x1p-32);
        values.push_back(points.back() * points.back());
    }
    nodes.insert(nodes.end(), {points[0], points[1]});  // on a point
    for (std::size_t i = 0; i < kNodes * kNeighbors; ++i)
        neighbors.push_back(static_cast<std::int32_t>((i + 22 * (i / 18)) % kPoints));
    const std::vector<interpolation::CovarianceStructure> structures{
        {interpolation::VariogramModel::kMatern32, 0, 1, 1, 0, 0.6, 0},
        {interpolation::VariogramModel::kSpherical, 0, 2, 2, 0, 0.3, 0}};
    neighbors[2 * kNeighbors] = 0;
    std::vector<double> one(2 * kNodes), several(2 * kNodes);
    KrigingSystems systems{points.data(),     values.data(), kPoints,   structures.data(),
                           structures.size(), nodes.data(),  kNodes,    neighbors.data(),
                           kNeighbors,        true,          one.data()};
    std::vector<double> memory(SystemLayout{kNeighbors}.numbers());
    for (std::size_t node = 0; node < kNodes; ++node)
        KrigeNode{systems}(SingleThread{}, node, memory.data());
    EXPECT_EQ(one[5], 0);
    EXPECT_EQ(one[4], values[0]);
    systems.estimates = several.data();
    for (const std::size_t threads : {2U, 5U, 16U}) {
        for (std::size_t node = 0; node < kNodes; ++node) {
            std::barrier<> all(static_cast<std::ptrdiff_t>(threads));
            std::vector<std::jthread> running;
            for (std::size_t thread = 0; thread < threads; ++thread) {
                running.emplace_back([&, thread] {
                    KrigeNode{systems}(OneOfThreads{thread, threads, all}, node, memory.data());
                });
            }
        }
        EXPECT_EQ(several, one) << threads;
    }
}

}  // namespace
}  // namespace realmodel::cuda
