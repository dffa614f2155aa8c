// SPDX-License-Identifier: GPL-3.0-or-later
// Work on many nodes by several threads. Private.
#pragma once

#include <omp.h>

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <exception>
#include <mutex>
#include <optional>

#include "realmodel/base/progress.hpp"

namespace realmodel::interpolation {

inline int thread_count(int threads) {
    return threads > 0 ? threads : omp_get_max_threads();
}

/// Says whether parallel work should end early; may be asked by any thread.
class StopSign {
public:
    explicit StopSign(const Progress* progress) : progress_(progress) {}
    bool operator()() const {
        return failed_.load(std::memory_order_relaxed) ||
               (progress_ != nullptr && progress_->cancelled());
    }
    void fail() { failed_.store(true, std::memory_order_relaxed); }

private:
    const Progress* progress_;
    std::atomic<bool> failed_{false};
};

/// Runs work on [0, count) in pieces of `chunk`: each thread makes one worker by make(stop) and
/// calls worker(begin, end) for the pieces that fall to it. Which thread does a piece must not
/// matter to the result. A worker asks `stop` in long pieces and returns when told to. Progress
/// goes from `begin_share` to 1. What a worker throws leaves this function; so does Cancelled.
template <class Make>
void for_chunks(std::size_t count, std::size_t chunk, int threads, Progress* progress,
                double begin_share, const char* text, Make&& make) {
    const auto pieces = static_cast<std::ptrdiff_t>((count + chunk - 1) / chunk);
    StopSign stop(progress);
    std::atomic<std::ptrdiff_t> done{0};
    std::exception_ptr thrown;
    std::mutex thrown_mutex;
    const auto guarded = [&](auto&& run) {
        try {
            run();
        } catch (...) {
            const std::lock_guard lock(thrown_mutex);
            if (!thrown) thrown = std::current_exception();
            stop.fail();
        }
    };
    const int team = static_cast<int>(
        std::clamp<std::ptrdiff_t>(pieces, 1, static_cast<std::ptrdiff_t>(thread_count(threads))));
#pragma omp parallel num_threads(team)
    {
        using Worker = decltype(make(stop));
        std::optional<Worker> worker;
        guarded([&] { worker.emplace(make(stop)); });
#pragma omp for schedule(dynamic)
        for (std::ptrdiff_t piece = 0; piece < pieces; ++piece) {
            if (stop() || !worker) continue;
            guarded([&] {
                const std::size_t begin = static_cast<std::size_t>(piece) * chunk;
                (*worker)(begin, std::min(begin + chunk, count));
            });
            const auto finished = static_cast<double>(++done);
            if (progress != nullptr) {
                progress->report(
                    begin_share + (1 - begin_share) * finished / static_cast<double>(pieces), text);
            }
        }
    }
    if (thrown) std::rethrow_exception(thrown);
    if (progress != nullptr) progress->check();
}

}  // namespace realmodel::interpolation
