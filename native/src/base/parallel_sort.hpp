// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <vector>

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

}  // namespace realmodel
