// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cassert>
#include <cstddef>
#include <span>
#include <vector>

namespace realmodel {

/// Items in groups by a key, those of a group in the order in which they came.
template <class Item>
struct GroupedItems {
    std::vector<std::size_t> first;  ///< of each key's items, and the end
    std::vector<Item> items;

    std::span<Item> operator[](std::size_t key) {
        return std::span(items).subspan(first[key], first[key + 1] - first[key]);
    }
    std::span<const Item> operator[](std::size_t key) const {
        return std::span(items).subspan(first[key], first[key + 1] - first[key]);
    }
};

/// A counting sort.
/// @param keys      items have keys from 0 to keys - 1
/// @param for_each  for_each(visit) calls visit(key, item) for each item; it is called twice
template <class Item, class ForEach>
GroupedItems<Item> grouped(std::size_t keys, const ForEach& for_each) {
    GroupedItems<Item> out;
    out.first.assign(keys + 1, 0);
    for_each([&](std::size_t key, const Item&) {
        assert(key < keys);
        ++out.first[key + 1];
    });
    for (std::size_t key = 0; key < keys; ++key)
        out.first[key + 1] += out.first[key];
    out.items.resize(out.first.back());
    std::vector<std::size_t> next(out.first.begin(), out.first.end() - 1);
    for_each([&](std::size_t key, const Item& item) { out.items[next[key]++] = item; });
    assert(next.empty() || next.back() == out.items.size());
    return out;
}

}  // namespace realmodel
