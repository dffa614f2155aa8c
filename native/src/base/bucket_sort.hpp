// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

#include "base/parallel_counts.hpp"
#include "base/parallel_sort.hpp"
#include "realmodel/base/growing_array.hpp"

namespace realmodel {

/// Sorts numbers that are spread more or less evenly, by a total order, in time that is linear
/// there: they are put into buckets twice, and what is in one at last is a handful. However uneven
/// they are, it is never much slower than parallel_sort.
template <class Element, class Share, class Less>
class BucketSort {
public:
    /// @param share  of an element, from 0 to 1: how much of the range lies before it. What is
    /// before another must not have a larger share.
    BucketSort(Share share, Less less) : share_(std::move(share)), less_(std::move(less)) {}

    /// @param produce  produce(chunk, take) calls take(element) for all elements of a chunk; it is
    /// called twice for each
    template <class Produce>
    GrowingArray<Element> sorted(std::size_t chunks, std::size_t expected, const Produce& produce,
                                 int threads, const Progress* progress) const {
        const std::size_t buckets = std::clamp<std::size_t>(expected / kTogether, 1, kMostBuckets);
        std::vector<std::vector<std::uint32_t>> filling(chunks);
        parallel_chunks(chunks, threads, progress, [&](std::size_t chunk) {
            filling[chunk].resize(buckets);
            produce(chunk, [&](const Element& e) { ++filling[chunk][bucket_of(e, buckets)]; });
        });
        std::vector<std::size_t> first{0};
        std::size_t largest = 0;
        for (std::size_t b = 0; b < buckets; ++b) {
            std::size_t next = first.back();
            for (auto& of_chunk : filling) {
                const std::uint32_t own = of_chunk[b];
                of_chunk[b] = static_cast<std::uint32_t>(next);
                next += own;
            }
            largest = std::max(largest, next - first.back());
            first.push_back(next);
        }
        GrowingArray<Element> elements(first.back());
        parallel_chunks(chunks, threads, progress, [&](std::size_t chunk) {
            produce(chunk, [&](const Element& e) {
                elements[filling[chunk][bucket_of(e, buckets)]++] = e;
            });
            filling[chunk] = {};
        });
        if (largest > kMost) {
            parallel_sort(elements, less_, threads, progress);
            return elements;
        }
        constexpr std::size_t kBuckets = 64;  // sorted at a time
        parallel_ranges(
            buckets, kBuckets, threads, progress, [&](std::size_t begin, std::size_t end) {
                std::vector<Element> scratch;
                std::vector<std::uint32_t> ends;
                for (std::size_t b = begin; b < end; ++b)
                    sort_bucket(elements, first[b], first[b + 1], b, buckets, scratch, ends);
            });
        return elements;
    }

private:
    static constexpr std::size_t kTogether = 256, kMostBuckets = 1 << 14,
                                 kMost = 1 << 18,  // in a bucket that one thread sorts
        kFew = 16;

    double place(const Element& e, std::size_t buckets) const {
        return share_(e) * static_cast<double>(buckets);
    }
    std::size_t bucket_of(const Element& e, std::size_t buckets) const {
        return std::min(static_cast<std::size_t>(place(e, buckets)), buckets - 1);
    }

    void sort_bucket(GrowingArray<Element>& elements, std::size_t begin, std::size_t end,
                     std::size_t bucket, std::size_t buckets, std::vector<Element>& scratch,
                     std::vector<std::uint32_t>& ends) const {
        Element* const first = elements.data() + begin;
        const std::size_t count = end - begin;
        if (count <= kFew) {
            std::sort(first, first + count, less_);
            return;
        }
        const double scale = static_cast<double>(count);
        const auto part_of = [&](const Element& e) {
            const double in_bucket = place(e, buckets) - static_cast<double>(bucket);
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

    Share share_;
    Less less_;
};

}  // namespace realmodel
