// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <iterator>
#include <span>

#include "base/index.hpp"
#include "base/key_table.hpp"
#include "realmodel/base/array.hpp"

namespace realmodel::arrangement {

/// The outline of a region, then its holes: views of what a LoopTable has.
template <class Node>
class Loops {
public:
    class Iterator {
    public:
        using iterator_category = std::forward_iterator_tag;
        using difference_type = std::ptrdiff_t;
        using value_type = std::span<const Node>;
        using reference = value_type;
        using pointer = void;

        Iterator() = default;
        Iterator(const Node* nodes, const std::size_t* begin) : nodes_(nodes), begin_(begin) {}
        value_type operator*() const { return {nodes_ + begin_[0], nodes_ + begin_[1]}; }
        Iterator& operator++() {
            ++begin_;
            return *this;
        }
        Iterator operator++(int) {
            Iterator before = *this;
            ++begin_;
            return before;
        }
        bool operator==(const Iterator&) const = default;

    private:
        const Node* nodes_ = nullptr;
        const std::size_t* begin_ = nullptr;
    };

    Loops(const Node* nodes, const std::size_t* begins, std::size_t count)
        : nodes_(nodes), begins_(begins), count_(count) {}
    std::size_t size() const { return count_; }
    std::span<const Node> operator[](std::size_t i) const { return *Iterator(nodes_, begins_ + i); }
    Iterator begin() const { return {nodes_, begins_}; }
    Iterator end() const { return {nodes_, begins_ + count_}; }

private:
    const Node* nodes_;
    const std::size_t* begins_;
    std::size_t count_;
};

/// A hash that is the same for loops of the same nodes, wherever they begin.
template <class Node>
std::uint32_t loop_hash(std::span<const Node> loop) {
    std::uint32_t hash = 0;
    for (const Node node : loop)
        hash += KeyTable::hash(std::array{static_cast<std::uint64_t>(index(node))});
    return hash;
}

/// 1 where two loops pass the same nodes in the same order, from whichever on; -1 where they do so
/// against each other; else 0.
template <class Node>
std::int8_t facing_of(std::span<const Node> one, std::span<const Node> other) {
    const std::size_t n = one.size();
    if (other.size() != n) return 0;
    for (const bool back : {false, true}) {
        for (std::size_t begin = 0; begin < n; ++begin) {
            std::size_t i = 0;
            while (i < n && one[i] == other[(begin + (back ? n - i : i)) % n])
                ++i;
            if (i == n) return back ? -1 : 1;
        }
    }
    return 0;
}

/// The loops of many regions in three arrays.
template <class Node>
struct LoopTable {
    Array<Node> nodes;
    Array<std::size_t> loop_begins{0};    ///< in `nodes`, and the end of the last
    Array<std::size_t> region_begins{0};  ///< among loops, likewise

    std::size_t size() const { return region_begins.size() - 1; }
    Loops<Node> operator[](std::size_t region) const {
        const std::size_t begin = region_begins[region];
        return {nodes.data(), loop_begins.data() + begin, region_begins[region + 1] - begin};
    }
    void add_loop(std::span<const Node> loop) {
        nodes.append(loop.begin(), loop.end());
        end_loop();
    }
    /// Ends a loop whose nodes were appended one by one.
    void end_loop() { loop_begins.push_back(nodes.size()); }
    /// Ends a region whose loops were added.
    void end_region() { region_begins.push_back(loop_begins.size() - 1); }
};

}  // namespace realmodel::arrangement
