// SPDX-License-Identifier: GPL-3.0-or-later
#include "simulation/pillar_levels.hpp"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>

#include "base/index.hpp"
#include "realmodel/base/errors.hpp"

namespace realmodel::simulation {

namespace {

constexpr std::int32_t kMostLayers = 100'000;

/// Levels of one column that are joined while they are nearer than a thickness.
class LevelColumn {
public:
    explicit LevelColumn(std::span<const double> levels) {
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
                const double gap = groups_[g + 1].height - groups_[g].height;
                if (gap < least) {
                    least = gap;
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
                    ending[index(plan.corners(t)[k])].push_back(lines.ending_blocks[index(e)]);
            }
        }
    }
    return ending;
}

/// The levels of all pillars, `stride` for each, without what is thinner than asked: levels that
/// are nearer are joined, and so are those of thin ends of layers.
std::vector<double> thick_levels(const ColumnInput& input, double thickness) {
    const auto& [lines, blocks, plan, columns] = input;
    const auto ending = ending_blocks(plan, lines);
    std::vector<double> heights(plan.pillar_count() * columns.stride());
    for (std::size_t p = 0; p < plan.pillar_count(); ++p) {
        const std::int32_t rock = columns.rock(p);
        if (rock < 0) continue;
        const auto levels = columns.levels(p).first(index(blocks.blocks_of(rock)) + 1);
        LevelColumn column(levels);
        for (const std::int32_t block : ending[index(plan.pillar_node(p))]) {
            const auto at = static_cast<std::size_t>(block - blocks.first[index(rock)]);
            if (blocks.rock[index(block)] == rock && levels[at + 1] - levels[at] < 2 * thickness)
                column.join_at(at);
        }
        column.join_thin(thickness);
        column.write({&heights[p * columns.stride()], levels.size()});
    }
    return heights;
}

/// How thick each block is at most.
std::vector<double> thickest_of(const ColumnInput& input, std::span<const double> joined) {
    const auto& [lines, blocks, plan, columns] = input;
    std::vector<double> thickest(blocks.rock.size(), 0);
    for (std::size_t p = 0; p < columns.size(); ++p) {
        const std::int32_t rock = columns.rock(p);
        if (rock < 0) continue;
        const double* const z = &joined[p * columns.stride()];
        for (std::size_t b = 0; b < index(blocks.blocks_of(rock)); ++b) {
            double& most = thickest[index(blocks.first[index(rock)]) + b];
            most = std::max(most, z[b + 1] - z[b]);
        }
    }
    return thickest;
}

}  // namespace

/// Makes the levels of all pillars, step by step: run().
class LevelBuilder {
public:
    LevelBuilder(PillarLevels& made, const ColumnInput& input, double thickness)
        : made_(made), input_(input), thickness_(thickness), divided_of_(input.plan.nodes(), -1) {}

    void run(const Layering& layering) {
        const auto joined = thick_levels(input_, thickness_);
        const auto layers = number_layers(layering, thickest_of(input_, joined));
        const PillarHeights pillar_heights = divide_blocks(joined, layers);
        find_divided();
        for (DividedNode& node : divided_)
            share_heights(node, pillar_heights);
        if (!divided_.empty()) join_crossing();
        gather_heights(pillar_heights);
    }

private:
    /// The heights of each pillar alone, one pillar after another.
    struct PillarHeights {
        std::vector<double> heights;
        std::vector<std::size_t> begin{0};
        std::span<const double> of(std::size_t pillar) const {
            return std::span(heights).subspan(begin[pillar], begin[pillar + 1] - begin[pillar]);
        }
    };
    /// A node with several pillars, which share heights.
    struct DividedNode {
        std::vector<std::int32_t> pillars;
        std::vector<double> heights;
    };
    /// An edge on a step: its ends, and the pillars of its left and its right side there.
    struct StepEdge {
        std::array<std::int32_t, 2> nodes;
        std::array<std::array<std::size_t, 2>, 2> pillars;
    };

    std::span<std::int32_t> levels_of(std::size_t pillar) {
        return std::span(made_.level_)
            .subspan(made_.offset_[pillar], made_.offset_[pillar + 1] - made_.offset_[pillar]);
    }

