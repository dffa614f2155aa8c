// SPDX-License-Identifier: GPL-3.0-or-later
#include "meshing/size_field.hpp"

#include <algorithm>
#include <limits>
#include <numbers>
#include <numeric>

#include "base/vectors.hpp"
#include "realmodel/base/errors.hpp"

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

std::array<double, 4> SizeField::corner_lengths(const Cell& cell,
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
void SizeField::open(std::int32_t node, const Cell& cell) {
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
    const auto first_kept = static_cast<std::int32_t>(candidates_.size());
    for (std::int32_t i = 0; i < count; ++i) {
        const std::int32_t s = candidates_[begin + i];
        if (std::max(sources_[s].least, middle[i] - reach) < highest) candidates_.push_back(s);
    }
    const auto kept = static_cast<std::int32_t>(candidates_.size()) - first_kept;
    if (cell.width <= kLeafPerLength * lowest || cell.depth == kDeepest) {
        const auto lengths = corner_lengths(cell, std::span(candidates_).subspan(first_kept));
        candidates_.resize(first_kept);
        make_leaf(node, lengths);
        return;
    }
    nodes_[node] = {static_cast<std::int32_t>(nodes_.size()), kInner};
    nodes_.insert(nodes_.end(), 4, Node{first_kept, kept});
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
        Cell cell{low_[0], low_[1], width_, 0};
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

}  // namespace realmodel::meshing
