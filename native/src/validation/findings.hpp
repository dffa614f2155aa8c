// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdio>
#include <string>
#include <vector>

#include "base/parallel.hpp"
#include "realmodel/validation/findings.hpp"

namespace realmodel::validation {

/// A number as findings give it.
inline std::string figure(double value) {
    char text[32];
    std::snprintf(text, sizeof text, "%.9g", value);
    return text;
}

/// Items looked at by one thread at a time: fixed, so that findings do not depend on the threads.
inline constexpr std::size_t kItemsOfChunk = 8192;

/// Calls work(begin, end, findings) for chunks of 0 .. count on several threads; what is found in
/// all chunks, in order.
template <class Result = Findings, class Work>
Result in_chunks(std::size_t count, const Execution& execution, const Work& work,
                 std::size_t size = kItemsOfChunk) {
    std::vector<Result> chunks((count + size - 1) / size);
    parallel_ranges(count, size, execution, [&](std::size_t begin, std::size_t end) {
        work(begin, end, chunks[begin / size]);
    });
    Result all;
    for (const Result& chunk : chunks)
        all.append(chunk);
    return all;
}

/// Calls look(item, findings) for all items in chunks.
template <class Look>
Findings examine_all(std::size_t count, const Execution& execution, const Look& look) {
    return in_chunks(count, execution, [&](std::size_t begin, std::size_t end, Findings& findings) {
        for (std::size_t i = begin; i < end; ++i)
            look(i, findings);
    });
}

}  // namespace realmodel::validation
