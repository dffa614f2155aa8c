// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <cstddef>
#include <functional>
#include <iterator>
#include <span>
#include <type_traits>
#include <utility>
#include <vector>

#include "base/parallel.hpp"

namespace realmodel {

/// Runs of neighbors with equal keys, each a span: `for (const auto group : groups_of(uses,
/// &Use::edge))`. They are groups of equal keys if the items are sorted by these.
template <class Item, class Key>
class Groups {
public:
    Groups(std::span<Item> items, Key key) : items_(items), key_(std::move(key)) {}

    class Iterator {
    public:
        Iterator(const Groups& groups, std::size_t begin) : groups_(groups), begin_(begin) {
            find_end();
        }
        std::span<Item> operator*() const { return groups_.items_.subspan(begin_, end_ - begin_); }
        Iterator& operator++() {
            begin_ = end_;
            find_end();
            return *this;
        }
        bool operator==(const Iterator& other) const { return begin_ == other.begin_; }

    private:
        void find_end() {
            const auto& [items, key] = groups_;
            end_ = begin_ + 1;  // a key may differ from itself (NaN)
            while (end_ < items.size() &&
                   std::invoke(key, items[end_]) == std::invoke(key, items[begin_]))
                ++end_;
        }
        const Groups& groups_;
        std::size_t begin_, end_ = 0;
    };
    Iterator begin() const { return {*this, 0}; }
    Iterator end() const { return {*this, items_.size()}; }

private:
    std::span<Item> items_;
    Key key_;
};

template <class Items, class Key = std::identity>
auto groups_of(Items&& items, Key key = {}) {
    const std::span all(items);
    return Groups<typename decltype(all)::element_type, Key>(all, std::move(key));
}

/// The items with a key, of some that are sorted by it, as a span. (clang++ 14 cannot read
/// std::ranges::equal_range of libstdc++.)
template <class Items, class Value, class Key>
auto items_with_key(Items&& sorted, const Value& value, Key key) {
    const std::span all(sorted);
    const auto begin = std::ranges::lower_bound(all, value, {}, key) - all.begin();
    const auto end = std::ranges::upper_bound(all, value, {}, key) - all.begin();
    return all.subspan(static_cast<std::size_t>(begin), static_cast<std::size_t>(end - begin));
}

/// Sorts elements and keeps each once.
template <class Element>
void sort_unique(std::vector<Element>& elements) {
    if (!std::is_sorted(elements.begin(), elements.end()))
        std::sort(elements.begin(), elements.end());
    elements.erase(std::unique(elements.begin(), elements.end()), elements.end());
}

/// Keeps of sorted elements those that occur once.
template <class Element>
void keep_single(std::vector<Element>& sorted) {
    std::size_t single_count = 0;
    for (const auto group : groups_of(sorted)) {
        if (group.size() == 1) sorted[single_count++] = group[0];
    }
    sorted.erase(sorted.begin() + static_cast<std::ptrdiff_t>(single_count), sorted.end());
}

/// What a function gives for each of some items, in their order.
template <class Items, class Function>
auto transformed(const Items& items, const Function& function) {
    std::vector<std::decay_t<decltype(std::invoke(function, *std::begin(items)))>> made;
    made.reserve(std::size(items));
    for (const auto& item : items)
        made.push_back(std::invoke(function, item));
    return made;
}

/// Makes room for so many more elements; where there is none, for twice as many as before at least.
template <class List>
void reserve_more(List& list, std::size_t more) {
    if (list.capacity() - list.size() < more)
        list.reserve(std::max(list.size() + more, 2 * list.capacity()));
}

/// The items of some lists, one list after another.
template <class Item>
std::vector<Item> concatenated(const std::vector<std::vector<Item>>& lists) {
    std::vector<Item> all;
    for (const auto& list : lists)
        all.insert(all.end(), list.begin(), list.end());
    return all;
}

/// Calls work(begin, end, list) for ranges, as parallel_ranges() does.
/// @return what they have added to their `list`, in the order of ranges
template <class Item, class Work>
std::vector<Item> collect_ranges(std::size_t count, std::size_t size, const Execution& execution,
                                 const Work& work, double share = 0.2) {
    std::vector<std::vector<Item>> lists((count + size - 1) / size);
    parallel_ranges(
        count, size, execution,
        [&](std::size_t begin, std::size_t end) { work(begin, end, lists[begin / size]); }, share);
    return concatenated(lists);
}

/// The same of work(i, list) for every item, many of them in a chunk, as parallel_for_each() does.
template <class Item, class Work>
std::vector<Item> collect_items(std::size_t count, const Execution& execution, const Work& work) {
    return collect_ranges<Item>(count, 1 << 12, execution,
                                [&](std::size_t begin, std::size_t end, auto& list) {
                                    for (std::size_t i = begin; i < end; ++i)
                                        work(i, list);
                                });
}

}  // namespace realmodel
