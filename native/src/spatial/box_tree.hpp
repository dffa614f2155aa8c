// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <numeric>
#include <vector>

#include "base/index.hpp"

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

/// Finds the boxes that meet a given one: a binary tree that halves them along their longest side.
class BoxTree {
public:
    explicit BoxTree(std::vector<Box> boxes) : boxes_(std::move(boxes)), order_(boxes_.size()) {
        std::iota(order_.begin(), order_.end(), 0);
        if (!boxes_.empty()) build(0, order_.size());
    }

    /// Calls visit(number) for each, in no particular but always the same order.
    template <class Visit>
    void find(const Box& box, const Visit& visit) const {
        if (!nodes_.empty()) find(0, box, visit);
    }
    /// Calls visit(number) for each box whose squared distance from p is at most bound(), which may
    /// grow less with every visit; near ones come first on the whole, always in the same order.
    template <class Bound, class Visit>
    void approach(const Box::Position& p, const Bound& bound, const Visit& visit) const {
        if (!nodes_.empty()) approach(0, p, bound, visit);
    }
    bool any(const Box& box) const {
        bool found = false;
        find(box, [&found](std::int32_t) { found = true; });
        return found;
    }

private:
    static constexpr std::size_t kLeaf = 4;
    struct Node {
        Box box;
        std::size_t begin, end;
        std::size_t second = 0;  ///< the first child follows; 0: a leaf
    };

    std::size_t build(std::size_t begin, std::size_t end) {
        const std::size_t number = nodes_.size();
        nodes_.push_back({{}, begin, end});
        Box whole;
        for (std::size_t i = begin; i < end; ++i)
            whole.include(boxes_[index(order_[i])]);
        nodes_[number].box = whole;
        if (end - begin <= kLeaf) return number;
        std::size_t axis = 0;
        for (std::size_t k = 1; k < 3; ++k) {
            if (whole.high[k] - whole.low[k] > whole.high[axis] - whole.low[axis]) axis = k;
        }
        const std::size_t middle = (begin + end) / 2;
        const auto at = [this](std::size_t i) {
            return order_.begin() + static_cast<std::ptrdiff_t>(i);
        };
        std::nth_element(at(begin), at(middle), at(end), [&](std::int32_t a, std::int32_t b) {
            const Box &p = boxes_[index(a)], &q = boxes_[index(b)];
            return std::pair(p.low[axis] + p.high[axis], a) <
                   std::pair(q.low[axis] + q.high[axis], b);
        });
        build(begin, middle);
        const std::size_t second = build(middle, end);
        nodes_[number].second = second;
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
                if (squared_distance(boxes_[index(order_[i])], p) <= bound()) visit(order_[i]);
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
    template <class Visit>
    void find(std::size_t number, const Box& box, const Visit& visit) const {
        const Node& node = nodes_[number];
        if (!node.box.meets(box)) return;
        if (node.second == 0) {
            for (std::size_t i = node.begin; i < node.end; ++i) {
                if (boxes_[index(order_[i])].meets(box)) visit(order_[i]);
            }
            return;
        }
        find(number + 1, box, visit);
        find(node.second, box, visit);
    }

    std::vector<Box> boxes_;
    std::vector<std::int32_t> order_;
    std::vector<Node> nodes_;
};

}  // namespace realmodel::spatial