    void find_divided() {
        const PlanTopology& plan = input_.plan;
        for (std::size_t p = 0; p < plan.pillar_count(); ++p) {
            if (input_.heights.rock(p) < 0 || !plan.is_divided(plan.pillar_node(p))) continue;
            std::int32_t& number = divided_of_[index(plan.pillar_node(p))];
            if (number < 0) {
                number = static_cast<std::int32_t>(divided_.size());
                divided_.emplace_back();
            }
            divided_[index(number)].pillars.push_back(static_cast<std::int32_t>(p));
        }
    }

    /// The layers of each block, and the block of each layer.
    std::vector<std::int32_t> number_layers(const Layering& layering,
                                            std::span<const double> thickest) {
        const RockBlocks& blocks = input_.blocks;
        std::vector<std::int32_t> layers(blocks.rock.size());
        made_.layer_block_.resize(blocks.count());
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
            auto& layer_blocks = made_.layer_block_[index(blocks.rock[b])];
            layer_blocks.insert(layer_blocks.end(), index(layers[b]), static_cast<std::int32_t>(b));
        }
        return layers;
    }

    /// Blocks become layers, but no more than their thickness allows; where there are fewer than
    /// elsewhere the uppermost end. Levels are numbers of the pillar's own heights at first.
    PillarHeights divide_blocks(std::span<const double> joined,
                                std::span<const std::int32_t> layers) {
        const auto& [lines, blocks, plan, columns] = input_;
        made_.offset_.assign(1, 0);
        PillarHeights pillars;
        for (std::size_t p = 0; p < columns.size(); ++p) {
            const std::int32_t rock = columns.rock(p);
            if (rock >= 0) {
                const double* const z = &joined[p * columns.stride()];
                const auto first = index(blocks.first[index(rock)]);
                std::int32_t at = 0;
                pillars.heights.push_back(z[0]);
                made_.level_.push_back(at);
                for (std::size_t b = 0; b < index(blocks.blocks_of(rock)); ++b) {
                    const double thick = z[b + 1] - z[b];
                    std::int32_t divisions = 0;
                    if (thick > 0) {
                        const double wanted =
                            std::min<double>(layers[first + b], std::floor(thick / thickness_));
                        divisions = std::max(1, static_cast<std::int32_t>(wanted));
                    }
                    for (std::int32_t k = 1; k <= divisions; ++k)
                        pillars.heights.push_back(k == divisions ? z[b + 1]
                                                                 : z[b] + thick * k / divisions);
                    for (std::int32_t k = 1; k <= layers[first + b]; ++k)
                        made_.level_.push_back(at + std::min(k, divisions));
                    at += divisions;
                }
            }
            made_.offset_.push_back(made_.level_.size());
            pillars.begin.push_back(pillars.heights.size());
        }
        return pillars;
    }

    /// Heights of the pillars of one node that are nearer than the thickness become one.
    void share_heights(DividedNode& node, const PillarHeights& pillar_heights) {
        struct PillarHeight {
            double height;
            std::size_t pillar;  ///< of the node's
            auto operator<=>(const PillarHeight&) const = default;
        };
        std::vector<PillarHeight> all;
        for (std::size_t k = 0; k < node.pillars.size(); ++k) {
            for (const double height : pillar_heights.of(index(node.pillars[k])))
                all.push_back({height, k});
        }
        std::sort(all.begin(), all.end());
        std::vector<std::vector<std::int32_t>> joined(node.pillars.size());
        for (const PillarHeight& entry : all) {
            if (node.heights.empty() || entry.height - node.heights.back() >= 0.999 * thickness_)
                node.heights.push_back(entry.height);
            joined[entry.pillar].push_back(static_cast<std::int32_t>(node.heights.size()) - 1);
        }
        for (std::size_t k = 0; k < node.pillars.size(); ++k) {
            for (std::int32_t& level : levels_of(index(node.pillars[k])))
                level = joined[k][index(level)];
        }
    }

    /// Where a level of one side of a step crosses one of the other between two nodes, the two are
    /// joined at the node where they are nearer. Each time a node has fewer heights, so this ends.
    void join_crossing() {
        const PlanTopology& plan = input_.plan;
        std::vector<StepEdge> edges;
        for (std::size_t t = 0; t < plan.triangles(); ++t) {
            for (std::size_t i = 0; i < 3; ++i) {
                if (!plan.is_inner_step(t, i) || index(plan.neighbor(t, i)) < t) continue;
                const std::size_t j = (i + 1) % 3;
                edges.push_back(
                    {{plan.corners(t)[i], plan.corners(t)[j]},
                     {{{plan.pillar(t, i), plan.pillar(t, j)}, plan.pillars_beyond(t, i)}}});
            }
        }
        for (bool any = true; any;) {
            any = false;
            for (const StepEdge& edge : edges) {
                while (join_first_crossing(edge))
                    any = true;
            }
        }
    }

    bool join_first_crossing(const StepEdge& edge) {
        const auto side = [&](std::size_t of, std::size_t end) {
            return made_.levels(edge.pillars[of][end]);
        };
        const std::array left{side(0, 0), side(0, 1)}, right{side(1, 0), side(1, 1)};
        if (left[0].empty() || left[1].empty() || right[0].empty() || right[1].empty())
            return false;
        const auto node = [&](std::size_t end) -> DividedNode& {
            return divided_[index(divided_of_[index(edge.nodes[end])])];
        };
        for (std::size_t i = 0; i < left[0].size(); ++i) {
            for (std::size_t j = 0; j < right[0].size(); ++j) {
                const std::int32_t at0 = left[0][i] - right[0][j], at1 = left[1][i] - right[1][j];
                if ((at0 > 0) == (at1 > 0) || at0 == 0 || at1 == 0) continue;
                const auto gap = [&](std::size_t end) {
                    const auto& heights = node(end).heights;
                    return std::abs(heights[index(left[end][i])] - heights[index(right[end][j])]);
                };
                const std::size_t end = gap(0) <= gap(1) ? 0 : 1;
                const auto [from, to] = unordered(left[end][i], right[end][j]);
                join(node(end), from, to);
                return true;
            }
        }
        return false;
    }

    void join(DividedNode& node, std::int32_t from, std::int32_t to) {
        node.heights[index(from)] = (node.heights[index(from)] + node.heights[index(to)]) / 2;
        node.heights.erase(node.heights.begin() + from + 1, node.heights.begin() + to + 1);
        for (const std::int32_t p : node.pillars) {
            for (std::int32_t& level : levels_of(index(p))) {
                if (level > to) {
                    level -= to - from;
                } else if (level > from) {
                    level = from;
                }
            }
        }
    }

    /// The heights of all nodes.
    void gather_heights(const PillarHeights& pillar_heights) {
        const auto& [lines, blocks, plan, columns] = input_;
        std::vector<std::int32_t> pillar_of(plan.nodes(), -1);
        for (std::size_t p = 0; p < plan.pillar_count(); ++p) {
            if (columns.rock(p) >= 0)
                pillar_of[index(plan.pillar_node(p))] = static_cast<std::int32_t>(p);
        }
        made_.node_offset_.assign(1, 0);
        for (std::size_t n = 0; n < plan.nodes(); ++n) {
            std::span<const double> heights;
            if (divided_of_[n] >= 0) {
                heights = divided_[index(divided_of_[n])].heights;
            } else if (pillar_of[n] >= 0) {
                heights = pillar_heights.of(index(pillar_of[n]));
            }
            made_.height_.insert(made_.height_.end(), heights.begin(), heights.end());
            made_.node_offset_.push_back(made_.height_.size());
        }
        made_.first_height_ = made_.height_;
    }

    PillarLevels& made_;
    const ColumnInput& input_;
    const double thickness_;
    std::vector<DividedNode> divided_;
    std::vector<std::int32_t> divided_of_;  ///< of each node, -1: it has one pillar
};

