// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <cassert>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "base/parallel_counts.hpp"
#include "realmodel/base/array.hpp"

namespace realmodel {

/// Values by buckets, those of one bucket side by side.
template <class Value>
struct Buckets {
    Array<std::uint32_t> offsets{0};  ///< before each bucket, and the number of all values
    Array<Value> values;

    std::size_t size() const { return offsets.size() - 1; }
    std::span<const Value> operator[](std::size_t bucket) const {
        assert(bucket < size());
        return {values.data() + offsets[bucket], values.data() + offsets[bucket + 1]};
    }
    std::span<Value> operator[](std::size_t bucket) {
        assert(bucket < size());
        return {values.data() + offsets[bucket], values.data() + offsets[bucket + 1]};
    }
};

/// A counting sort. produce(put) calls put(bucket, value) for all values; it is called twice and
/// must do the same both times. Values keep their order within a bucket.
/// @throws InputError kind too_large, where there are 2^32 values or more
template <class Value, class Produce>
Buckets<Value> bucketize(std::size_t buckets, const Produce& produce) {
    Buckets<Value> made;
    // counted one bucket later, so that each entry of the offsets can move on to the next bucket
    made.offsets.assign(buckets + 2, 0);
    std::size_t total = 0;
    produce([&](std::size_t bucket, const Value&) {
        assert(bucket < buckets);
        ++made.offsets[bucket + 1];
        ++total;
    });
    check_total(total, UINT32_MAX);
    std::uint32_t before = 0;
    for (std::uint32_t& offset : made.offsets)
        before += std::exchange(offset, before);
    made.values.resize(total);
    produce([&](std::size_t bucket, const Value& value) {
        made.values[made.offsets[bucket + 1]++] = value;
    });
    made.offsets.pop_back();
    return made;
}

/// The same on several threads, for many buckets: produce(chunk, put) puts the values of a chunk.
/// The order of values within a bucket is left to chance: nothing that is kept may depend on it.
/// @throws InputError kind too_large, Cancelled
template <class Value, class Produce>
Buckets<Value> bucketize_in_any_order(std::size_t buckets, std::size_t chunks,
                                      const Produce& produce, const Execution& execution) {
    Buckets<Value> made;
    made.offsets = zeros<std::uint32_t>(buckets + 2, execution);
    parallel_chunks(chunks, execution, [&](std::size_t chunk) {
        produce(chunk, [&](std::size_t bucket, const Value&) {
            assert(bucket < buckets);
            atomic_increment(made.offsets[bucket + 1]);
        });
    });
    running_totals(made.offsets, UINT32_MAX, execution);
    made.values.resize(made.offsets.back());
    parallel_chunks(chunks, execution, [&](std::size_t chunk) {
        produce(chunk, [&](std::size_t bucket, const Value& value) {
            made.values[atomic_increment(made.offsets[bucket + 1])] = value;
        });
    });
    made.offsets.pop_back();
    return made;
}

/// The same for few buckets, with values in the order of chunks, and within a chunk in that of
/// put(): each chunk counts for itself.
/// @throws InputError kind too_large, Cancelled
template <class Value, class Produce>
Buckets<Value> bucketize_in_order(std::size_t buckets, std::size_t chunks, const Produce& produce,
                                  const Execution& execution, double share = 0.2) {
    std::vector<std::vector<std::uint32_t>> next(chunks);
    parallel_chunks(
        chunks, execution,
        [&](std::size_t chunk) {
            next[chunk].resize(buckets);
            std::uint32_t* const count = next[chunk].data();
            produce(chunk, [count](std::size_t bucket, const Value&) { ++count[bucket]; });
        },
        share);
    Buckets<Value> made;
    made.offsets.reserve(buckets + 1);
    std::size_t total = 0;
    for (std::size_t b = 0; b < buckets; ++b) {
        for (auto& of_chunk : next)
            total += std::exchange(of_chunk[b], static_cast<std::uint32_t>(total));
        check_total(total, UINT32_MAX);
        made.offsets.push_back(static_cast<std::uint32_t>(total));
    }
    made.values.resize(total);
    parallel_chunks(
        chunks, execution,
        [&](std::size_t chunk) {
            std::uint32_t* const to = next[chunk].data();
            Value* const values = made.values.data();
            produce(chunk, [to, values](std::size_t bucket, const Value& value) {
                values[to[bucket]++] = value;
            });
            next[chunk] = {};
        },
        share);
    return made;
}

/// Sorts by buckets, and within a bucket by <, on several threads: of buckets that hold a handful,
/// in time that is linear. Equal values must be alike, for their order is not kept.
/// @throws InputError kind too_large, Cancelled
template <class Value, class Produce>
Buckets<Value> sorted_in_buckets(std::size_t buckets, std::size_t chunks, const Produce& produce,
                                 const Execution& execution) {
    Buckets<Value> made = bucketize_in_any_order<Value>(buckets, chunks, produce, execution);
    parallel_for_each(buckets, execution,
                      [&](std::size_t b) { std::sort(made[b].begin(), made[b].end()); });
    return made;
}

}  // namespace realmodel
