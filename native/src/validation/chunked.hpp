// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <vector>

#include "base/parallel.hpp"
#include "realmodel/validation/findings.hpp"

namespace realmodel::validation {

/// Items looked at by one thread at a time: fixed, so that findings do not depend on the threads.
inline constexpr std::size_t kItemsOfChunk = 8192;

/// Calls work(begin, end, findings) for chunks of 0 .. count on several threads; the findings of
/// all chunks, in order.
template <class Work>
Findings in_chunks(std::size_t count, const Execution& execution, const Work& work) {
    const std::size_t chunks = (count + kItemsOfChunk - 1) / kItemsOfChunk;
    std::vector<Findings> found(chunks);
    parallel_chunks(chunks, execution, [&](std::size_t chunk) {
        work(chunk * kItemsOfChunk, std::min(count, (chunk + 1) * kItemsOfChunk), found[chunk]);
    });
    Findings all;
    for (const Findings& part : found)
        all.append(part);
    return all;
}

}  // namespace realmodel::validation
