// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>
#include <iterator>
#include <type_traits>
#include <vector>

#include "base/parallel.hpp"

namespace realmodel {

/// What a function gives for each of some items, in their order.
template <class Items, class Function>
auto mapped(const Items& items, const Function& function) {
    std::vector<std::decay_t<decltype(std::invoke(function, *std::begin(items)))>> made;
    made.reserve(std::size(items));
    for (const auto& item : items)
        made.push_back(std::invoke(function, item));
    return made;
}

/// The items of some lists, one list after another.
template <class Item>
std::vector<Item> joined(const std::vector<std::vector<Item>>& lists) {
    std::vector<Item> all;
    for (const auto& list : lists)
        all.insert(all.end(), list.begin(), list.end());
    return all;
}

/// Calls work(begin, end, found) for ranges, as parallel_ranges() does.
/// @return what they have added to their `found`, in the order of ranges
template <class Item, class Work>
std::vector<Item> found_in_ranges(std::size_t count, std::size_t size, const Execution& execution,
                                  const Work& work, double share = 0.2) {
    std::vector<std::vector<Item>> found((count + size - 1) / size);
    parallel_ranges(
        count, size, execution,
        [&](std::size_t begin, std::size_t end) { work(begin, end, found[begin / size]); }, share);
    return joined(found);
}

/// The same of work(i, found) for every item, many of them in a chunk, as parallel_each() does.
template <class Item, class Work>
std::vector<Item> found_in_each(std::size_t count, const Execution& execution, const Work& work) {
    return found_in_ranges<Item>(count, 1 << 12, execution,
                                 [&](std::size_t begin, std::size_t end, auto& found) {
                                     for (std::size_t i = begin; i < end; ++i)
                                         work(i, found);
                                 });
}

}  // namespace realmodel
