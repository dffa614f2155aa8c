// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <functional>
#include <vector>

#include "base/index.hpp"
#include "base/parallel.hpp"

namespace realmodel::spatial {

/// An axis-parallel box; empty at first.
struct Box {
    using Position = std::array<double, 3>;
    Position low{HUGE_VAL, HUGE_VAL, HUGE_VAL}, high{-HUGE_VAL, -HUGE_VAL, -HUGE_VAL};

    void include(const Position& p) {
        for (std::size_t k = 0; k < 3; ++k) {
            low[k] = std::min(low[k], p[k]);
            high[k] = std::max(high[k], p[k]);
        }
    }
    /// Of a position in plan, at height 0.
    void include(const std::array<double, 2>& p) { include(Position{p[0], p[1], 0}); }
    void include(const Box& other) {
        for (std::size_t k = 0; k < 3; ++k) {
            low[k] = std::min(low[k], other.low[k]);
            high[k] = std::max(high[k], other.high[k]);
        }
    }
    void widen(double by) {
        for (std::size_t k = 0; k < 3; ++k) {
            low[k] -= by;
            high[k] += by;
        }
    }
    bool contains(const Box& other) const {
        for (std::size_t k = 0; k < 3; ++k) {
            if (other.low[k] < low[k] || other.high[k] > high[k]) return false;
        }
        return true;
    }
    bool contains(const Position& p) const {
        for (std::size_t k = 0; k < 3; ++k) {
            if (p[k] < low[k] || p[k] > high[k]) return false;
        }
        return true;
    }
    bool meets(const Box& other) const {
        for (std::size_t k = 0; k < 3; ++k) {
            if (other.high[k] < low[k] || other.low[k] > high[k]) return false;
        }
        return true;
    }
};

/// Around the positions of some things.
/// @param position_of  position_of(thing)
template <class Things, class PositionOf = std::identity>
Box bounding_box(const Things& things, const PositionOf& position_of = {}) {
    Box box;
    for (const auto& thing : things)
        box.include(position_of(thing));
    return box;
}

/// Finds the boxes that meet a given one: a binary tree that halves them along the
/// longest side of their middles.
class BoxTree {
public:
    /// @throws Cancelled
    explicit BoxTree(std::vector<Box> boxes, const Execution& execution = {1, nullptr}) {
        if (boxes.empty()) return;
        // the boxes and their middles lie together while they are put in order
        std::vector<BoxMiddle> items(boxes.size());
        for (std::size_t i = 0; i < boxes.size(); ++i) {
            for (std::size_t k = 0; k < 3; ++k)
                items[i].twice_middle[k] = boxes[i].low[k] + boxes[i].high[k];
            items[i].number = static_cast<std::int32_t>(i);
        }
        order_.resize(boxes.size());
        boxes_.resize(boxes.size());
        leaves_.resize(leaves_of(boxes.size()));
        nodes_.resize(2 * leaves_.size() - 1);
        build_all(items, boxes, execution);
    }

