// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <numeric>
#include <vector>

#include "base/index.hpp"
#include "realmodel/base/progress.hpp"

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
    void include(const Box& other) {
        include(other.low);
        include(other.high);
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

/// Finds the boxes that meet a given one: a binary tree that halves them along the
/// longest side of their middles.
class BoxTree {
public:
    /// @throws Cancelled
    explicit BoxTree(std::vector<Box> boxes, Progress* progress = nullptr) {
        // the boxes and their middles lie together while they are put in order
        std::vector<Item> items(boxes.size());
        for (std::size_t i = 0; i < boxes.size(); ++i) {
            for (std::size_t k = 0; k < 3; ++k)
                items[i].twice_middle[k] = boxes[i].low[k] + boxes[i].high[k];
            items[i].number = static_cast<std::int32_t>(i);
        }
        order_.resize(boxes.size());
        boxes_.resize(boxes.size());
        if (!boxes.empty()) build(items, boxes, 0, items.size(), progress);
    }

    /// Calls visit(number) for each, in no particular but always the same order.
    template <class Visit>
    void find(const Box& box, const Visit& visit) const {
        if (nodes_.empty()) return;
        each_leaf(box, [&](const Node& leaf) {
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
    /// Calls visit(number, other) for each two boxes that meet, once: those of which the first in
    /// the order of the leaves is in some of them, from 0 to leaf_count() - 1. Always in the same
    /// order, the pairs of a first box one after another.
    template <class Visit>
    void find_pairs(std::size_t first_leaf, std::size_t end_leaf, const Visit& visit) const {
        std::vector<const Node*> near;
        for (std::size_t leaf = first_leaf; leaf < end_leaf; ++leaf) {
            const Node& own = nodes_[leaves_[leaf]];
            near.clear();
            each_leaf(
                own.box, [&near](const Node& other) { near.push_back(&other); }, own.begin);
            for (std::size_t i = own.begin; i < own.end; ++i) {
                for (const Node* other : near) {
                    for (std::size_t j = std::max(i + 1, other->begin); j < other->end; ++j) {
                        if (boxes_[i].meets(boxes_[j])) visit(order_[i], order_[j]);
                    }
                }
            }
        }
    }
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

    struct Item {
        Box::Position twice_middle;
        std::int32_t number;
    };

    std::size_t build(std::vector<Item>& items, const std::vector<Box>& boxes, std::size_t begin,
                      std::size_t end, Progress* progress) {
        constexpr std::size_t kUnasked = 1 << 10;  // so few are soon done
        if (progress != nullptr && end - begin > kUnasked) progress->check();
        const std::size_t number = nodes_.size();
        nodes_.push_back({{}, begin, end});
        if (end - begin <= kLeaf) {
            Box whole;
            for (std::size_t i = begin; i < end; ++i) {
                order_[i] = items[i].number;
                boxes_[i] = boxes[index(items[i].number)];
                whole.include(boxes_[i]);
            }
            nodes_[number].box = whole;
            leaves_.push_back(number);
            return number;
        }
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
        std::nth_element(at(begin), at(middle), at(end), [axis](const Item& a, const Item& b) {
            const double p = a.twice_middle[axis], q = b.twice_middle[axis];
            return p != q ? p < q : a.number < b.number;
        });
        build(items, boxes, begin, middle, progress);
        const std::size_t second = build(items, boxes, middle, end, progress);
        nodes_[number].second = second;
        nodes_[number].box = nodes_[number + 1].box;
        nodes_[number].box.include(nodes_[second].box);
        return number;
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
    void each_leaf(const Box& box, const Visit& visit, std::size_t after = 0) const {
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
