// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <numeric>
#include <utility>
#include <vector>

namespace realmodel {

/// Disjoint sets of the numbers 0 .. count - 1; the least member stands for each. Any number of
/// threads may join and look up at once: what comes out in the end does not depend on their order
/// (R. J. Anderson and H. Woll, Wait-free parallel algorithms for the union-find problem, 1991).
class DisjointSets {
public:
    explicit DisjointSets(std::size_t count) : parent_(count) {
        std::iota(parent_.begin(), parent_.end(), 0);
    }
    std::size_t size() const { return parent_.size(); }
    /// The least member of the set of i.
    std::int32_t find(std::int32_t i) {
        for (;;) {
            std::int32_t above = at(i).load(std::memory_order_relaxed);
            if (above == i) return i;
            const std::int32_t next = at(above).load(std::memory_order_relaxed);
            if (next == above) return above;
            // half of the way is left for those who come later
            at(i).compare_exchange_weak(above, next, std::memory_order_relaxed);
            i = next;
        }
    }
    void join(std::int32_t a, std::int32_t b) {
        for (;;) {
            a = find(a);
            b = find(b);
            if (a == b) return;
            if (a < b) std::swap(a, b);
            std::int32_t root = a;  // until another thread joins it
            if (at(a).compare_exchange_strong(root, b, std::memory_order_relaxed)) return;
        }
    }

private:
    std::atomic_ref<std::int32_t> at(std::int32_t i) {
        return std::atomic_ref(parent_[static_cast<std::size_t>(i)]);
    }
    std::vector<std::int32_t> parent_;
};

}  // namespace realmodel