    /// Calls visit(number) for each, in no particular but always the same order.
    template <class Visit>
    void find(const Box& box, const Visit& visit) const {
        if (nodes_.empty()) return;
        for_each_leaf(box, [&](const Node& leaf) {
            for (std::size_t i = leaf.begin; i < leaf.end; ++i) {
                if (boxes_[i].meets(box)) visit(order_[i]);
            }
        });
    }
    /// Calls visit(number) for each box whose squared distance from p is at most bound(), which may
    /// grow less with every visit; near ones come first on the whole, always in the same order.
    template <class Bound, class Visit>
    void approach(const Box::Position& p, const Bound& bound, const Visit& visit) const {
        if (!nodes_.empty()) approach(0, p, bound, visit);
    }
    /// Calls visit(place, other) for each two boxes that meet, once: those of which the first in
    /// the order of the leaves is in some of them, from 0 to leaf_count() - 1. Always in the same
    /// order, the pairs of a first box one after another.
    template <class Visit>
    void find_pairs(std::size_t first_leaf, std::size_t end_leaf, const Visit& visit) const {
        constexpr std::size_t kLeavesOfSearch = 8;  // leaves that share a search
        std::vector<const Node*> near_all, near;
        for (std::size_t leaf = first_leaf; leaf < end_leaf; ++leaf) {
            const Node& node = nodes_[leaves_[leaf]];
            if ((leaf - first_leaf) % kLeavesOfSearch == 0) {
                Box all;
                for (std::size_t i = leaf; i < std::min(end_leaf, leaf + kLeavesOfSearch); ++i)
                    all.include(nodes_[leaves_[i]].box);
                near_all.clear();
                for_each_leaf(
                    all, [&](const Node& other) { near_all.push_back(&other); }, node.begin);
            }
            near.clear();
            for (const Node* other : near_all) {
                if (other->end > node.begin && other->box.meets(node.box)) near.push_back(other);
            }
            for (std::size_t i = node.begin; i < node.end; ++i) {
                for (const Node* other : near) {
                    if (!boxes_[i].meets(other->box)) continue;
                    for (std::size_t j = std::max(i + 1, other->begin); j < other->end; ++j) {
                        if (boxes_[i].meets(boxes_[j])) visit(i, j);
                    }
                }
            }
        }
    }
    /// The number of the box at a place in the order of the leaves.
    std::int32_t number_at(std::size_t place) const { return order_[place]; }
    std::size_t leaf_count() const { return leaves_.size(); }
    bool any(const Box& box) const {
        return any(box, [](std::int32_t) { return true; });
    }
    /// Whether accepts(number) holds for one of them.
    template <class Accepts>
    bool any(const Box& box, const Accepts& accepts) const {
        return !nodes_.empty() && any(0, box, accepts);
    }

private:
    static constexpr std::size_t kLeaf = 4;
    struct Node {
        Box box;
        std::size_t begin, end;
        std::size_t second = 0;  ///< the first child follows; 0: a leaf
    };

    struct BoxMiddle {
        Box::Position twice_middle;
        std::int32_t number;
    };

    /// What a node has below it: boxes in order, and leaves.
    struct Subtree {
        std::size_t node, begin, end, leaf;
    };

