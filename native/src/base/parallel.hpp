// SPDX-License-Identifier: GPL-3.0-or-later
/// The parallel loops of the whole core. No exception leaves a thread: where chunks of a
/// loop throw, the exception of the lowest of them leaves the loop, so that the same input always
/// gives the same error. Chunks above a failed one are skipped, those below it still run. Between
/// chunks a loop asks whether it was cancelled; longer work may call Progress::check() itself.
#pragma once

#if defined(_OPENMP)
#include <omp.h>
#endif

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <exception>
#include <functional>
#include <mutex>
#include <optional>
#include <thread>

#include "realmodel/base/execution.hpp"

namespace realmodel {

inline int thread_count(int threads) {
    if (threads > 0) return threads;
#if defined(_OPENMP)
    return omp_get_max_threads();
#else
    return std::max(1, static_cast<int>(std::thread::hardware_concurrency()));
#endif
}

/// Calls work(rank, team) at once for every rank below team, which is `threads`, or less where
/// there are not so many threads to be had; inside of such a call it is 1. The work must not throw.
#if defined(_OPENMP)
/// How many of `threads` may work in a region of OpenMP, which ends the process where it cannot get
/// a thread that it wants: whenever this thread's team grows, as many are tried first.
int team_size(int threads);

template <class Work>
void run_team(int threads, const Work& work) {
    const int size = team_size(threads);
#pragma omp parallel num_threads(size) if (size > 1)
    work(static_cast<std::size_t>(omp_get_thread_num()),
         static_cast<std::size_t>(omp_get_num_threads()));
}
#else  // with threads of the C++ library
void run_team(int threads, const std::function<void(std::size_t rank, std::size_t team)>& work);
#endif

/// Calls work(rank) at once for every rank below `threads`, on threads of the C++ library, made
/// anew for every call. Where there are not so many to be had, this one does the work of several.
/// The work must not throw.
void run_threads(int threads, const std::function<void(std::size_t rank)>& work);

/// For loops of one thread: asks every 16384 rounds whether the caller wants to stop.
/// @throws Cancelled
inline void poll(Progress* progress, std::size_t round) {
    if (progress != nullptr && (round & 0x3fff) == 0) progress->check();
}

/// Begins a part of the work, where somebody watches it (Progress::begin).
inline void begin_phase(Progress* progress, double start, double end, const char* text) {
    if (progress != nullptr) progress->begin(start, end, text);
}

/// What the threads of one loop share: how far it is, and the error of its lowest failed chunk.
class LoopGuard {
public:
    LoopGuard(Progress* progress, std::size_t count, double share)
        : progress_(progress), counted_(progress, count, share) {}

    /// Runs a chunk, unless the loop was cancelled or a chunk before this one has failed.
    /// @return whether later chunks may still be wanted
    template <class Work>
    bool run(std::size_t chunk, Work&& work) noexcept {
        if (chunk > failed_chunk_.load(std::memory_order_relaxed)) return false;
        if (progress_ != nullptr && progress_->cancelled()) return false;
        try {
            work();
            counted_.count();
        } catch (...) {
            const std::lock_guard lock(failing_);
            if (chunk < failed_chunk_.load(std::memory_order_relaxed)) {
                failed_chunk_.store(chunk, std::memory_order_relaxed);
                failure_ = std::current_exception();
            }
        }
        return true;
    }

    /// To be called after the region.
    /// @throws Cancelled, or the exception of the lowest failed chunk
    void finish() const {
        if (progress_ != nullptr) progress_->check();
        if (failure_) std::rethrow_exception(failure_);
    }

private:
    Progress* progress_;
    CountedLoop counted_;
    std::atomic<std::size_t> failed_chunk_{SIZE_MAX};
    std::mutex failing_;
    std::exception_ptr failure_;
};

/// Calls worker(chunk) for every chunk from 0 to count - 1, on several threads, the next chunk to
/// whichever thread is free. Each thread has a worker of its own (with its scratch memory), which
/// make() gives when the thread gets its first chunk.
/// @param share  of what is left of the present part of the progress: how much this loop takes
/// @throws Cancelled, or what make() or a worker threw
template <class Make>
void parallel_workers(std::size_t count, const Execution& execution, const Make& make,
                      double share = 0.2) {
    LoopGuard guard(execution.progress, count, share);
    std::atomic<std::size_t> next{0};
    run_team(count > 1 ? thread_count(execution.threads) : 1, [&](std::size_t, std::size_t) {
        std::optional<decltype(make())> worker;
        for (;;) {
            const std::size_t chunk = next.fetch_add(1, std::memory_order_relaxed);
            const bool goes_on = chunk < count && guard.run(chunk, [&] {
                if (!worker) worker.emplace(make());
                (*worker)(chunk);
            });
            if (!goes_on) break;
        }
    });
    guard.finish();
}

/// Calls work(chunk) for every chunk, as parallel_workers() without anything of a thread's own.
template <class Work>
void parallel_chunks(std::size_t count, const Execution& execution, const Work& work,
                     double share = 0.2) {
    const auto make = [&work] { return [&work](std::size_t chunk) { work(chunk); }; };
    parallel_workers(count, execution, make, share);
}

/// Calls work(begin, end) for ranges of `size` items that cover 0 to count - 1.
template <class Work>
void parallel_ranges(std::size_t count, std::size_t size, const Execution& execution,
                     const Work& work, double share = 0.2) {
    const auto range = [&](std::size_t chunk) {
        work(chunk * size, std::min(count, (chunk + 1) * size));
    };
    parallel_chunks((count + size - 1) / size, execution, range, share);
}

/// Calls work(i) for every item from 0 to count - 1, many of them in a chunk: work is short.
template <class Work>
void parallel_for_each(std::size_t count, const Execution& execution, const Work& work) {
    parallel_ranges(count, 1 << 10, execution, [&work](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i)
            work(i);
    });
}

/// Calls work(chunk) for every chunk, each thread an equal run of them: in loops over the same
/// arrays a thread meets again what its caches still hold. For chunks of equal work, too short for
/// anyone to wait for one.
template <class Work>
void parallel_even(std::size_t count, int threads, const Work& work) {
    LoopGuard guard(nullptr, count, 0.0);
    run_team(count > 1 ? thread_count(threads) : 1, [&](std::size_t rank, std::size_t team) {
        for (std::size_t chunk = count * rank / team; chunk < count * (rank + 1) / team; ++chunk) {
            if (!guard.run(chunk, [&] { work(chunk); })) break;
        }
    });
    guard.finish();
}

/// Calls work(task, execution) for few long tasks that run in parallel themselves, several of them
/// at once where the threads allow it, each with a share of the threads. Each task goes through a
/// progress of its own, from 0 to 1, which takes that of the caller on by its part of `share`.
/// Where tasks throw, what the lowest of them threw leaves the loop; those above it are stopped,
/// those below it still run.
/// @param share  of the whole progress: how much all tasks take
/// @throws Cancelled, or what the work threw
void parallel_tasks(
    std::size_t count, const Execution& execution, double share,
    const std::function<void(std::size_t task, const Execution& task_execution)>& work);

}  // namespace realmodel
