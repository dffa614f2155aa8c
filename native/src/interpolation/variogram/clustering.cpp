// SPDX-License-Identifier: GPL-3.0-or-later
#include "interpolation/variogram/clustering.hpp"

#include <cmath>
#include <cstdint>
#include <vector>

#include "realmodel/interpolation/convex_hull.hpp"

namespace realmodel::interpolation {

namespace {

constexpr std::size_t kAsked = 4000;  // an even part shows it
constexpr double kClustered = 0.5;    // of the distance that is expected of random points

double area_of_hull(const ManyPoints& points) {
    std::vector<Position> positions;
    for (const std::int32_t point : even_part(points.size(), kMostInMemory))
        positions.push_back(points.local(static_cast<std::size_t>(point)));
    const std::vector<std::int32_t> border = hull_border(positions);
    double twice = 0;
    for (std::size_t i = 0; i < border.size(); ++i) {
        const Position& a = positions[border[i]];
        const Position& b = positions[border[(i + 1) % border.size()]];
        twice += a[0] * b[1] - a[1] * b[0];
    }
    return twice / 2;
}

}  // namespace

double buffer_of_clusters(const ManyPoints& points, const Execution& execution) {
    if (points.size() < 3) return 0;
    const std::vector<std::int32_t> asked = even_part(points.size(), kAsked);
    const std::vector<spatial::Neighbor> near =
        points.nearest(IsotropicSpace({}), asked, 2, execution);
    double sum = 0;
    for (std::size_t k = 1; k < near.size(); k += 2)
        sum += std::sqrt(near[k].squared_distance);
    const double mean = sum / static_cast<double>(asked.size());
    const double spacing = std::sqrt(area_of_hull(points) / static_cast<double>(points.size()));
    return mean < kClustered * spacing / 2 ? 2 * spacing : 0;
}

}  // namespace realmodel::interpolation
