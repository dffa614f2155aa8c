// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <cassert>
#include <cstddef>

#include "base/parallel.hpp"

namespace realmodel::interpolation {

/// Whether long work should end early; from any thread.
inline bool cancelled(Progress* progress) {
    return progress != nullptr && progress->cancelled();
}

/// A loop over many nodes by several threads.
struct NodeLoop {
    std::size_t count;
    std::size_t chunk;  ///< nodes that one thread does in a row
    Execution execution;
    const char* text = nullptr;  ///< what is being done; null keeps the text that was there
    double begin = 0, end = 1;   ///< the fractions of the progress; equal: it is not moved

    /// Calls work(scratch, begin, end) for chunks of nodes; `scratch` is the thread's object, as
    /// make() gives it: which thread does a chunk must not matter to the result. Long work asks
    /// cancelled() and returns then.
    /// @throws Cancelled, and what work or make throws for the lowest chunk
    template <class Make, class Work>
    void over_chunks(const Make& make, const Work& work) const {
        assert(chunk > 0);
        if (begin < end) begin_phase(execution.progress, begin, end, text);
        const auto worker = [&] {
            return [&, scratch = make()](std::size_t number) mutable {
                work(scratch, number * chunk, std::min(count, (number + 1) * chunk));
            };
        };
        parallel_workers((count + chunk - 1) / chunk, execution, worker, begin < end ? 1.0 : 0.0);
    }

    /// Calls work(scratch, node) for each node, until the caller cancels.
    template <class Make, class Work>
    void over_nodes(const Make& make, const Work& work) const {
        over_chunks(make, [&](auto& scratch, std::size_t from, std::size_t to) {
            for (std::size_t node = from; node < to && !cancelled(execution.progress); ++node)
                work(scratch, node);
        });
    }
};

}  // namespace realmodel::interpolation