    /// How many leaves so many boxes get.
    static std::size_t leaves_of(std::size_t boxes) {
        std::size_t halvings = 0;
        while ((boxes >> halvings) > kLeaf)
            ++halvings;
        // of these parts some may have one box more than the others
        const std::size_t subtrees = std::size_t{1} << halvings;
        return boxes >> halvings == kLeaf ? subtrees + boxes % subtrees : subtrees;
    }
    /// Builds large trees on several threads: the parts of one level at once, then what is below.
    void build_all(std::vector<BoxMiddle>& items, const std::vector<Box>& boxes,
                   const Execution& execution) {
        constexpr std::size_t kSubtrees = 1 << 5, kMinBoxes = 1 << 11;
        std::vector<Subtree> subtrees{{0, 0, items.size(), 0}}, above;
        while (subtrees.size() < kSubtrees && items.size() / subtrees.size() > 2 * kMinBoxes) {
            std::vector<Subtree> halves(2 * subtrees.size());
            parallel_chunks(
                subtrees.size(), execution,
                [&](std::size_t i) {
                    const auto two = halve(items, subtrees[i]);
                    std::ranges::copy(two, halves.begin() + static_cast<std::ptrdiff_t>(2 * i));
                },
                0.02);
            above.insert(above.end(), subtrees.begin(), subtrees.end());
            subtrees = std::move(halves);
        }
        if (above.empty()) {
            build(items, boxes, subtrees[0]);
            return;
        }
        parallel_chunks(
            subtrees.size(), execution, [&](std::size_t i) { build(items, boxes, subtrees[i]); },
            0.02);
        for (auto subtree = above.rbegin(); subtree != above.rend(); ++subtree)
            join_boxes(subtree->node);
    }
    void build(std::vector<BoxMiddle>& items, const std::vector<Box>& boxes,
               const Subtree& subtree) {
        if (subtree.end - subtree.begin > kLeaf) {
            for (const Subtree& half : halve(items, subtree))
                build(items, boxes, half);
            join_boxes(subtree.node);
            return;
        }
        Box whole;
        for (std::size_t i = subtree.begin; i < subtree.end; ++i) {
            order_[i] = items[i].number;
            boxes_[i] = boxes[index(items[i].number)];
            whole.include(boxes_[i]);
        }
        nodes_[subtree.node] = {whole, subtree.begin, subtree.end};
        leaves_[subtree.leaf] = subtree.node;
    }
    std::array<Subtree, 2> halve(std::vector<BoxMiddle>& items, const Subtree& subtree) {
        const auto [number, begin, end, leaf] = subtree;
        Box middles;
        for (std::size_t i = begin; i < end; ++i)
            middles.include(items[i].twice_middle);
        std::size_t axis = 0;
        for (std::size_t k = 1; k < 3; ++k) {
            if (middles.high[k] - middles.low[k] > middles.high[axis] - middles.low[axis]) axis = k;
        }
        const std::size_t middle = (begin + end) / 2;
        const auto at = [&items](std::size_t i) {
            return items.begin() + static_cast<std::ptrdiff_t>(i);
        };
        std::nth_element(at(begin), at(middle), at(end),
                         [axis](const BoxMiddle& a, const BoxMiddle& b) {
                             const double p = a.twice_middle[axis], q = b.twice_middle[axis];
                             return p != q ? p < q : a.number < b.number;
                         });
        const std::size_t leaves = leaves_of(middle - begin), second = number + 2 * leaves;
        nodes_[number] = {{}, begin, end, second};
        return {Subtree{number + 1, begin, middle, leaf},
                Subtree{second, middle, end, leaf + leaves}};
    }
    void join_boxes(std::size_t number) {
        Node& node = nodes_[number];
        node.box = nodes_[number + 1].box;
        node.box.include(nodes_[node.second].box);
    }
    static double squared_distance(const Box& box, const Box::Position& p) {
        double sum = 0;
        for (std::size_t k = 0; k < 3; ++k) {
            const double off = std::max({box.low[k] - p[k], p[k] - box.high[k], 0.0});
            sum += off * off;
        }
        return sum;
    }
    template <class Bound, class Visit>
    void approach(std::size_t number, const Box::Position& p, const Bound& bound,
                  const Visit& visit) const {
        const Node& node = nodes_[number];
        if (node.second == 0) {
            for (std::size_t i = node.begin; i < node.end; ++i) {
                if (squared_distance(boxes_[i], p) <= bound()) visit(order_[i]);
            }
            return;
        }
        std::array children{number + 1, node.second};
        std::array away{squared_distance(nodes_[children[0]].box, p),
                        squared_distance(nodes_[children[1]].box, p)};
        if (away[1] < away[0]) {
            std::swap(children[0], children[1]);
            std::swap(away[0], away[1]);
        }
        for (std::size_t i = 0; i < 2; ++i) {
            if (away[i] <= bound()) approach(children[i], p, bound, visit);
        }
    }
    template <class Accepts>
    bool any(std::size_t number, const Box& box, const Accepts& accepts) const {
        const Node& node = nodes_[number];
        if (!node.box.meets(box)) return false;
        for (std::size_t i = node.begin; node.second == 0 && i < node.end; ++i) {
            if (boxes_[i].meets(box) && accepts(order_[i])) return true;
        }
        return node.second != 0 &&
               (any(number + 1, box, accepts) || any(node.second, box, accepts));
    }
    /// Calls visit(leaf) for the leaves that meet a box and do not end at a position or before it.
    template <class Visit>
    void for_each_leaf(const Box& box, const Visit& visit, std::size_t after = 0) const {
        // of a node that meets it the second child waits; none of a tree of 2^31 boxes is deeper
        std::array<std::size_t, 64> waiting;
        std::size_t count = 0;
        waiting[count++] = 0;
        while (count > 0) {
            const std::size_t number = waiting[--count];
            const Node& node = nodes_[number];
            if (node.end <= after || !node.box.meets(box)) continue;
            if (node.second == 0) {
                visit(node);
                continue;
            }
            waiting[count++] = node.second;
            waiting[count++] = number + 1;
        }
    }

    std::vector<Box> boxes_;           ///< in the order of the leaves
    std::vector<std::int32_t> order_;  ///< their numbers
    std::vector<Node> nodes_;
    std::vector<std::size_t> leaves_;  ///< their numbers among the nodes
};

}  // namespace realmodel::spatial
