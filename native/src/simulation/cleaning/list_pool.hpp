// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <cassert>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "base/index.hpp"

namespace realmodel::simulation {

/// Many short lists of numbers in one array; a list that outgrows its room moves to the end.
class ListPool {
public:
    /// Lists that are given one after another: list i is numbers[offsets[i] .. offsets[i + 1]].
    template <class Offset>
    ListPool(std::span<const Offset> offsets, std::vector<std::int32_t> numbers)
        : numbers_(std::move(numbers)) {
        lists_.reserve(offsets.size());
        for (std::size_t i = 0; i + 1 < offsets.size(); ++i) {
            const auto size = static_cast<std::uint32_t>(offsets[i + 1] - offsets[i]);
            lists_.push_back({static_cast<std::size_t>(offsets[i]), size, size});
        }
    }
    std::size_t size() const { return lists_.size(); }
    std::span<const std::int32_t> operator[](std::int32_t list) const {
        const List& own = lists_[index(list)];
        return {numbers_.data() + own.begin, own.size};
    }
    std::int32_t add_list() {
        lists_.push_back({numbers_.size(), 0, 0});
        return checked_number(lists_.size() - 1, "faces");
    }
    void push(std::int32_t list, std::int32_t number) {
        List& own = lists_[index(list)];
        if (own.size == own.room) make_room(own, 2 * own.size + 2);
        numbers_[own.begin + own.size++] = number;
    }
    /// Takes out a number that is there once; the order of the others stays.
    void erase(std::int32_t list, std::int32_t number) {
        List& own = lists_[index(list)];
        const auto begin = numbers_.begin() + static_cast<std::ptrdiff_t>(own.begin);
        const auto end = begin + own.size;
        assert(std::count(begin, end, number) == 1);
        own.size = static_cast<std::uint32_t>(std::remove(begin, end, number) - begin);
    }
    void set(std::int32_t list, std::span<const std::int32_t> numbers) {
        List& own = lists_[index(list)];
        own.size = 0;
        if (numbers.size() > own.room) make_room(own, numbers.size());
        std::copy(numbers.begin(), numbers.end(),
                  numbers_.begin() + static_cast<std::ptrdiff_t>(own.begin));
        own.size = static_cast<std::uint32_t>(numbers.size());
    }

private:
    struct List {
        std::size_t begin;
        std::uint32_t size, room;
    };
    void make_room(List& list, std::size_t room) {
        const std::size_t begin = numbers_.size();
        numbers_.resize(begin + room);
        std::copy_n(numbers_.begin() + static_cast<std::ptrdiff_t>(list.begin), list.size,
                    numbers_.begin() + static_cast<std::ptrdiff_t>(begin));
        list.begin = begin;
        list.room = static_cast<std::uint32_t>(room);
    }

    std::vector<std::int32_t> numbers_;
    std::vector<List> lists_;
};

}  // namespace realmodel::simulation
