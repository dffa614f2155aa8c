// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/parallel.hpp"

#include <chrono>
#include <deque>
#include <exception>
#include <latch>
#include <vector>

#include "realmodel/base/execution.hpp"

#if defined(_OPENMP) && defined(__linux__) && !defined(__clang__)
#define REALMODEL_GNU_OPENMP
#include <csignal>
#endif

#if defined(__linux__)
#include <sys/syscall.h>
#include <unistd.h>
#endif

namespace realmodel {

namespace {

std::mutex making_threads;  // held, so that no other call takes what one has found to be had

}  // namespace

void run_threads(int threads, const std::function<void(std::size_t rank)>& work) {
    const auto team = static_cast<std::size_t>(std::max(1, threads));
    std::vector<std::thread> others;
    others.reserve(team - 1);
    std::size_t rank = 1;
    try {
        const std::lock_guard lock(making_threads);
        for (; rank < team; ++rank)
            others.emplace_back(work, rank);
    } catch (const std::exception&) {
        // There are no more threads to be had: this one does their work.
    }
    work(0);
    for (; rank < team; ++rank)
        work(rank);
    for (std::thread& other : others)
        other.join();
}

#if defined(_OPENMP)

namespace {

/// Tries how many threads can run beside this one, of `wanted`, and waits until they have gone: the
/// system counts a thread for a little longer than join() takes.
int threads_to_be_had(int wanted) {
    std::vector<std::thread> tried;
    std::vector<long> numbers(static_cast<std::size_t>(wanted));
    std::latch end(1);
    try {
        tried.reserve(numbers.size());
        for (long& number : numbers) {
            tried.emplace_back([&end, &number] {
#if defined(__linux__)
                number = syscall(SYS_gettid);
#endif
                end.wait();
            });
        }
    } catch (const std::exception&) {
        // There are no more.
    }
    end.count_down();
    for (std::thread& thread : tried)
        thread.join();
#if defined(__linux__)
    for (const long number : numbers) {
        while (number > 0 && syscall(SYS_tgkill, getpid(), number, 0) == 0)
            std::this_thread::yield();
    }
#endif
    return static_cast<int>(tried.size());
}

thread_local int last_wanted = 1, last_team = 1;

}  // namespace

int team_size(int threads) {
    if (threads <= 1 || omp_in_parallel() != 0) return 1;
    // OpenMP keeps the threads of a team for the next one, but ends those that this has no use for.
    if (threads > last_wanted) {
        const std::lock_guard lock(making_threads);
        last_team = 1 + threads_to_be_had(threads - 1);
#pragma omp parallel num_threads(last_team) if (last_team > 1)
        {}  // makes them
    } else {
        last_team = std::min(threads, last_team);
    }
    last_wanted = threads;
    return last_team;
}

#else

namespace {

thread_local bool in_team = false;

}  // namespace

void run_team(int threads, const std::function<void(std::size_t rank, std::size_t team)>& work) {
    if (threads <= 1 || in_team) return work(0, 1);
    run_threads(threads, [&](std::size_t rank) {
        in_team = true;
        work(rank, static_cast<std::size_t>(threads));
        in_team = false;
    });
}

#endif

void keep_waiting_threads_asleep() {
#if defined(REALMODEL_GNU_OPENMP)
    // once; not by std::call_once, whose thread-local data bpy leaves no place for
    [[maybe_unused]] static const bool is_done = [] {
        const std::lock_guard lock(making_threads);
        if (threads_to_be_had(2) < 2) return false;
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

void parallel_tasks(
    std::size_t count, const Execution& execution, double share,
    const std::function<void(std::size_t task, const Execution& task_execution)>& work) {
    const int all = thread_count(execution.threads);
    const int at_once = static_cast<int>(std::min(count, static_cast<std::size_t>(all)));
    // Twice as many threads as there are: while one task keeps one busy, another uses the rest.
    const int threads = at_once > 1 ? (2 * all + at_once - 1) / at_once : all;
    std::deque<Progress> progress;
    for (std::size_t task = 0; task < count; ++task)
        progress.emplace_back(execution.progress, share / static_cast<double>(count));
    const auto run = [&](std::size_t task) {
        try {
            work(task, {threads, &progress[task], execution.device});
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