PillarLevels::PillarLevels(const ColumnInput& input, const Layering& layering) {
    LevelBuilder(*this, input, layering.minimum_thickness).run(layering);
    assert(is_valid(input.plan));
}

/// What columns rely on: the heights of a node ascend, and so do the levels of each of its pillars,
/// which are numbers of these.
[[maybe_unused]] bool PillarLevels::is_valid(const PlanTopology& plan) const {
    for (std::size_t n = 0; n + 1 < node_offset_.size(); ++n) {
        const auto node_heights = heights(static_cast<std::int32_t>(n));
        if (!std::is_sorted(node_heights.begin(), node_heights.end())) return false;
    }
    for (std::size_t p = 0; p + 1 < offset_.size(); ++p) {
        const auto numbers = levels(p);
        if (numbers.empty()) continue;
        if (numbers.front() < 0 || !std::is_sorted(numbers.begin(), numbers.end()) ||
            index(numbers.back()) >= heights(plan.pillar_node(p)).size())
            return false;
    }
    return true;
}

std::array<std::int32_t, 2> PillarLevels::blocks_at(std::size_t pillar, std::int32_t rock,
                                                    std::int32_t height) const {
    const auto numbers = levels(pillar);
    const auto blocks = layer_blocks(rock);
    std::int32_t below = -1, above = -1;
    for (std::size_t l = 0; l + 1 < numbers.size(); ++l) {
        if (numbers[l] == numbers[l + 1]) continue;
        if (numbers[l + 1] == height) below = blocks[l];
        if (numbers[l] == height) above = blocks[l];
    }
    return {below, above};
}

