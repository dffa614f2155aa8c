// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <omp.h>

#include <atomic>
#include <cstdint>
#include <exception>

#include "realmodel/base/progress.hpp"

namespace realmodel {

inline int thread_count(int threads) {
    return threads > 0 ? threads : omp_get_max_threads();
}

/// For loops of one thread: asks every 16384 rounds whether the caller wants to stop.
/// @throws Cancelled
inline void poll(const Progress* progress, std::size_t round) {
    if (progress != nullptr && (round & 0x3fff) == 0) progress->check();
}

/// Calls work(chunk) for every chunk from 0 to count - 1 on several threads, or until the caller
/// cancels. Where chunks throw, the others still run and the exception of the lowest of them leaves
/// here, so that the same input always gives the same error. Chunks are counted into the progress:
/// `share` is how much of what is left of its present part this loop is expected to take.
template <class Work>
void parallel_chunks(std::size_t count, int threads, const Progress* progress, const Work& work,
                     double share = 0.2) {
    CountedLoop counted(progress, count, share);
    std::atomic<bool> stop{false};
    std::exception_ptr failure;
    std::int64_t failed_chunk = INT64_MAX;
#pragma omp parallel for schedule(dynamic, 1) num_threads(thread_count(threads)) if (count > 1)
    for (std::int64_t chunk = 0; chunk < static_cast<std::int64_t>(count); ++chunk) {
        if (stop.load(std::memory_order_relaxed)) continue;
        if (progress != nullptr && progress->cancelled()) {
            stop.store(true, std::memory_order_relaxed);
            continue;
        }
        try {
            work(static_cast<std::size_t>(chunk));
            counted.count();
        } catch (...) {
#pragma omp critical(realmodel_parallel_chunks_failure)
            if (chunk < failed_chunk) {
                failed_chunk = chunk;
                failure = std::current_exception();
            }
        }
    }
    if (progress != nullptr) progress->check();
    if (failure) std::rethrow_exception(failure);
}

}  // namespace realmodel
