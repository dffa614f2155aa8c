// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <cstdint>
#include <span>
#include <vector>

#include "base/counting_sort.hpp"
#include "base/parallel.hpp"

namespace realmodel {

/// Sorts by a total order on several threads; can be cancelled. Equal elements must be alike, for
/// their order is not kept.
template <class Array, class Less>
void parallel_sort(Array& elements, const Less& less, const Execution& execution) {
    // runs that fit the cache, and of few elements enough runs for several threads
    constexpr std::size_t kLongest = 1 << 16, kShortest = 1 << 12;
    const std::size_t count = elements.size();
    const std::size_t run_length = std::clamp(count / 8, kShortest, kLongest);
    const auto at = [&](Array& of, std::size_t i) {
        return of.begin() + static_cast<std::ptrdiff_t>(std::min(i, count));
    };
    parallel_chunks((count + run_length - 1) / run_length, execution, [&](std::size_t run) {
        std::sort(at(elements, run * run_length), at(elements, (run + 1) * run_length), less);
    });
    if (count <= run_length) return;
    Array merged(count);
    for (std::size_t width = run_length; width < count; width *= 2) {
        // Each pair of runs is merged in pieces of about one run, cut where a value of the first
        // run would stand in the second, so that the last merges are shared between threads too.
        const std::size_t pieces_of_pair = 2 * width / run_length;
        const std::size_t pairs = (count + 2 * width - 1) / (2 * width);
        parallel_chunks(pairs * pieces_of_pair, execution, [&](std::size_t chunk) {
            const std::size_t begin = chunk / pieces_of_pair * 2 * width;
            const std::size_t middle = std::min(begin + width, count);
            const std::size_t end = std::min(begin + 2 * width, count);
            const auto cut = [&](std::size_t piece) {
                const std::size_t first = begin + piece * (middle - begin) / pieces_of_pair;
                if (piece == 0) return std::pair(first, middle);
                if (piece == pieces_of_pair) return std::pair(middle, end);
                const auto second = std::lower_bound(at(elements, middle), at(elements, end),
                                                     elements[first], less);
                return std::pair(first, static_cast<std::size_t>(second - elements.begin()));
            };
            const std::size_t piece = chunk % pieces_of_pair;
            const auto [first, second] = cut(piece);
            const auto [first_end, second_end] = cut(piece + 1);
            std::merge(at(elements, first), at(elements, first_end), at(elements, second),
                       at(elements, second_end), at(merged, first + second - middle), less);
        });
        elements.swap(merged);
    }
}

/// Sorts numbers that are spread more or less evenly, by a total order, in time that is linear
/// there: they are put into buckets twice, and what is in one at last is a handful. However uneven
/// they are, it is never much slower than parallel_sort.
template <class Element, class Fraction, class Less>
class BucketSort {
public:
    /// @param fraction  of an element, from 0 to 1: how much of the range lies before it. What is
    /// before another must not have a larger one.
    BucketSort(Fraction fraction, Less less)
        : fraction_(std::move(fraction)), less_(std::move(less)) {}

    /// @param produce  produce(chunk, take) calls take(element) for all elements of a chunk; it is
    /// called twice for each
    template <class Produce>
    Array<Element> sorted(std::size_t chunks, std::size_t expected, const Produce& produce,
                          const Execution& execution) const {
        const std::size_t buckets = std::clamp<std::size_t>(expected / kGrain, 1, kMaxBuckets);
        const auto by_bucket = [&](std::size_t chunk, const auto& put) {
            produce(chunk, [&](const Element& e) { put(bucket_of(e, buckets), e); });
        };
        auto made = bucketize_in_order<Element>(buckets, chunks, by_bucket, execution);
        for (std::size_t b = 0; b < buckets; ++b) {
            if (made[b].size() <= kMaxBucket) continue;
            parallel_sort(made.values, less_, execution);
            return std::move(made.values);
        }
        constexpr std::size_t kBuckets = 64;  // sorted at a time
        parallel_ranges(buckets, kBuckets, execution, [&](std::size_t begin, std::size_t end) {
            std::vector<Element> scratch;
            std::vector<std::uint32_t> ends;
            for (std::size_t b = begin; b < end; ++b)
                sort_bucket(made[b], b, buckets, scratch, ends);
        });
        return std::move(made.values);
    }

private:
    static constexpr std::size_t kGrain = 256;  // elements of a bucket
    static constexpr std::size_t kMaxBuckets = 1 << 14;
    static constexpr std::size_t kMaxBucket = 1 << 18;  // elements that one thread sorts
    static constexpr std::size_t kInsertionSortBelow = 17;

    double position(const Element& e, std::size_t buckets) const {
        return fraction_(e) * static_cast<double>(buckets);
    }
    std::size_t bucket_of(const Element& e, std::size_t buckets) const {
        return std::min(static_cast<std::size_t>(position(e, buckets)), buckets - 1);
    }

    void sort_bucket(std::span<Element> elements, std::size_t bucket, std::size_t buckets,
                     std::vector<Element>& scratch, std::vector<std::uint32_t>& ends) const {
        Element* const first = elements.data();
        const std::size_t count = elements.size();
        if (count < kInsertionSortBelow) {
            std::sort(first, first + count, less_);
            return;
        }
        const double scale = static_cast<double>(count);
        const auto range_of = [&](const Element& e) {
            const double in_bucket = position(e, buckets) - static_cast<double>(bucket);
            return std::min(static_cast<std::size_t>(in_bucket * scale), count - 1);
        };
        scratch.assign(first, first + count);
        ends.assign(count + 1, 0);
        for (const Element& e : scratch)
            ++ends[range_of(e) + 1];
        for (std::size_t i = 1; i <= count; ++i)
            ends[i] += ends[i - 1];
        for (const Element& e : scratch)
            first[ends[range_of(e)]++] = e;
        // now they are the ends, and each begins where the one before it ends
        for (std::size_t i = 0, from = 0; i < count; from = ends[i++]) {
            if (ends[i] - from > 1) std::sort(first + from, first + ends[i], less_);
        }
    }

    Fraction fraction_;
    Less less_;
};

}  // namespace realmodel
