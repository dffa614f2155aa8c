// SPDX-License-Identifier: GPL-3.0-or-later
#include "meshing/requested_sizes.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>

#include "base/keep_single.hpp"
#include "meshing/point_insertion.hpp"
#include "realmodel/base/errors.hpp"
#include "spatial/nearest_points.hpp"

namespace realmodel::meshing {

namespace {

// Edges half as long as the points are apart: each point gets a few triangles of its own.
constexpr double kEdgesPerSpacing = 2;
constexpr double kLongestShare = 4, kShortestShare = 1.0 / 64;
constexpr std::size_t kCountedNeighbors = 8;

void check_size(const LocalLength& size, std::size_t number, double edge_length) {
    const auto refuse = [&](const std::string& what) {
        throw InputError("size", "size " + std::to_string(number) + ": " + what, -1,
                         {static_cast<std::int64_t>(number)});
    };
    if (!(size.length > 0) || !std::isfinite(size.length)) {
        refuse("its length must be a finite number above 0");
    }
    if (!(size.distance >= 0) || !std::isfinite(size.distance)) {
        refuse("its distance must be a finite number from 0");
    }
    if (edge_length > 0 && size.length >= edge_length) {
        refuse("its length must be shorter than the edge length elsewhere");
    }
    for (const PlanPoint& p : size.line) {
        if (!std::isfinite(p[0]) || !std::isfinite(p[1]))
            refuse("a coordinate of its position is not a finite number");
    }
}

}  // namespace

double longest_by_density(const RegionGraph& graph, const MeshRequest& request) {
    return kLongestShare * std::sqrt(graph.area / static_cast<double>(request.density.size())) /
           kEdgesPerSpacing;
}

std::vector<SizeSource> requested_sources(const RegionGraph& graph, const MeshRequest& request,
                                          double edge_length, double scale) {
    std::vector<SizeSource> sources;
    for (std::size_t i = 0; i < request.sizes.size(); ++i) {
        const LocalLength& size = request.sizes[i];
        check_size(size, i, request.triangles > 0 || !request.density.empty() ? 0 : edge_length);
        const double start = size.length - kGradation * size.distance;
        if (size.line.empty()) {
            for (const auto& [from, to] : graph.border)
                sources.push_back({graph.points[from], graph.points[to], start, size.length});
        } else if (size.line.size() == 1) {
            sources.push_back({size.line[0], size.line[0], start, size.length});
        }
        for (std::size_t k = 1; k < size.line.size(); ++k)
            sources.push_back({size.line[k - 1], size.line[k], start, size.length});
    }
    if (request.density.empty()) return sources;

    std::vector<PlanPoint> points = request.density;
    for (std::size_t i = 0; i < points.size(); ++i) {
        if (std::isfinite(points[i][0]) && std::isfinite(points[i][1])) continue;
        throw InputError("density", "point " + std::to_string(i) + " is not a finite number", -1,
                         {static_cast<std::int64_t>(i)});
    }
    sort_unique(points);
    if (points.size() < 2) {
        throw InputError("density", "an edge length by density needs two points at least");
    }
    const double longest = longest_by_density(graph, request);
    const std::size_t neighbors = std::min(kCountedNeighbors, points.size() - 1);
    const spatial::NearestPoints nearest(points);
    std::vector<spatial::Neighbor> found;
    for (const PlanPoint& p : points) {
        nearest.find(p, neighbors + 1, found);  // the first is the point itself
        // So many points lie in a circle of that radius.
        const double spacing = std::sqrt(found.back().squared_distance * std::numbers::pi /
                                         static_cast<double>(neighbors));
        const double wanted =
            scale * std::clamp(spacing / kEdgesPerSpacing, kShortestShare * longest, longest);
        sources.push_back({p, p, wanted, wanted});
    }
    return sources;
}

double pieces_along(std::span<const SizeSource> sources, const PlanPoint& low,
                    const PlanPoint& high) {
    double pieces = 0;
    for (const SizeSource& source : sources) {
        // The part of the segment in the box, from share t to share u (Liang and Barsky 1984).
        double t = 0, u = 1;
        for (int k = 0; k < 2; ++k) {
            const double run = source.b[k] - source.a[k];
            if (run == 0) {
                if (source.a[k] < low[k] || source.a[k] > high[k]) u = -1;
                continue;
            }
            const double first = (low[k] - source.a[k]) / run, last = (high[k] - source.a[k]) / run;
            t = std::max(t, std::min(first, last));
            u = std::min(u, std::max(first, last));
        }
        if (u > t) {
            pieces += (u - t) * std::sqrt(squared_distance(source.a, source.b)) / source.least;
        }
    }
    return pieces;
}

std::vector<double> lattice_lengths(const MeshRequest& request, SizeField& size) {
    constexpr double kClearlyShorter = 0.8;  // else two lattices would collide
    std::vector<double> lengths{size.largest()};
    std::vector<double> wanted;
    for (const LocalLength& local : request.sizes)
        if (local.distance > 2 * local.length) wanted.push_back(local.length);
    std::sort(wanted.rbegin(), wanted.rend());
    for (const double length : wanted)
        if (length < kClearlyShorter * lengths.back()) lengths.push_back(length);
    return lengths;
}

double triangles_in(const RegionGraph& graph, SizeField& size, const Check& check) {
    constexpr double kEquilateral = std::numbers::sqrt3 / 4;  // the area at side 1
    constexpr double kNextToNothing = 0.25 * kEquilateral;
    if (size.is_uniform()) return graph.area / (kEquilateral * size.largest() * size.largest());
    Ticker tick(check);
    double triangles = 0;
    std::vector<std::array<PlanPoint, 3>> open;
    for (std::size_t t = 0; t < graph.inside.size(); ++t) {
        const auto& [a, b, c] = graph.triangulation.triangles[t];
        if (graph.inside[t]) open.push_back({graph.points[a], graph.points[b], graph.points[c]});
    }
    while (!open.empty()) {
        tick(0);
        const std::array<PlanPoint, 3> corners = open.back();
        open.pop_back();
        const auto& [a, b, c] = corners;
        const std::array sides{squared_distance(a, b), squared_distance(b, c),
                               squared_distance(c, a)};
        const double wanted = size.at({(a[0] + b[0] + c[0]) / 3, (a[1] + b[1] + c[1]) / 3});
        const auto longest =
            static_cast<std::size_t>(std::ranges::max_element(sides) - sides.begin());
        const double area = 0.5 * twice_area(a, b, c);
        // Slivers, of which combs have many, are not cut as long as they hold next to nothing: all
        // of one lies within two thirds of its longest side from its center.
        const double finest =
            std::max(size.smallest(), wanted - kGradation * 2 / 3 * std::sqrt(sides[longest]));
        if (sides[longest] <= 9 * wanted * wanted || area <= kNextToNothing * finest * finest) {
            triangles += area / (kEquilateral * wanted * wanted);
            continue;
        }
        const PlanPoint &from = corners[longest], &to = corners[(longest + 1) % 3],
                        &apex = corners[(longest + 2) % 3], m = middle(from, to);
        open.push_back({from, m, apex});
        open.push_back({m, to, apex});
    }
    return triangles;
}

}  // namespace realmodel::meshing