std::size_t PillarLevels::remove(const PlanTopology& plan, std::vector<Removal>& removals,
                                 bool several) {
    std::sort(removals.begin(), removals.end());
    constexpr std::int32_t kUnmerged = -1;
    std::vector<std::int32_t> into(height_.size(), kUnmerged);
    std::vector<std::uint8_t> is_used(height_.size(), 0);
    std::size_t count = 0;
    std::int32_t last = -1;
    for (const Removal& removal : removals) {
        if (!several && removal.node == last) continue;
        assert(std::abs(removal.height - removal.into) == 1);
        const std::size_t first = node_offset_[index(removal.node)],
                          gone = first + index(removal.height), next = first + index(removal.into);
        if (is_used[gone] != 0 || is_used[next] != 0) continue;
        is_used[gone] = is_used[next] = 1;
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
            if (into[h] != kUnmerged) continue;
            number[h] = static_cast<std::int32_t>(to - offset[n]);
            first_height_[to] = first_height_[h];
            height_[to++] = height_[h];
        }
        for (std::size_t h = begin; h < end; ++h) {
            if (into[h] != kUnmerged) number[h] = number[begin + index(into[h])];
        }
        offset.push_back(to);
    }
    for (std::size_t p = 0; p + 1 < offset_.size(); ++p) {
        const std::size_t begin = node_offset_[index(plan.pillar_node(p))];
        for (std::size_t l = offset_[p]; l < offset_[p + 1]; ++l)
            level_[l] = number[begin + index(level_[l])];
    }
    node_offset_ = std::move(offset);
    height_.resize(to);
    first_height_.resize(to);
    assert(is_valid(plan));
    return count;
}

bool PillarLevels::relax_heights(const std::vector<Move>& moves, double most, double gap,
                                 bool alone, std::span<const std::uint8_t> has_flat_base,
                                 std::span<std::uint8_t> is_moved) {
    constexpr double kLeast = 1e-3;  // of `most`: what is worth another round
    struct MoveSum {
        double by = 0;
        std::int32_t count = 0, lowest = INT32_MAX;
    };
    std::vector<MoveSum> asked(alone ? height_.size() : node_offset_.size() - 1);
    for (const Move& move : moves) {
        const auto n = index(move.node);
        MoveSum& sum = asked[alone ? node_offset_[n] + index(move.height) : n];
        sum.by += move.by;
        ++sum.count;
        sum.lowest = std::min(sum.lowest, move.height);
    }
    bool any = false;
    for (std::size_t n = 0; n + 1 < node_offset_.size(); ++n) {
        const std::size_t first = node_offset_[n], end = node_offset_[n + 1];
        const auto move = [&](std::size_t at, double by) {
            if (has_flat_base[n] != 0 && at == first) return;
            const double height = height_[at];
            double to = std::clamp(height + by, first_height_[at] - most, first_height_[at] + most);
            if (at > first) to = std::max(to, std::min(height, height_[at - 1] + gap));
            if (at + 1 < end) to = std::min(to, std::max(height, height_[at + 1] - gap));
            if (std::abs(to - height) < kLeast * gap) return;
            height_[at] = to;
            is_moved[n] = 1;
            any = true;
        };
        if (alone) {
            for (std::size_t at = first; at < end; ++at)
                if (asked[at].count > 0) move(at, asked[at].by / asked[at].count);
            continue;
        }
        if (asked[n].count == 0) continue;
        const double by = asked[n].by / asked[n].count, bottom = height_[first],
                     span = height_[first + index(asked[n].lowest)] - bottom;
        const auto share = [&](std::size_t at) {
            return has_flat_base[n] == 0 ? 1 : std::min(1.0, (height_[at] - bottom) / span);
        };
        // what moves first makes room for the next
        for (std::size_t k = 0; k < end - first; ++k) {
            const std::size_t at = by < 0 ? first + k : end - 1 - k;
            move(at, share(at) * by);
        }
    }
    return any;
}

}  // namespace realmodel::simulation
