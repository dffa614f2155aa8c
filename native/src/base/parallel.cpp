// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/parallel.hpp"

#include <chrono>
#include <deque>
#include <exception>
#include <vector>

#include "realmodel/base/execution.hpp"

#if defined(_OPENMP) && defined(__linux__) && !defined(__clang__)
#define REALMODEL_GNU_OPENMP
#include <csignal>
#endif

namespace realmodel {

void run_threads(int threads, const std::function<void(std::size_t own)>& work) {
    const auto team = static_cast<std::size_t>(std::max(1, threads));
    std::vector<std::thread> others;
    others.reserve(team - 1);
    std::size_t own = 1;
    try {
        for (; own < team; ++own)
            others.emplace_back(work, own);
    } catch (const std::exception&) {
        // There are no more threads to be had: this one does their work.
    }
    work(0);
    for (; own < team; ++own)
        work(own);
    for (std::thread& other : others)
        other.join();
}

#if !defined(_OPENMP)

namespace {

thread_local bool in_team = false;

}  // namespace

void run_team(int threads, const std::function<void(std::size_t own, std::size_t team)>& work) {
    if (threads <= 1 || in_team) return work(0, 1);
    run_threads(threads, [&](std::size_t own) {
        in_team = true;
        work(own, static_cast<std::size_t>(threads));
        in_team = false;
    });
}

#endif

void keep_waiting_threads_asleep() {
#if defined(REALMODEL_GNU_OPENMP)
    // once; not by std::call_once, whose thread-local data bpy leaves no place for
    [[maybe_unused]] static const bool is_done = [] {
        sigset_t all, before;  // signals are for the threads that were there
        sigfillset(&all);
        pthread_sigmask(SIG_SETMASK, &all, &before);
        std::thread([] {
#pragma omp parallel num_threads(2)
            for (;;)
                std::this_thread::sleep_for(std::chrono::hours(24));
        }).detach();
        pthread_sigmask(SIG_SETMASK, &before, nullptr);
        return true;
    }();
#endif
}

void parallel_tasks(std::size_t count, const Execution& execution, double share,
                    const std::function<void(std::size_t task, const Execution& own)>& work) {
    const int all = thread_count(execution.threads);
    const int at_once = static_cast<int>(std::min(count, static_cast<std::size_t>(all)));
    // Twice as many threads as there are: while one task keeps one busy, another uses the rest.
    const int threads = at_once > 1 ? (2 * all + at_once - 1) / at_once : all;
    std::deque<Progress> progress;
    for (std::size_t task = 0; task < count; ++task)
        progress.emplace_back(execution.progress, share / static_cast<double>(count));
    const auto run = [&](std::size_t task) {
        try {
            work(task, {threads, &progress[task]});
            progress[task].report(1.0, nullptr);
        } catch (...) {
            for (std::size_t later = task + 1; later < count; ++later)
                progress[later].cancel();
            throw;
        }
    };
    LoopGuard guard(nullptr, count, 0.0);
    std::atomic<std::size_t> next{0};
    run_threads(at_once, [&](std::size_t) {
        for (std::size_t task = next.fetch_add(1); task < count; task = next.fetch_add(1)) {
            if (!guard.run(task, [&] { run(task); })) break;
        }
    });
    if (execution.progress != nullptr) execution.progress->check();
    guard.finish();
}

}  // namespace realmodel
