// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <cstdint>
#include <span>
#include <vector>

#include "base/counting_sort.hpp"
#include "base/parallel_sort.hpp"

namespace realmodel {

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
        const std::size_t buckets = std::clamp<std::size_t>(expected / kTogether, 1, kMostBuckets);
        const auto by_bucket = [&](std::size_t chunk, const auto& put) {
            produce(chunk, [&](const Element& e) { put(bucket_of(e, buckets), e); });
        };
        auto made = bucketize_in_order<Element>(buckets, chunks, by_bucket, execution);
        for (std::size_t b = 0; b < buckets; ++b) {
            if (made[b].size() <= kMost) continue;
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
    static constexpr std::size_t kTogether = 256, kMostBuckets = 1 << 14,
                                 kMost = 1 << 18,  // in a bucket that one thread sorts
        kFew = 16;

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
        if (count <= kFew) {
            std::sort(first, first + count, less_);
            return;
        }
        const double scale = static_cast<double>(count);
        const auto part_of = [&](const Element& e) {
            const double in_bucket = position(e, buckets) - static_cast<double>(bucket);
            return std::min(static_cast<std::size_t>(in_bucket * scale), count - 1);
        };
        scratch.assign(first, first + count);
        ends.assign(count + 1, 0);
        for (const Element& e : scratch)
            ++ends[part_of(e) + 1];
        for (std::size_t i = 1; i <= count; ++i)
            ends[i] += ends[i - 1];
        for (const Element& e : scratch)
            first[ends[part_of(e)]++] = e;
        // now they are the ends, and each begins where the one before it ends
        for (std::size_t i = 0, from = 0; i < count; from = ends[i++]) {
            if (ends[i] - from > 1) std::sort(first + from, first + ends[i], less_);
        }
    }

    Fraction fraction_;
    Less less_;
};

}  // namespace realmodel
