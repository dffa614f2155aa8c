// SPDX-License-Identifier: GPL-3.0-or-later
#include "interpolation/kriging/lane_kriging.hpp"

#include <gtest/gtest.h>

#include <cstring>
#include <random>
#include <vector>

#include "../../../cuda/offload.hpp"
#include "../../sanitized.hpp"
#include "../dense_kriging.hpp"
#include "../variogram_models.hpp"
#include "interpolation/kriging/neighbor_kriging.hpp"
#include "interpolation/neighbors/neighbor_search.hpp"
#include "realmodel/interpolation/kriging.hpp"

namespace realmodel::interpolation {
namespace {

/// Along measured lines, in clusters, on a grid (ties) or anywhere.
Points some_points(const std::string& kind, int count) {
    std::mt19937 random(7);
    const auto uniform = [&] { return static_cast<double>(random()) / 4294967296.0; };
    Points points;
    for (int i = 0; i < count; ++i) {
        double x = 1000 * uniform(), y = 1000 * uniform();
        if (kind == "lines") x = 100 * (i % 10), y = 1000.0 * i / count;
        if (kind == "clusters") x = 250 * (i % 4) + 1e-3 * x, y = 300 * (i % 3) + 1e-3 * y;
        if (kind == "grid") x = 40 * (i % 25), y = 40 * (i / 25);
        points.push_back({431000 + x, 5398000 + y, 20 * std::sin(x / 90) * std::cos(y / 120)});
    }
    return points;
}

Nodes some_nodes(int side) {
    Nodes nodes;
    for (int j = 0; j < side; ++j) {
        for (int i = 0; i < side; ++i)
            nodes.push_back({430900 + 1200.0 * i / side, 5397900 + 1200.0 * j / side});
    }
    return nodes;
}

/// Slopes here and there, the first at a point.
struct SomeDips {
    Nodes positions, slopes;
    Dips with(double baseline, int neighbors) const {
        return {positions, slopes, baseline, neighbors};
    }
};

SomeDips some_dips(const Points& points, std::size_t count) {
    SomeDips dips;
    for (std::size_t i = 0; i < count; ++i) {
        const auto& [x, y, z] = points[7 * i % points.size()];
        const double away = i == 0 ? 0 : 13;
        dips.positions.push_back({x + away, y - 2 * away});
        dips.slopes.push_back({0.1 * std::sin(x / 50), 0.1 * std::cos(z)});
    }
    return dips;
}

std::vector<Estimate> one_by_one(const LinearData& data, const Covariance& covariance,
                                 std::span<const LaneKriging::KrigingNode> nodes, int neighbors) {
    const spatial::NearestPoints tree(data.points().local);
    DataSearch search(data, tree, {neighbors, 0, 0});
    NeighborKriging kriging(data, covariance, Drift::kConstant);
    std::vector<spatial::Neighbor> near;
    std::vector<Estimate> out;
    for (const LaneKriging::KrigingNode& node : nodes) {
        search.find(node.position, near, node.left_out);
        const bool on_point = node.left_out < 0 && near[0].squared_distance == 0;
        out.push_back(on_point ? Estimate{data.value(near[0].point, 0), 0}
                               : kriging.at(node.position, near));
    }
    return out;
}

/// What a device computes, all at once or in tiles, and what is left to the lanes.
void expect_same_bytes_of_devices(const Points& points, const Nodes& nodes,
                                  const Variogram& variogram, int neighbors, bool leave_out) {
    const KrigingOptions options{{neighbors, 0, 0}};
    const auto kriged = [&](const Device* device) {
        const Execution execution{1, nullptr, device};
        return leave_out ? krige_left_out(points, variogram, options, execution)
                         : krige(points, nodes, variogram, options, execution);
    };
    const Kriged expected = kriged(nullptr);
    for (const std::size_t memory : {std::size_t{100}, std::size_t{30'000}, SIZE_MAX}) {
        SCOPED_TRACE(memory);
        cuda::Offload<cuda::CpuBackend> device("", std::make_unique<cuda::CpuBackend>(memory), 2);
        const Kriged found = kriged(&device.device());
        const auto messages = device.take_messages();
        EXPECT_TRUE(memory == 30'000 || messages.empty() == (memory == SIZE_MAX));
        ASSERT_EQ(found.z.size(), expected.z.size());
        for (const auto part : {&Kriged::z, &Kriged::variance}) {
            EXPECT_EQ(std::memcmp((found.*part).data(), (expected.*part).data(),
                                  expected.z.size() * sizeof(double)),
                      0);
        }
    }
}

void expect_same_bytes(const Points& points, const Nodes& nodes, const Variogram& variogram,
                       int neighbors, bool leave_out, const Dips& dips = {}) {
    const DataPoints distinct = prepare_points(points);
    const Covariance covariance(variogram);
    const LinearData data(distinct, dips, covariance.scales_over(dips.baseline));
    std::vector<LaneKriging::KrigingNode> all;
    if (leave_out) {
        for (std::uint32_t i = 0; i < distinct.local.size(); ++i)
            all.push_back({distinct.local[i], i, static_cast<std::int32_t>(i)});
    } else {
        for (std::uint32_t i = 0; i < nodes.size(); ++i)
            all.push_back({distinct.to_local(nodes[i]), i});
    }
    const std::vector<Estimate> expected = one_by_one(data, covariance, all, neighbors);
    const spatial::NearestPoints tree(distinct.local);
    for (const LaneKernels& kernels : lane_kernels()) {
        SCOPED_TRACE(kernels.name);
        LaneKriging kriging(data, tree, covariance, static_cast<std::size_t>(neighbors), leave_out,
                            kernels);
        std::vector<Estimate> found(all.size(), Estimate{-1, -1});
        kriging.krige(
            all, [&](std::uint32_t i, const Estimate& e) { found[i] = e; }, [](std::uint32_t) {});
        for (std::size_t i = 0; i < all.size(); ++i) {
            ASSERT_EQ(std::memcmp(&found[i], &expected[i], sizeof(Estimate)), 0)
                << "node " << i << ": " << found[i].value << " " << expected[i].value << "; "
                << found[i].variance << " " << expected[i].variance;
        }
    }
    if (dips.positions.empty() && static_cast<std::size_t>(neighbors) <= Device::kMostNeighbors)
        expect_same_bytes_of_devices(points, nodes, variogram, neighbors, leave_out);
}

TEST(LaneKriging, TheBytesOfOneSystemAtATime) {
    for (const std::string kind : {"scattered", "lines", "clusters", "grid"}) {
        for (const VariogramModel model : kAllVariogramModels) {
            SCOPED_TRACE(kind + " " + std::string(name_of(model)));
            const Variogram v{model, 400, 9, 0.01, {2, 30}, {}};
            expect_same_bytes(some_points(kind, 400), some_nodes(21), v, 16, false);
            expect_same_bytes(some_points(kind, 150), {}, v, 5, true);
        }
    }
}

TEST(LaneKriging, NestedVariogramsAndAllSizes) {
    Variogram v{VariogramModel::kExponential, 300, 9, 0, {}, {}};
    v.further.push_back({VariogramModel::kGaussian, 900, 5, {3, 100}});
    for (int neighbors = 1; neighbors <= 64; neighbors += neighbors < 9 ? 1 : kSanitized ? 15 : 5) {
        SCOPED_TRACE(neighbors);
        expect_same_bytes(some_points("scattered", 200), some_nodes(9), v, neighbors, false);
    }
    for (const int neighbors : {65, 129, 256}) {
        if (kSanitized && neighbors == 256) continue;
        SCOPED_TRACE(neighbors);
        expect_same_bytes(some_points("scattered", 400), some_nodes(5), v, neighbors, false);
        expect_same_bytes(some_points("lines", 300), {}, v, neighbors, true);
    }
}

TEST(LaneKriging, PointsThatTheOthersTellArePassedOver) {
    // Without a nugget and of a long range the gaussian model leaves most points nothing to say.
    const Variogram v{VariogramModel::kGaussian, 3000, 9, 0, {}, {}};
    expect_same_bytes(some_points("grid", 400), some_nodes(15), v, 16, false);
    expect_same_bytes(some_points("clusters", 100), {}, v, 16, true);
}

TEST(LaneKriging, NodesFarApartAndOnPoints) {
    const Points points = some_points("scattered", 300);
    Nodes nodes{{0, 0}, {1e7, -1e7}, {431500, 5398500}, {431500, 5398500}};
    for (const auto& p : points)
        nodes.push_back({p[0], p[1]});
    expect_same_bytes(points, nodes, {VariogramModel::kSpherical, 300, 9}, 12, false);
}

/// All kernels the same bytes, and what NeighborKriging says of each node; how many were left to
/// it.
std::size_t left_to_others(const Points& points, const Nodes& nodes, const Variogram& variogram,
                           int neighbors, Drift drift, const Dips& dips = {}) {
    const DataPoints distinct = prepare_points(points);
    const Covariance covariance(variogram);
    const LinearData data(distinct, dips, covariance.scales_over(dips.baseline));
    const spatial::NearestPoints tree(distinct.local);
    DataSearch search(data, tree, {neighbors, 0, 0});
    NeighborKriging plain(data, covariance, drift);
    std::vector<spatial::Neighbor> near;
    std::vector<LaneKriging::KrigingNode> all;
    for (std::uint32_t i = 0; i < nodes.size(); ++i)
        all.push_back({distinct.to_local(nodes[i]), i});
    std::vector<Estimate> first;
    std::size_t left = 0;
    for (const LaneKernels& kernels : lane_kernels()) {
        SCOPED_TRACE(kernels.name);
        LaneKriging kriging(data, tree, covariance, static_cast<std::size_t>(neighbors), false,
                            kernels, drift);
        std::vector<Estimate> found(all.size(), Estimate{-1, -1});
        left = 0;
        kriging.krige(
            all, [&](std::uint32_t i, const Estimate& e) { found[i] = e; },
            [&](std::uint32_t) { ++left; });
        if (first.empty()) first = found;
        EXPECT_EQ(std::memcmp(first.data(), found.data(), first.size() * sizeof(Estimate)), 0);
    }
    for (std::size_t i = 0; i < all.size(); ++i) {
        if (first[i].variance == -1) continue;
        search.find(all[i].position, near);
        if (near[0].squared_distance == 0) continue;
        const Estimate one = plain.at(all[i].position, near);
        EXPECT_NEAR(first[i].value, one.value, 1e-9 * (1 + one.variance)) << i;
        EXPECT_NEAR(first[i].variance, one.variance, 1e-9 * (1 + one.variance)) << i;
    }
    return left;
}

TEST(LaneKriging, AboutADriftWhatOneSystemAtATimeSays) {
    for (const Drift drift : {Drift::kLinear, Drift::kQuadratic}) {
        for (const VariogramModel model : kAllVariogramModels) {
            if (kSanitized && model != kAllVariogramModels[0]) continue;
            SCOPED_TRACE(std::string(name_of(model)));
            const Variogram v{model, 400, 9, 0.01, {2, 30}, {}};
            const Points scattered = some_points("scattered", 400);
            EXPECT_LT(left_to_others(scattered, some_nodes(21), v, 16, drift), 20U);
            EXPECT_EQ(left_to_others(scattered, some_nodes(9), v, 64, drift), 0U);
        }
    }
}

TEST(LaneKriging, WithDipsTheBytesOfOneSystemAtATime) {
    for (const std::string kind : {"scattered", "clusters", "grid"}) {
        const Points points = some_points(kind, 200), few = some_points(kind, 60);
        const SomeDips dips = some_dips(points, 30);
        for (const VariogramModel model : kAllVariogramModels) {
            SCOPED_TRACE(kind + " " + std::string(name_of(model)));
            const Variogram v{model, 400, 9, 0.01, {2, 30}, {}};
            expect_same_bytes(points, some_nodes(13), v, 16, false, dips.with(8, 3));
            expect_same_bytes(few, {}, v, 5, true, dips.with(40, 1));
            expect_same_bytes(few, some_nodes(5), v, 60, false, dips.with(8, 29));
        }
    }
}

TEST(LaneKriging, WithDipsAboutADriftWhatOneSystemAtATimeSays) {
    const Points points = some_points("scattered", 200);
    const SomeDips dips = some_dips(points, 30);
    for (const Drift drift : {Drift::kLinear, Drift::kQuadratic}) {
        for (const VariogramModel model : kAllVariogramModels) {
            SCOPED_TRACE(std::string(name_of(model)));
            const Variogram v{model, 400, 9, 0.01, {2, 30}, {}};
            EXPECT_LT(left_to_others(points, some_nodes(15), v, 16, drift, dips.with(8, 3)), 20U);
        }
    }
}

TEST(LaneKriging, ADriftThatThePointsDoNotShowIsLeftToOthers) {
    const Variogram v{VariogramModel::kSpherical, 400, 9, 0.01, {}, {}};
    const Nodes nodes = some_nodes(9);
    Points line;
    for (int i = 0; i < 60; ++i)
        line.push_back({431000 + 10.0 * i, 5398000 + 7.0 * i, std::sin(i / 5.0)});
    EXPECT_EQ(left_to_others(line, nodes, v, 16, Drift::kLinear), nodes.size());
    const Points scattered = some_points("scattered", 50);
    EXPECT_EQ(left_to_others(scattered, nodes, v, 2, Drift::kLinear), nodes.size());
    EXPECT_EQ(left_to_others(scattered, nodes, v, 5, Drift::kQuadratic), nodes.size());
    const Variogram smooth{VariogramModel::kGaussian, 3000, 9, 0, {}, {}};
    EXPECT_GT(left_to_others(some_points("grid", 400), nodes, smooth, 16, Drift::kLinear), 0U);
}

}  // namespace
}  // namespace realmodel::interpolation
