// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/parallel.hpp"

#include <gtest/gtest.h>

#if defined(__linux__)
#include <pthread.h>
#include <sys/resource.h>
#include <unistd.h>
#endif

#include <functional>
#include <new>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include "realmodel/base/errors.hpp"

namespace realmodel {
namespace {

/// The loops that run chunks, alike to their callers.
using Loop = std::function<void(std::size_t count, const std::function<void(std::size_t)>& work)>;

std::vector<Loop> loops() {
    return {
        [](std::size_t count, const auto& work) {
            parallel_chunks(count, {3, nullptr}, work);
        },
        [](std::size_t count, const auto& work) {
            parallel_workers(count, {3, nullptr}, [&] { return work; });
        },
        [](std::size_t count, const auto& work) { parallel_even(count, 3, work); },
    };
}

TEST(Parallel, EveryChunkRunsOnce) {
    for (const Loop& loop : loops()) {
        for (const std::size_t count : {0, 1, 2, 3, 4, 1000}) {
            std::vector<int> runs(count, 0);
            loop(count, [&](std::size_t chunk) { ++runs[chunk]; });
            EXPECT_EQ(runs, std::vector<int>(count, 1));
        }
    }
}

TEST(Parallel, RangesCoverEverythingOnce) {
    for (const std::size_t count : {0, 1, 99, 100, 101, 1000}) {
        std::vector<int> seen(count, 0);
        parallel_ranges(count, 100, {3, nullptr}, [&](std::size_t begin, std::size_t end) {
            EXPECT_EQ(begin % 100, 0u);
            EXPECT_LE(end - begin, 100u);
            for (std::size_t i = begin; i < end; ++i)
                ++seen[i];
        });
        EXPECT_EQ(seen, std::vector<int>(count, 1));
    }
}

TEST(Parallel, TheErrorIsThatOfTheLowestFailedChunk) {
    for (const Loop& loop : loops()) {
        for (int repeat = 0; repeat < 20; ++repeat) {
            std::vector<int> runs(300, 0);
            try {
                loop(runs.size(), [&](std::size_t chunk) {
                    ++runs[chunk];
                    if (chunk == 140) std::this_thread::yield();
                    if (chunk >= 140 && chunk % 2 == 0)
                        throw std::runtime_error(std::to_string(chunk));
                });
                FAIL();
            } catch (const std::runtime_error& error) {
                EXPECT_STREQ(error.what(), "140");
            }
            // what comes before it has run in any case
            EXPECT_EQ(std::vector<int>(runs.begin(), runs.begin() + 141), std::vector<int>(141, 1));
        }
    }
}

TEST(Parallel, ChunksAboveAFailedOneAreSkipped) {
    std::atomic<std::size_t> runs{0};
    const auto fail = [&](std::size_t) {
        ++runs;
        throw std::bad_alloc();
    };
    EXPECT_THROW(parallel_chunks(1000000, {3, nullptr}, fail), std::bad_alloc);
    EXPECT_LE(runs, 3u);  // one by each thread
    EXPECT_THROW(parallel_even(1000000, 1, fail), std::bad_alloc);
    EXPECT_LE(runs, 4u);
}

TEST(Parallel, EachThreadHasAWorkerOfItsOwn) {
    std::atomic<int> workers{0};
    std::vector<const int*> scratch_of(1000);
    parallel_workers(scratch_of.size(), {3, nullptr}, [&] {
        ++workers;
        return [&, scratch = std::vector<int>(1, 0)](std::size_t chunk) mutable {
            EXPECT_EQ(scratch.front()++, 0);  // nobody else is using it
            scratch_of[chunk] = scratch.data();
            std::this_thread::yield();
            EXPECT_EQ(--scratch.front(), 0);
        };
    });
    EXPECT_GE(workers, 1);
    EXPECT_LE(workers, 3);
    EXPECT_EQ(std::count(scratch_of.begin(), scratch_of.end(), nullptr), 0);
}

TEST(Parallel, AWorkerThatCannotBeMadeFailsTheLoop) {
    const auto make = []() -> std::function<void(std::size_t)> { throw std::bad_alloc(); };
    EXPECT_THROW(parallel_workers(100, {3, nullptr}, make), std::bad_alloc);
    EXPECT_NO_THROW(parallel_workers(0, {3, nullptr}, make));
}

TEST(Parallel, StopsWhereItIsCancelled) {
    Progress progress;
    std::atomic<std::size_t> runs{0};
    const auto work = [&](std::size_t chunk) {
        ++runs;
        if (chunk == 5) progress.cancel();
        if (chunk == 6) throw std::runtime_error("the caller no longer wants to know");
    };
    EXPECT_THROW(parallel_chunks(1000000, {1, &progress}, work), Cancelled);
    EXPECT_EQ(runs, 6u);
    EXPECT_THROW(parallel_chunks(1000000, {3, &progress}, work), Cancelled);
    EXPECT_EQ(runs, 6u);
    EXPECT_THROW(poll(&progress, 0), Cancelled);
    EXPECT_NO_THROW(poll(&progress, 1));
}

TEST(Parallel, LongWorkMayAskForItself) {
    Progress progress;
    std::thread canceller([&] { progress.cancel(); });
    EXPECT_THROW(parallel_chunks(2, {2, &progress},
                                 [&](std::size_t) {
                                     for (;;)
                                         progress.check();
                                 }),
                 Cancelled);
    canceller.join();
}

TEST(Parallel, ChunksAreCountedIntoTheProgress) {
    Progress progress;
    progress.begin(0.2, 0.6, "half of it");
    parallel_chunks(
        8, {3, &progress}, [](std::size_t) {}, 0.5);
    EXPECT_DOUBLE_EQ(progress.fraction(), 0.4);
    parallel_ranges(
        800, 100, {3, &progress}, [](std::size_t, std::size_t) {}, 1.0);
    EXPECT_DOUBLE_EQ(progress.fraction(), 0.6);
}

#if defined(__linux__)

/// Ends a process of its own: 0 where loops and tasks ran, all of them.
[[noreturn]] void run_loops_and_exit() {
    std::atomic<int> runs{0};
    for (const int threads : {64, 3, 64, 1, 2, 96}) {
        parallel_chunks(100, {threads, nullptr}, [&](std::size_t) { ++runs; });
        parallel_tasks(10, {threads, nullptr}, 1.0, [&](std::size_t, const Execution& own) {
            parallel_chunks(10, own, [&](std::size_t) { ++runs; });
        });
    }
    std::_Exit(runs == 6 * 200 ? 0 : 1);
}

TEST(ParallelDeathTest, WhereThereAreNoThreadsToBeHadThisOneDoesTheWork) {
    GTEST_FLAG_SET(death_test_style, "threadsafe");
    EXPECT_EXIT(
        {
            pthread_attr_t attributes;  // a stack that no address space has room for
            pthread_attr_init(&attributes);
            pthread_attr_setstacksize(&attributes, std::size_t{1} << 47);
            pthread_setattr_default_np(&attributes);
            run_loops_and_exit();
        },
        testing::ExitedWithCode(0), "");
}

TEST(ParallelDeathTest, WhereThereAreFewThreadsToBeHadTheyDoTheWork) {
    if (geteuid() != 0) GTEST_SKIP() << "only root can become a user who has no other threads";
    GTEST_FLAG_SET(death_test_style, "threadsafe");
    EXPECT_EXIT(
        {
            rlimit most{};
            most.rlim_cur = most.rlim_max = 40;
            if (setuid(54321) != 0 || setrlimit(RLIMIT_NPROC, &most) != 0) std::_Exit(2);
            run_loops_and_exit();
        },
        testing::ExitedWithCode(0), "");
}

#endif

TEST(ParallelTasks, EachRunsOnceWithItsShare) {
    for (const int threads : {1, 2, 3, 8}) {
        for (const std::size_t count : {0, 1, 2, 5}) {
            Progress progress;
            std::vector<int> runs(count, 0);
            parallel_tasks(count, {threads, &progress}, 0.5,
                           [&](std::size_t task, const auto& own) {
                               ++runs[task];
                               const int at_once = std::min(threads, static_cast<int>(count));
                               EXPECT_EQ(own.threads,
                                         at_once == 1 ? threads : (2 * threads - 1) / at_once + 1);
                               std::atomic<int> inner{0};  // loops run in parallel within it
                               parallel_chunks(100, own, [&](std::size_t) { ++inner; });
                               EXPECT_EQ(inner, 100);
                           });
            EXPECT_EQ(runs, std::vector<int>(count, 1));
            EXPECT_NEAR(progress.fraction(), count == 0 ? 0.0 : 0.5, 1e-15);
        }
    }
}

TEST(ParallelTasks, TheErrorIsThatOfTheLowestAndThoseAboveItAreStopped) {
    std::atomic<int> begun{0}, stopped{0};
    try {
        parallel_tasks(3, {3, nullptr}, 1.0, [&](std::size_t task, const Execution& own) {
            if (task == 2) {
                ++begun;
                try {
                    for (;;)
                        own.progress->check();
                } catch (const Cancelled&) {
                    ++stopped;
                    throw;
                }
            }
            while ((task == 1 ? begun : stopped) == 0)  // the lowest still runs when another failed
                own.progress->check();
            if (task == 1) throw std::runtime_error("1");
            throw std::runtime_error("0");
        });
        FAIL();
    } catch (const std::runtime_error& error) {
        EXPECT_STREQ(error.what(), "0");
    }
    EXPECT_EQ(stopped, 1);
}

TEST(ParallelTasks, AllStopWithTheCaller) {
    Progress progress;
    EXPECT_THROW(parallel_tasks(2, {2, &progress}, 1.0,
                                [&](std::size_t, const Execution& own) {
                                    progress.cancel();
                                    for (;;)
                                        own.progress->check();
                                }),
                 Cancelled);
}

}  // namespace
}  // namespace realmodel
