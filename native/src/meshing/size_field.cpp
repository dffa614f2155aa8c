// SPDX-License-Identifier: GPL-3.0-or-later
#include "meshing/size_field.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>
#include <string>

#include "base/algorithms.hpp"
#include "base/vectors.hpp"
#include "realmodel/base/errors.hpp"
#include "spatial/nearest_points.hpp"

namespace realmodel::meshing {

namespace {

constexpr std::int32_t kDeepest = 40;   // a cell then is 1e-12 of the region
constexpr double kLeafPerLength = 1.5;  // width of a leaf in lengths wanted there

double distance(const SizeSource& source, double x, double y) {
    const PlanPoint way = minus(source.b, source.a), off = minus({x, y}, source.a);
    const double share = nearest_share(source.a, source.b, {x, y});
    return length(moved(off, -share, way));  // hypot took a third of the time of all meshing
}

}  // namespace

SizeField::SizeField(double largest, double gradation, std::vector<SizeSource> sources,
                     const PlanPoint& low, const PlanPoint& high, double most_leaves)
    : largest_(largest),
      smallest_(largest),
      gradation_(gradation),
      most_leaves_(most_leaves),
      low_(low),
      sources_(std::move(sources)) {
    std::erase_if(sources_, [&](const SizeSource& source) { return source.least >= largest; });
    if (sources_.empty()) return;
    if (static_cast<double>(sources_.size()) > std::numeric_limits<std::int32_t>::max()) {
        throw InputError("too_large", "there are more local lengths than 32-bit numbers can count");
    }
    width_ = std::max(high[0] - low[0], high[1] - low[1]);
    const PlanPoint center{low[0] + width_ / 2, low[1] + width_ / 2};
    for (const SizeSource& source : sources_) {
        const double growth = std::min(gradation_, source.growth);
        const double nearest =
            std::max(0.0, distance(source, center[0], center[1]) - width_ / std::numbers::sqrt2);
        smallest_ = std::min(smallest_, std::max(source.least, source.start + growth * nearest));
    }
    candidates_.resize(sources_.size());
    std::iota(candidates_.begin(), candidates_.end(), 0);
    nodes_.push_back({0, static_cast<std::int32_t>(candidates_.size())});
}

/// What a source asks for at a point, its least length not yet considered.
double SizeField::length_at(const SizeSource& source, double x, double y) const {
    return source.start + std::min(gradation_, source.growth) * distance(source, x, y);
}

void SizeField::make_leaf(std::int32_t node, const std::array<double, 4>& lengths) {
    nodes_[node] = {static_cast<std::int32_t>(leaves_.size()), kLeaf};
    std::array<float, 4>& leaf = leaves_.emplace_back();
    for (int i = 0; i < 4; ++i)
        leaf[i] = static_cast<float>(lengths[i] / largest_);
}

std::array<double, 4> SizeField::corner_lengths(const QuadtreeCell& cell,
                                                std::span<const std::int32_t> sources) const {
    std::array<double, 4> lengths;
    for (int i = 0; i < 4; ++i) {
        lengths[i] = largest_;
        const double x = cell.x + (i & 1 ? cell.width : 0), y = cell.y + (i & 2 ? cell.width : 0);
        for (const std::int32_t s : sources)
            lengths[i] =
                std::min(lengths[i], std::max(sources_[s].least, length_at(sources_[s], x, y)));
    }
    return lengths;
}

/// Makes a node a leaf, or an inner node with four children to be opened.
void SizeField::open(std::int32_t node, const QuadtreeCell& cell) {
    const auto [begin, count] = nodes_[node];
    const double half = cell.width / 2, reach = gradation_ * half * std::numbers::sqrt2;
    const double x = cell.x + half, y = cell.y + half;
    // Bounds of what each source asks for over the cell.
    double lowest = largest_, highest = largest_;
    std::vector<double> middle(count);
    for (std::int32_t i = 0; i < count; ++i) {
        const SizeSource& source = sources_[candidates_[begin + i]];
        middle[i] = length_at(source, x, y);
        lowest = std::min(lowest, std::max(source.least, middle[i] - reach));
        highest = std::min(highest, std::max(source.least, middle[i] + reach));
    }
    if (static_cast<double>(leaves_.size()) >= most_leaves_ ||
        static_cast<double>(nodes_.size()) > std::numeric_limits<std::int32_t>::max() - 4.0 ||
        static_cast<double>(candidates_.size()) >
            std::numeric_limits<std::int32_t>::max() - count) {
        throw InputError("too_large",
                         "the local lengths are so short that the mesh would not fit into memory; "
                         "use longer ones");
    }
    if (lowest >= highest) {
        make_leaf(node, {lowest, lowest, lowest, lowest});
        return;
    }
    const auto first_candidate = static_cast<std::int32_t>(candidates_.size());
    for (std::int32_t i = 0; i < count; ++i) {
        const std::int32_t s = candidates_[begin + i];
        if (std::max(sources_[s].least, middle[i] - reach) < highest) candidates_.push_back(s);
    }
    const auto candidate_count = static_cast<std::int32_t>(candidates_.size()) - first_candidate;
    if (cell.width <= kLeafPerLength * lowest || cell.depth == kDeepest) {
        const auto lengths = corner_lengths(cell, std::span(candidates_).subspan(first_candidate));
        candidates_.resize(first_candidate);
        make_leaf(node, lengths);
        return;
    }
    nodes_[node] = {static_cast<std::int32_t>(nodes_.size()), kInner};
    nodes_.insert(nodes_.end(), 4, QuadtreeNode{first_candidate, candidate_count});
}

double SizeField::look_up(const PlanPoint& p) {
    double u = std::clamp((p[0] - low_[0]) / width_, 0.0, 1.0);
    double v = std::clamp((p[1] - low_[1]) / width_, 0.0, 1.0);
    // Mostly it is the leaf of the question before. (Scaling by a power of 2 and taking whole
    // numbers off is exact: the way down would give the same u and v.)
    const double last_u = u * last_.scale - last_.column, last_v = v * last_.scale - last_.row;
    if (last_u >= 0 && last_u < 1 && last_v >= 0 && last_v < 1) {
        u = last_u;
        v = last_v;
    } else {
        QuadtreeCell cell{low_[0], low_[1], width_, 0};
        std::int32_t node = 0;
        last_ = {1, 0, 0, 0};
        while (nodes_[node].count != kLeaf) {
            if (nodes_[node].count >= 0) {
                open(node, cell);
                continue;
            }
            u *= 2;
            v *= 2;
            const int right = u >= 1 ? 1 : 0, upper = v >= 1 ? 1 : 0;
            u -= right;
            v -= upper;
            cell.width /= 2;
            cell.x += right * cell.width;
            cell.y += upper * cell.width;
            ++cell.depth;
            last_ = {2 * last_.scale, 2 * last_.column + right, 2 * last_.row + upper, 0};
            node = nodes_[node].index + right + 2 * upper;
        }
        last_.leaf = nodes_[node].index;
    }
    const std::array<float, 4>& leaf = leaves_[last_.leaf];
    const double below = leaf[0] + u * (leaf[1] - leaf[0]),
                 above = leaf[2] + u * (leaf[3] - leaf[2]);
    return largest_ * (below + v * (above - below));
}

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
    std::vector<spatial::Neighbor> neighborhood;
    for (const PlanPoint& p : points) {
        nearest.find(p, neighbors + 1, neighborhood);  // the first is the point itself
        // So many points lie in a circle of that radius.
        const double spacing = std::sqrt(neighborhood.back().squared_distance * std::numbers::pi /
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
        const std::array squared_lengths{squared_distance(a, b), squared_distance(b, c),
                                         squared_distance(c, a)};
        const double wanted = size.at({(a[0] + b[0] + c[0]) / 3, (a[1] + b[1] + c[1]) / 3});
        const auto longest = static_cast<std::size_t>(std::ranges::max_element(squared_lengths) -
                                                      squared_lengths.begin());
        const double area = 0.5 * twice_area(a, b, c);
        // Slivers, of which combs have many, are not cut as long as they hold next to nothing: all
        // of one lies within two thirds of its longest side from its center.
        const double finest = std::max(
            size.smallest(), wanted - kGradation * 2 / 3 * std::sqrt(squared_lengths[longest]));
        if (squared_lengths[longest] <= 9 * wanted * wanted ||
            area <= kNextToNothing * finest * finest) {
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
