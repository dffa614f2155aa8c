// SPDX-License-Identifier: GPL-3.0-or-later
#include "realmodel/interpolation/kriging.hpp"

#include <gtest/gtest.h>

#include <atomic>
#include <cstring>
#include <functional>
#include <string>
#include <thread>

#include "../../sanitized.hpp"
#include "../dense_kriging.hpp"
#include "../variogram_models.hpp"
#include "realmodel/base/errors.hpp"
#include "realmodel/base/progress.hpp"

namespace realmodel::interpolation {
namespace {

Variogram spherical(double range, double sill, double nugget = 0) {
    return {VariogramModel::kSpherical, range, sill, nugget, {}};
}

InputError refusal(const std::function<void()>& run) {
    try {
        run();
    } catch (const InputError& error) {
        return error;
    }
    ADD_FAILURE() << "not refused";
    return InputError("none", "none");
}

void expect_as_dense(const Points& points, const Nodes& nodes, const Variogram& variogram,
                     int neighbors, double tolerance) {
    const Kriged kriged = krige(points, nodes, variogram, {{neighbors}});
    const std::size_t count = neighbors == 0 ? points.size() : static_cast<std::size_t>(neighbors);
    for (std::size_t i = 0; i < nodes.size(); i += kSanitized ? 15 : 1) {
        const auto [z, variance] = dense_kriging(points, nodes[i], variogram, count);
        ASSERT_NEAR(kriged.z[i], z, tolerance * variogram.sill);
        ASSERT_NEAR(kriged.variance[i], variance, tolerance * variogram.sill);
    }
}

TEST(Kriging, TwoPointsByHand) {
    // In the middle of two points h apart both weigh a half: variance 2 gamma(h/2) - gamma(h)/2.
    const Points points{{0, 0, 1}, {4, 0, 5}};
    const Variogram v = spherical(10, 2);
    for (const int neighbors : {0, 2, 16}) {
        const Kriged kriged = krige(points, Nodes{{2, 0}}, v, {{neighbors}});
        EXPECT_NEAR(kriged.z[0], 3, 1e-14);
        const double gamma2 = 2 * (0.3 - 0.5 * 0.008), gamma4 = 2 * (0.6 - 0.5 * 0.064);
        EXPECT_NEAR(kriged.variance[0], 2 * gamma2 - gamma4 / 2, 1e-14);
    }
}

TEST(Kriging, OnePointIsAConstant) {
    const Kriged kriged =
        krige(Points{{3, 4, 7}}, Nodes{{3, 4}, {3, 5}, {1e6, -1e6}}, spherical(10, 2), {});
    EXPECT_EQ(kriged.z, (std::vector<double>{7, 7, 7}));
    EXPECT_EQ(kriged.variance[0], 0);
    EXPECT_DOUBLE_EQ(kriged.variance[1], 2 * 2 * (1.5 * 0.1 - 0.5 * 0.001));
    EXPECT_DOUBLE_EQ(kriged.variance[2], 4);  // the sill, and the variance of the mean beside it
}

TEST(Kriging, AsDenseAlgebraForEveryModel) {
    const Points points = hills(120, 100);
    const Nodes nodes = scattered_nodes(60, 110);
    for (const VariogramModel model : kAllVariogramModels) {
        SCOPED_TRACE(name_of(model));
        // Short enough a range for the smooth models that the dense system itself is well-posed.
        const bool is_very_smooth =
            model == VariogramModel::kGaussian || model == VariogramModel::kWave;
        const double range = is_very_smooth ? 15 : 60;
        for (const double nugget : {0.0, 0.5}) {
            for (const Anisotropy anisotropy : {Anisotropy{}, Anisotropy{2, 30}}) {
                const Variogram v{model, range, 4, nugget, anisotropy};
                expect_as_dense(points, nodes, v, 16, 1e-9);
                expect_as_dense(points, nodes, v, 0, 1e-9);
            }
        }
    }
}

TEST(Kriging, AsDenseAlgebraAtUtmCoordinates) {
    const std::array origin{431250.37, 5398781.81};
    expect_as_dense(hills(300, 2000, origin), scattered_nodes(50, 2000, origin),
                    spherical(900, 25, 1), 16, 1e-9);
    expect_as_dense(hills(300, 2000, origin), scattered_nodes(50, 2000, origin),
                    spherical(900, 25, 1), 0, 1e-9);
}

TEST(Kriging, AsDenseAlgebraAcrossTiles) {
    // More points than three tiles of the factor, and more nodes than two chunks of right sides.
    expect_as_dense(hills(400, 100), scattered_nodes(150, 100), spherical(40, 4), 0, 1e-9);
    expect_as_dense(hills(300, 100), scattered_nodes(4, 100), spherical(40, 4), 130, 1e-9);
}

TEST(Kriging, AzimuthCountsClockwiseFromNorth) {
    // Long range to the north-east: the point there weighs more than the one to the north-west.
    const Points points{{10, 10, 1}, {-10, 10, 0}};
    const Variogram v{VariogramModel::kSpherical, 100, 1, 0, {4, 45}};
    EXPECT_GT(krige(points, Nodes{{0, 0}}, v, {}).z[0], 0.7);
    const Variogram other_way{VariogramModel::kSpherical, 100, 1, 0, {0.25, 45}};
    EXPECT_EQ(krige(points, Nodes{{0, 0}}, v, {}).z[0],
              krige(points, Nodes{{0, 0}}, other_way, {}).z[0]);
}

TEST(Kriging, HonorsTheDataAndMergesRepeats) {
    Points points = hills(50, 10, {5e5, 5e6});
    Nodes nodes;
    for (const auto& p : points)
        nodes.push_back({p[0], p[1]});
    points.push_back(points[7]);
    points.push_back(points[7]);
    for (const int neighbors : {0, 16}) {
        for (const double nugget : {0.0, 1.0}) {
            const Kriged kriged = krige(points, nodes, spherical(5, 4, nugget), {{neighbors}});
            for (std::size_t i = 0; i < nodes.size(); ++i) {
                EXPECT_EQ(kriged.z[i], points[i][2]);
                EXPECT_EQ(kriged.variance[i], 0);
            }
        }
    }
}

TEST(Kriging, NearAPointNearItsValue) {
    const Points points = hills(200, 100);
    const Nodes node{{points[3][0] + 1e-9, points[3][1]}};
    const Kriged kriged = krige(points, node, spherical(50, 4), {});
    EXPECT_NEAR(kriged.z[0], points[3][2], 1e-7);
    EXPECT_LT(kriged.variance[0], 1e-8);
    EXPECT_GE(kriged.variance[0], 0);
}

TEST(Kriging, SymmetryGivesEqualWeights) {
    const Points square{{0, 0, 1}, {1, 0, 2}, {1, 1, 3}, {0, 1, 6}};
    EXPECT_NEAR(krige(square, Nodes{{0.5, 0.5}}, spherical(3, 1), {}).z[0], 3, 1e-13);
}

TEST(Kriging, PureNuggetIsTheMean) {
    const Points points{{0, 0, 1}, {1, 0, 2}, {5, 1, 6}};
    const Kriged kriged = krige(points, Nodes{{0.5, 0.5}}, spherical(3, 2, 2), {});
    EXPECT_NEAR(kriged.z[0], 3, 1e-13);
    EXPECT_NEAR(kriged.variance[0], 2 + 2.0 / 3, 1e-13);
}

/// Values stay within the data's span by a margin and are numbers; so do variances.
void expect_sane(const Points& points, const Nodes& nodes, const Variogram& v, int neighbors) {
    double low = points[0][2], high = low;
    for (const auto& p : points) {
        low = std::min(low, p[2]);
        high = std::max(high, p[2]);
    }
    const double margin = 2 * (high - low) + 1e-9;
    const Kriged kriged = krige(points, nodes, v, {{neighbors}});
    for (std::size_t i = 0; i < nodes.size(); ++i) {
        ASSERT_GE(kriged.z[i], low - margin);
        ASSERT_LE(kriged.z[i], high + margin);
        ASSERT_GE(kriged.variance[i], 0);
        ASSERT_LE(kriged.variance[i], 4 * v.sill);
    }
}

TEST(Kriging, NearlySingularSystems) {
    Points line, cluster, twins;
    for (int i = 0; i < 60; ++i)
        line.push_back({1.0 * i, 2.0 * i, std::sin(0.1 * i)});
    std::mt19937 random(4);
    for (int i = 0; i < 60; ++i) {
        const double x = 1e-7 * static_cast<double>(random() % 1000);
        const double y =
            1e-7 * static_cast<double>(random() % 1000 + 1000U * static_cast<unsigned>(i));
        cluster.push_back({x, y, 1 + x + y});
    }
    for (int i = 0; i < 30; ++i) {
        twins.push_back({1.0 * i, 0, 1.0 * i});
        twins.push_back({std::nextafter(1.0 * i, 100), 0, 1.0 * i});
    }
    // Smooth models go on beyond the data as polynomials do: ask near them.
    const Nodes nodes = scattered_nodes(100, 60), near_cluster = scattered_nodes(100, 0.006);
    for (const VariogramModel model : kAllVariogramModels) {
        SCOPED_TRACE(name_of(model));
        for (const int neighbors : {0, 16}) {
            for (const double range : {5.0, 100.0, 1e6}) {
                const Variogram v{model, range, 1, 0, {}};
                expect_sane(line, nodes, v, neighbors);
                expect_sane(cluster, near_cluster, v, neighbors);
                expect_sane(twins, nodes, v, neighbors);
            }
        }
    }
}

TEST(Kriging, GaussianWithoutNuggetFollowsASmoothSurface) {
    Points points;
    for (int y = 0; y < 12; ++y) {
        for (int x = 0; x < 12; ++x)
            points.push_back({1.0 * x, 1.0 * y, 3 + 0.5 * x - 0.2 * y});
    }
    const Variogram v{VariogramModel::kGaussian, 20, 10, 0, {}};
    for (const int neighbors : {0, 16}) {
        const Kriged kriged = krige(points, Nodes{{5.5, 5.5}, {3.3, 7.1}}, v, {{neighbors}});
        EXPECT_NEAR(kriged.z[0], 3 + 0.5 * 5.5 - 0.2 * 5.5, 1e-3);
        EXPECT_NEAR(kriged.z[1], 3 + 0.5 * 3.3 - 0.2 * 7.1, 1e-3);
    }
}

TEST(Kriging, SameBytesForAnyNumberOfThreads) {
    const Points points = hills(kSanitized ? 400 : 700, 100);
    const Nodes nodes = scattered_nodes(kSanitized ? 600 : 2000, 100);
    for (const int neighbors : {0, 16}) {
        const Kriged one = krige(points, nodes, spherical(40, 4), {{neighbors}}, {1});
        for (const int threads : {2, 3, 5}) {
            if (kSanitized && threads != 3) continue;
            const Kriged more = krige(points, nodes, spherical(40, 4), {{neighbors}}, {threads});
            EXPECT_EQ(std::memcmp(one.z.data(), more.z.data(), 8 * nodes.size()), 0);
            EXPECT_EQ(std::memcmp(one.variance.data(), more.variance.data(), 8 * nodes.size()), 0);
        }
    }
}

TEST(Kriging, RefusesWhatIsNoInput) {
    const Points points{{0, 0, 1}, {4, 0, 5}, {2, 2, 2}};
    const Nodes nodes{{1, 1}};
    EXPECT_EQ(refusal([&] { krige({}, nodes, spherical(1, 1), {}); }).kind, "no_points");
    const double nan = std::nan("");
    const InputError bad_point = refusal([&] {
        krige(Points{{0, 0, 1}, {0, 1, nan}}, nodes, spherical(1, 1), {});
    });
    EXPECT_EQ(bad_point.kind, "not_finite");
    EXPECT_EQ(bad_point.items, (std::vector<std::int64_t>{1}));
    EXPECT_EQ(refusal([&] {
                  krige(points, Nodes{{nan, 0}}, spherical(1, 1), {});
              }).kind,
              "not_finite");
    const InputError contradiction = refusal([&] {
        krige(Points{{1, 1, 1}, {4, 0, 5}, {1, 1, 1}, {4, 0, 6}}, nodes, spherical(1, 1), {});
    });
    EXPECT_EQ(contradiction.kind, "contradicting_points");
    EXPECT_EQ(contradiction.items, (std::vector<std::int64_t>{1, 3}));
    EXPECT_EQ(*contradiction.place, (std::array<double, 3>{4, 0, 5}));
    for (const Variogram& v : {spherical(0, 1), spherical(1, 0), spherical(1, 1, 2),
                               spherical(1, 1, -1), spherical(nan, 1)}) {
        EXPECT_EQ(refusal([&] { krige(points, nodes, v, {}); }).kind, "variogram");
    }
    EXPECT_EQ(refusal([&] { krige(points, nodes, spherical(1, 1), {{-1}}); }).kind, "option");
    EXPECT_EQ(refusal([&] { variogram_model("linear"); }).kind, "variogram");
}

TEST(Kriging, RefusesWhatMemoryDoesNotAllow) {
    Points points;
    for (int i = 0; i < 500'000; ++i)
        points.push_back({1.0 * (i % 2000), 1.0 * (i / 2000), 0});
    const InputError error = refusal([&] {
        krige(points, Nodes{{0.5, 0.5}}, spherical(1, 1), {{0}});
    });
    EXPECT_EQ(error.kind, "too_large");
    EXPECT_NE(std::string(error.what()).find("1e+03 GB"), std::string::npos) << error.what();
}

TEST(Kriging, StopsSoonAfterCancel) {
    const Points points = hills(kSanitized ? 800 : 3000, 100);
    const Nodes nodes = scattered_nodes(200'000, 100);
    for (const int neighbors : {0, 64, 256}) {
        Progress progress;
        std::atomic<double> asked{};
        std::jthread watcher([&] {
            while (progress.fraction() < 0.001)
                std::this_thread::yield();
            progress.cancel();
            asked = progress.fraction();
        });
        EXPECT_THROW(krige(points, nodes, spherical(40, 4), {{neighbors}}, {2, &progress}),
                     Cancelled);
        watcher.join();
        // What each of two threads had in hand: at most 512 of the nodes, however long that takes.
        EXPECT_LT(progress.fraction() - asked.load(), 0.01);
    }
}

TEST(Kriging, NoNodesIsNoWork) {
    EXPECT_TRUE(krige(Points{{0, 0, 1}}, {}, spherical(1, 1), {}).z.empty());
}

TEST(Kriging, SlopesOverTheBaselineAreThoseOfTheDips) {
    const Points points = hills(40, 100, {4e5, 5e6});
    const Nodes positions{{4e5 + 20, 5e6 + 30}, {4e5 + 70, 5e6 + 55}};
    const Nodes slopes{{0.4, -0.3}, {0, 0.2}};
    for (const VariogramModel model : kAllVariogramModels) {
        for (const Drift drift : {Drift::kConstant, Drift::kLinear}) {
            SCOPED_TRACE(std::string(name_of(model)));
            const Variogram variogram{model, 60, 9, 0, {2, 30}, {}};
            KrigingOptions options{{0}, drift, {positions, slopes, 6, 0}};
            for (std::size_t i = 0; i < 2; ++i) {
                const auto [x, y] = positions[i];
                const Nodes ends{{x + 3, y}, {x - 3, y}, {x, y + 3}, {x, y - 3}};
                const Kriged all = krige(points, ends, variogram, options);
                EXPECT_NEAR((all.z[0] - all.z[1]) / 6, slopes[i][0], 1e-8);
                EXPECT_NEAR((all.z[2] - all.z[3]) / 6, slopes[i][1], 1e-8);
            }
        }
    }
}

TEST(Kriging, WaysOfKrigingAgreeOnDips) {
    const Points points = hills(40, 100, {4e5, 5e6});
    const Nodes positions{{4e5 + 20, 5e6 + 30}, {4e5 + 70, 5e6 + 55}, {4e5 + 40, 5e6 + 90}};
    const Nodes slopes{{0.4, -0.3}, {0, 0.2}, {0.1, 0.1}},
        nodes = scattered_nodes(60, 100, {4e5, 5e6});
    const Variogram variogram{VariogramModel::kMatern52, 60, 9, 0.1, {}, {}};
    for (const Drift drift : {Drift::kConstant, Drift::kLinear}) {
        const Dips dips{positions, slopes, 0.5, 0};
        const Kriged all = krige(points, nodes, variogram, {{0}, drift, dips});
        const Kriged far = krige(points, nodes, variogram, {{40, 0, 1e6}, drift, dips});
        const Kriged few =
            krige(points, nodes, variogram, {{16}, drift, {positions, slopes, 0.5, 2}});
        const Kriged within =
            krige(points, nodes, variogram, {{16, 0, 1e6}, drift, {positions, slopes, 0.5, 2}});
        for (std::size_t i = 0; i < nodes.size(); ++i) {
            EXPECT_NEAR(all.z[i], far.z[i], 1e-8);
            EXPECT_NEAR(all.variance[i], far.variance[i], 1e-8);
            EXPECT_NEAR(few.z[i], within.z[i], 1e-8);
            EXPECT_NEAR(few.variance[i], within.variance[i], 1e-8);
        }
        const Kriged left_out = krige_left_out(points, variogram, {{0}, drift, dips});
        Points others(points.begin() + 1, points.end());
        const Kriged first =
            krige(others, Nodes{{points[0][0], points[0][1]}}, variogram, {{0}, drift, dips});
        EXPECT_NEAR(left_out.z[0], first.z[0], 1e-7);
        EXPECT_NEAR(left_out.variance[0], first.variance[0], 1e-7);
    }
}

}  // namespace
}  // namespace realmodel::interpolation
