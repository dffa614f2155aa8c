// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "../dense_kriging.hpp"
#include "interpolation/variogram/leave_one_out.hpp"
#include "interpolation/variogram/many_points.hpp"
#include "realmodel/interpolation/variogram_fit.hpp"

namespace realmodel::interpolation {
namespace {

double buffer_of(const Points& points) {
    return buffer_of_clusters(ManyPoints(points), {});
}

TEST(Clustering, RandomPointsAreNotClustered) {
    EXPECT_EQ(buffer_of(hills(300, 1000, {4e5, 5e6})), 0);
    EXPECT_EQ(buffer_of(Points{{0, 0, 1}, {1, 0, 1}}), 0);
    EXPECT_EQ(buffer_of(Points{{0, 0, 1}, {1, 0, 1}, {2, 0, 1}, {9, 0, 1}}), 0)
        << "in one line they have no hull";
}

/// Sections of the surface z = 0.1 x + 0.05 y, each point along them 1 from the next.
Points sections() {
    Points points;
    for (const double line : {0.0, 50.0, 100.0}) {
        for (int i = 0; i <= 100; ++i)
            points.push_back({line, 1.0 * i, 0.1 * line + 0.05 * i});
    }
    return points;
}

TEST(Clustering, PointsAlongSectionsAre) {
    const double spacing = std::sqrt(100.0 * 100.0 / 303.0);
    EXPECT_NEAR(buffer_of(sections()), 2 * spacing, 1e-12);
}

TEST(Clustering, OthersNearAPointAreLeftOutWithIt) {
    const Points points = sections();
    const ManyPoints data(points);
    const LeaveOneOut near(data, 4, 303, 0, {1, nullptr}), far(data, 4, 303, 10, {1, nullptr});
    const Variogram v{VariogramModel::kExponential, 100, 1, 0, {}, {}};
    const std::vector<double> variances = near.errors(Covariance(v)).variances;
    const std::vector<double> beyond = far.errors(Covariance(v)).variances;
    for (std::size_t k = 0; k < variances.size(); ++k)
        EXPECT_GT(beyond[k], 4 * variances[k]);
}

TEST(Clustering, WherePointsAreTooFewBeyondTheFarthestPredict) {
    const Points points = hills(12, 1000, {0, 0});
    const ManyPoints data(points);
    const LeaveOneOut all(data, 11, 12, 0, {1, nullptr}), beyond(data, 11, 12, 1e6, {1, nullptr});
    const Covariance covariance({VariogramModel::kMatern32, 500, 4, 0.1, {}, {}});
    EXPECT_EQ(all.errors(covariance).errors, beyond.errors(covariance).errors);
}

}  // namespace
}  // namespace realmodel::interpolation
