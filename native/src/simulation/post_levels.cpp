// SPDX-License-Identifier: GPL-3.0-or-later
#include "simulation/post_levels.hpp"

#include <algorithm>
#include <cmath>
#include <tuple>

#include "base/index.hpp"
#include "realmodel/base/errors.hpp"

namespace realmodel::simulation {

namespace {

constexpr std::int32_t kMostLayers = 100'000;

/// Levels of one column that are joined while they are nearer than a thickness.
class Column {
public:
    explicit Column(std::span<const double> levels) {
        for (std::size_t i = 0; i < levels.size(); ++i)
            groups_.push_back({levels[i], i, i});
    }
    /// Joins levels `below` and the next.
    void join_at(std::size_t below) {
        for (std::size_t g = 0; g + 1 < groups_.size(); ++g) {
            if (groups_[g].last == below) return join(g);
        }
    }
    /// Joins the nearest until none are nearer than `thickness`. Neighbors share what was between
    /// them; bottom and top stay.
    void join_thin(double thickness) {
        for (;;) {
            std::size_t thinnest = groups_.size();
            double least = thickness;
            for (std::size_t g = 0; g + 1 < groups_.size(); ++g) {
                const double own = groups_[g + 1].height - groups_[g].height;
                if (own < least) {
                    least = own;
                    thinnest = g;
                }
            }
            if (thinnest == groups_.size()) return;
            join(thinnest);
        }
    }
    void write(std::span<double> levels) const {
        for (const Group& group : groups_)
            std::fill(levels.begin() + static_cast<std::ptrdiff_t>(group.first),
                      levels.begin() + static_cast<std::ptrdiff_t>(group.last) + 1, group.height);
    }

private:
    struct Group {
        double height;
        std::size_t first, last;
    };
    void join(std::size_t g) {
        Group &below = groups_[g], &above = groups_[g + 1];
        const bool is_bottom = g == 0, is_top = g + 2 == groups_.size();
        if (is_top) {
            below.height = above.height;
        } else if (!is_bottom) {
            below.height = (below.height + above.height) / 2;
        }
        below.last = above.last;
        groups_.erase(groups_.begin() + static_cast<std::ptrdiff_t>(g) + 1);
    }
    std::vector<Group> groups_;
};

/// The blocks that end at each node.
std::vector<std::vector<std::int32_t>> ending_blocks(const PlanTopology& plan,
                                                     const PlanLines& lines) {
    std::vector<std::vector<std::int32_t>> ending(plan.nodes());
    for (std::size_t t = 0; t < plan.triangles(); ++t) {
        for (std::size_t i = 0; i < 3; ++i) {
            const std::int32_t s = plan.segment(t, i);
            if (s < 0 || lines.segments[index(s)].is_step) continue;
            for (std::int32_t e = lines.ending_offsets[index(s)];
                 e < lines.ending_offsets[index(s) + 1]; ++e) {
                for (const std::size_t k : {i, (i + 1) % 3})
                    ending[index(plan.mesh().triangles[t][k])].push_back(
                        lines.ending_blocks[index(e)]);
            }
        }
    }
    return ending;
}

}  // namespace

PostLevels::PostLevels(const PlanTopology& plan, const PlanLines& lines, const RockBlocks& blocks,
                       const ColumnHeights& columns, const Layering& layering) {
    const double thickness = layering.minimum_thickness;
    const std::size_t posts = plan.post_count(), stride = columns.stride();
    const auto ending = ending_blocks(plan, lines);
    std::vector<double> heights(posts * stride);
    std::vector<double> thickest(blocks.rock.size(), 0);
    for (std::size_t p = 0; p < posts; ++p) {
        const std::int32_t rock = columns.rock(p);
        if (rock < 0) continue;
        const auto own = columns.levels(p);
        Column column(own.first(index(blocks.blocks_of(rock)) + 1));
        for (const std::int32_t block : ending[index(plan.post_node(p))]) {
            const auto at = static_cast<std::size_t>(block - blocks.first[index(rock)]);
            if (blocks.rock[index(block)] == rock && own[at + 1] - own[at] < 2 * thickness)
                column.join_at(at);
        }
        column.join_thin(thickness);
        const std::span<double> joined(&heights[p * stride], index(blocks.blocks_of(rock)) + 1);
        column.write(joined);
        for (std::size_t b = 0; b + 1 < joined.size(); ++b) {
            double& most = thickest[index(blocks.first[index(rock)]) + b];
            most = std::max(most, joined[b + 1] - joined[b]);
        }
    }
    // layers of each block
    std::vector<std::int32_t> layers(blocks.rock.size());
    layer_block_.resize(blocks.count());
    for (std::size_t b = 0; b < layers.size(); ++b) {
        const double wanted = layering.layer_thickness > 0
                                  ? std::ceil(thickest[b] / layering.layer_thickness)
                                  : layering.layers[b];
        if (wanted > kMostLayers)
            throw InputError("too_large", "a layer would be divided into more than 100000", -1,
                             {static_cast<std::int64_t>(b)});
        layers[b] = std::max(1, static_cast<std::int32_t>(wanted));
        if (layering.layer_thickness > 0 && layering.layers[b] > 0)
            layers[b] = std::min(layers[b], layering.layers[b]);
        auto& own = layer_block_[index(blocks.rock[b])];
        own.insert(own.end(), index(layers[b]), static_cast<std::int32_t>(b));
    }
    // levels of each post among its own heights
    offset_.assign(posts + 1, 0);
    for (std::size_t p = 0; p < posts; ++p) {
        const std::int32_t rock = columns.rock(p);
        offset_[p + 1] = offset_[p] + (rock < 0 ? 0 : layer_block_[index(rock)].size() + 1);
    }
    level_.resize(offset_.back());
    std::vector<std::int32_t> divided_of(plan.nodes(), -1);
    std::vector<Divided> divided;
    std::vector<std::size_t> first_height(posts + 1, 0);
    std::vector<double> own_heights;
    for (std::size_t p = 0; p < posts; ++p) {
        first_height[p] = own_heights.size();
        const std::int32_t rock = columns.rock(p);
        if (rock < 0) continue;
        const double* const z = &heights[p * stride];
        std::int32_t* level = &level_[offset_[p]];
        own_heights.push_back(z[0]);
        std::int32_t at = 0;
        *level++ = at;
        const auto first = index(blocks.first[index(rock)]);
        for (std::size_t b = 0; b < index(blocks.blocks_of(rock)); ++b) {
            const std::int32_t most = layers[first + b];
            const double own = z[b + 1] - z[b];
            std::int32_t parts = 0;
            if (own > 0) {
                const double wanted = std::min<double>(most, std::floor(own / thickness));
                parts = std::max(1, static_cast<std::int32_t>(wanted));
            }
            for (std::int32_t k = 1; k <= parts; ++k)
                own_heights.push_back(k == parts ? z[b + 1] : z[b] + own * k / parts);
            // where there are fewer layers the uppermost end
            for (std::int32_t k = 1; k <= most; ++k)
                *level++ = at + std::min(k, parts);
            at += parts;
        }
        if (plan.is_divided(plan.post_node(p))) {
            std::int32_t& number = divided_of[index(plan.post_node(p))];
            if (number < 0) {
                number = static_cast<std::int32_t>(divided.size());
                divided.emplace_back();
            }
            divided[index(number)].posts.push_back(static_cast<std::int32_t>(p));
        }
    }
    first_height[posts] = own_heights.size();
    // posts of one node: heights nearer than the thickness become one
    for (Divided& node : divided) {
        struct Entry {
            double height;
            std::int32_t post, at, joined;
        };
        std::vector<Entry> all;
        for (const std::int32_t p : node.posts) {
            for (std::size_t h = first_height[index(p)]; h < first_height[index(p) + 1]; ++h)
                all.push_back(
                    {own_heights[h], p, static_cast<std::int32_t>(h - first_height[index(p)]), 0});
        }
        std::sort(all.begin(), all.end(), [](const Entry& a, const Entry& b) {
            return std::tie(a.height, a.post) < std::tie(b.height, b.post);
        });
        for (Entry& entry : all) {
            if (node.heights.empty() || entry.height - node.heights.back() >= 0.999 * thickness)
                node.heights.push_back(entry.height);
            entry.joined = static_cast<std::int32_t>(node.heights.size()) - 1;
        }
        for (const std::int32_t p : node.posts) {
            std::vector<std::int32_t> joined(first_height[index(p) + 1] - first_height[index(p)]);
            for (const Entry& entry : all) {
                if (entry.post == p) joined[index(entry.at)] = entry.joined;
            }
            for (std::size_t l = offset_[index(p)]; l < offset_[index(p) + 1]; ++l)
                level_[l] = joined[index(level_[l])];
        }
    }
    if (!divided.empty()) join_crossing(plan, divided, divided_of);
    // heights by node
    std::vector<std::int32_t> post_of(plan.nodes(), -1);
    for (std::size_t p = 0; p < posts; ++p) {
        if (columns.rock(p) >= 0) post_of[index(plan.post_node(p))] = static_cast<std::int32_t>(p);
    }
    node_offset_.assign(1, 0);
    height_.reserve(own_heights.size());
    for (std::size_t n = 0; n < plan.nodes(); ++n) {
        if (divided_of[n] >= 0) {
            const auto& own = divided[index(divided_of[n])].heights;
            height_.insert(height_.end(), own.begin(), own.end());
        } else if (post_of[n] >= 0) {
            const auto p = index(post_of[n]);
            height_.insert(height_.end(),
                           own_heights.begin() + static_cast<std::ptrdiff_t>(first_height[p]),
                           own_heights.begin() + static_cast<std::ptrdiff_t>(first_height[p + 1]));
        }
        node_offset_.push_back(height_.size());
    }
    first_height_ = height_;
}

std::size_t PostLevels::remove(const PlanTopology& plan, std::vector<Removal>& removals,
                               bool several) {
    std::sort(removals.begin(), removals.end());
    constexpr std::int32_t kKept = -1;
    std::vector<std::int32_t> into(height_.size(), kKept);
    std::vector<std::uint8_t> is_used(height_.size(), 0);
    std::size_t count = 0;
    std::int32_t last = -1;
    for (const Removal& removal : removals) {
        if (!several && removal.node == last) continue;
        const std::size_t first = node_offset_[index(removal.node)],
                          gone = first + index(removal.height), kept = first + index(removal.into);
        if (is_used[gone] != 0 || is_used[kept] != 0) continue;
        is_used[gone] = is_used[kept] = 1;
        into[gone] = removal.into;
        last = removal.node;
        ++count;
    }
    // the new numbers of heights among those of their node
    std::vector<std::int32_t> number(height_.size());
    std::size_t to = 0;
    std::vector<std::size_t> offset{0};
    offset.reserve(node_offset_.size());
    for (std::size_t n = 0; n + 1 < node_offset_.size(); ++n) {
        const std::size_t begin = node_offset_[n], end = node_offset_[n + 1];
        for (std::size_t h = begin; h < end; ++h) {
            if (into[h] != kKept) continue;
            number[h] = static_cast<std::int32_t>(to - offset[n]);
            first_height_[to] = first_height_[h];
            height_[to++] = height_[h];
        }
        for (std::size_t h = begin; h < end; ++h) {
            if (into[h] != kKept) number[h] = number[begin + index(into[h])];
        }
        offset.push_back(to);
    }
    for (std::size_t p = 0; p + 1 < offset_.size(); ++p) {
        const std::size_t begin = node_offset_[index(plan.post_node(p))];
        for (std::size_t l = offset_[p]; l < offset_[p + 1]; ++l)
            level_[l] = number[begin + index(level_[l])];
    }
    node_offset_ = std::move(offset);
    height_.resize(to);
    first_height_.resize(to);
    return count;
}

bool PostLevels::ease(const std::vector<Move>& moves, double most, double gap, bool alone,
                      std::span<const std::uint8_t> has_flat_base,
                      std::span<std::uint8_t> is_moved) {
    constexpr double kLeast = 1e-3;  // of `most`: what is worth another round
    struct Asked {
        double by = 0;
        std::int32_t count = 0, lowest = INT32_MAX;
    };
    std::vector<Asked> asked(alone ? height_.size() : node_offset_.size() - 1);
    for (const Move& move : moves) {
        const auto n = index(move.node);
        Asked& own = asked[alone ? node_offset_[n] + index(move.height) : n];
        own.by += move.by;
        ++own.count;
        own.lowest = std::min(own.lowest, move.height);
    }
    bool any = false;
    for (std::size_t n = 0; n + 1 < node_offset_.size(); ++n) {
        const std::size_t first = node_offset_[n], end = node_offset_[n + 1];
        const auto move = [&](std::size_t at, double by) {
            const double own = height_[at];
            if (has_flat_base[n] != 0 && at == first) return;
            double to = std::clamp(own + by, first_height_[at] - most, first_height_[at] + most);
            if (at > first) to = std::max(to, std::min(own, height_[at - 1] + gap));
            if (at + 1 < end) to = std::min(to, std::max(own, height_[at + 1] - gap));
            if (std::abs(to - own) < kLeast * gap) return;
            height_[at] = to;
            is_moved[n] = 1;
            any = true;
        };
        if (alone) {
            for (std::size_t at = first; at < end; ++at) {
                if (asked[at].count > 0) move(at, asked[at].by / asked[at].count);
            }
            continue;
        }
        if (asked[n].count == 0) continue;
        const double by = asked[n].by / asked[n].count, bottom = height_[first],
                     span = height_[first + index(asked[n].lowest)] - bottom;
        const auto share = [&](std::size_t at) {
            return has_flat_base[n] == 0 ? 1 : std::min(1.0, (height_[at] - bottom) / span);
        };
        // what moves first makes room for the next
        if (by < 0) {
            for (std::size_t at = first; at < end; ++at)
                move(at, share(at) * by);
        } else {
            for (std::size_t at = end; at-- > first;)
                move(at, share(at) * by);
        }
    }
    return any;
}

void PostLevels::join(Divided& node, std::int32_t from, std::int32_t to) {
    node.heights[index(from)] = (node.heights[index(from)] + node.heights[index(to)]) / 2;
    node.heights.erase(node.heights.begin() + from + 1, node.heights.begin() + to + 1);
    for (const std::int32_t p : node.posts) {
        for (std::size_t l = offset_[index(p)]; l < offset_[index(p) + 1]; ++l) {
            if (level_[l] > to) {
                level_[l] -= to - from;
            } else if (level_[l] > from) {
                level_[l] = from;
            }
        }
    }
}

/// Where a level of one side of a step crosses one of the other between two nodes, the two are
/// joined at the node where they are nearer. Each time a node has fewer heights, so this ends.
void PostLevels::join_crossing(const PlanTopology& plan, std::vector<Divided>& nodes,
                               std::span<const std::int32_t> divided_of) {
    struct StepEdge {
        std::array<std::int32_t, 2> nodes;
        std::array<std::array<std::size_t, 2>, 2> posts;  // left and right at both nodes
    };
    std::vector<StepEdge> edges;
    for (std::size_t t = 0; t < plan.triangles(); ++t) {
        for (std::size_t i = 0; i < 3; ++i) {
            const std::int32_t n = plan.neighbor(t, i);
            if (n < static_cast<std::int32_t>(t) || !plan.is_step(t, i)) continue;
            const auto &own = plan.mesh().triangles[t], &beyond = plan.mesh().triangles[index(n)];
            StepEdge edge{{own[i], own[(i + 1) % 3]}, {}};
            for (std::size_t k = 0; k < 2; ++k) {
                edge.posts[0][k] = index(plan.posts()[3 * t + (i + k) % 3]);
                for (std::size_t j = 0; j < 3; ++j) {
                    if (beyond[j] == edge.nodes[k])
                        edge.posts[1][k] = index(plan.posts()[3 * index(n) + j]);
                }
            }
            edges.push_back(edge);
        }
    }
    const auto gap = [&](std::int32_t node, std::int32_t a, std::int32_t b) {
        const auto& own = nodes[index(divided_of[index(node)])].heights;
        return std::abs(own[index(a)] - own[index(b)]);
    };
    for (bool any = true; any;) {
        any = false;
        for (const StepEdge& edge : edges) {
            for (bool crossing = true; crossing;) {
                crossing = false;
                const auto left0 = levels(edge.posts[0][0]), left1 = levels(edge.posts[0][1]),
                           right0 = levels(edge.posts[1][0]), right1 = levels(edge.posts[1][1]);
                if (left0.empty() || left1.empty() || right0.empty() || right1.empty()) break;
                for (std::size_t i = 0; i < left0.size() && !crossing; ++i) {
                    for (std::size_t j = 0; j < right0.size() && !crossing; ++j) {
                        const std::int32_t at0 = left0[i] - right0[j], at1 = left1[i] - right1[j];
                        if ((at0 > 0) == (at1 > 0) || at0 == 0 || at1 == 0) continue;
                        const std::size_t k = gap(edge.nodes[0], left0[i], right0[j]) <=
                                                      gap(edge.nodes[1], left1[i], right1[j])
                                                  ? 0
                                                  : 1;
                        const auto a = k == 0 ? left0[i] : left1[i],
                                   b = k == 0 ? right0[j] : right1[j];
                        join(nodes[index(divided_of[index(edge.nodes[k])])], std::min(a, b),
                             std::max(a, b));
                        any = crossing = true;
                    }
                }
            }
        }
    }
}

}  // namespace realmodel::simulation
