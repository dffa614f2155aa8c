// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <atomic>
#include <utility>
#include <vector>

#include "base/parallel.hpp"
#include "realmodel/base/array.hpp"
#include "realmodel/base/errors.hpp"

namespace realmodel {

/// How many items there are before each of several chunks, from how many each has.
/// @return how many there are in all
inline std::size_t exclusive_scan(std::vector<std::size_t>& counts) {
    std::size_t total = 0;
    for (std::size_t& count : counts)
        total += std::exchange(count, total);
    return total;
}

/// Numbers those of some items of which is_one(item) holds, in their order: take(item, number) is
/// called for each, on several threads.
/// @param make_room  called with how many there are, before they are taken
template <class IsOne, class MakeRoom, class Take>
void number_in_order(std::size_t items, const Execution& execution, const IsOne& is_one,
                     const MakeRoom& make_room, const Take& take) {
    constexpr std::size_t kChunk = 1 << 14;
    std::vector<std::size_t> before((items + kChunk - 1) / kChunk);
    parallel_ranges(items, kChunk, execution, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i)
            before[begin / kChunk] += is_one(i) ? 1 : 0;
    });
    make_room(exclusive_scan(before));
    parallel_ranges(items, kChunk, execution, [&](std::size_t begin, std::size_t end) {
        std::size_t number = before[begin / kChunk];
        for (std::size_t i = begin; i < end; ++i) {
            if (is_one(i)) take(i, number++);
        }
    });
}

/// @throws InputError kind too_large, where there are more vertices than so many
inline void check_total(std::size_t vertices, std::uint64_t largest) {
    if (vertices > largest) {
        throw InputError("too_large", "the model needs more than " +
                                          std::to_string(largest / 1000000) +
                                          " million vertices; use coarser surfaces");
    }
}

/// The same for many numbers; the last element becomes the sum of all.
/// @throws InputError kind too_large, where the sum is more than `largest`
template <class Number>
void running_totals(Array<Number>& counts, std::uint64_t largest, const Execution& execution) {
    constexpr std::size_t kChunk = 1 << 16;
    const std::size_t count = counts.size() - 1;
    std::vector<std::size_t> before((count + kChunk - 1) / kChunk);
    parallel_ranges(count, kChunk, execution, [&](std::size_t begin, std::size_t end) {
        std::size_t sum = 0;
        for (std::size_t i = begin; i < end; ++i)
            sum += static_cast<std::size_t>(counts[i]);
        before[begin / kChunk] = sum;
    });
    const std::size_t total = exclusive_scan(before);
    check_total(total, largest);
    parallel_ranges(count, kChunk, execution, [&](std::size_t begin, std::size_t end) {
        std::size_t sum = before[begin / kChunk];
        for (std::size_t i = begin; i < end; ++i) {
            const auto addend = static_cast<std::size_t>(counts[i]);
            counts[i] = static_cast<Number>(sum);
            sum += addend;
        }
    });
    counts[count] = static_cast<Number>(total);
}

/// An array of zeros.
template <class Number>
Array<Number> zeros(std::size_t size, const Execution& execution) {
    Array<Number> array(size);
    parallel_ranges(size, 1 << 18, execution, [&](std::size_t begin, std::size_t end) {
        std::fill(array.begin() + begin, array.begin() + end, Number{});
    });
    return array;
}

/// Counts one more item, from any thread; the number of those before it. Which thread comes first
/// is left to chance, so nothing that is kept may depend on the answer.
inline std::uint32_t atomic_increment(std::uint32_t& counter) {
    return std::atomic_ref(counter).fetch_add(1, std::memory_order_relaxed);
}

/// Asks for memory that will be read some rounds later. (Calls that do nothing else are left out by
/// g++, so this and what calls it for that alone must be inlined.)
[[gnu::always_inline]] inline void prefetch(const void* address) {
    __builtin_prefetch(address);
}

/// Makes a value the least of what any thread gives, or the greatest by another order.
template <class Value, class Before>
void atomic_min_by(Value& value, Value other, const Before& before) {
    const std::atomic_ref shared(value);
    Value known = shared.load(std::memory_order_relaxed);
    while (before(other, known) &&
           !shared.compare_exchange_weak(known, other, std::memory_order_relaxed)) {
    }
}

/// Says so of an item, from any thread: all write the same.
inline void atomic_set(std::uint8_t& flag) {
    std::atomic_ref(flag).store(1, std::memory_order_relaxed);
}

}  // namespace realmodel
