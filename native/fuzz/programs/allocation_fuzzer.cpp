// SPDX-License-Identifier: GPL-3.0-or-later
// Small builds of each kind while allocations fail, taken at random; scripts/fuzz.sh runs it.
//
//   allocation_fuzzer [--seconds S] [--seed K]      seeds from K on
//
// Each build of a seed is judged in a process of its own. It is made, or says that there is no
// memory; a crash, another error and another result are findings. The exit status is 1 where there
// is one.
#include <sys/mman.h>

#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <new>

#include "allocations/failing_allocations.hpp"
#include "examination.hpp"
#include "random_source.hpp"
#include "small_builds.hpp"

namespace {

using namespace realmodel::fuzz;

constexpr int kTries = 60;         ///< of each build
constexpr double kPatience = 300;  ///< seconds of processors for a build

struct Try {
    int threads = 0;
    std::uint64_t number = 0;  ///< of the allocation that fails
    bool and_later = false;
};

/// "" where a build is made or says that there is no memory.
std::string ending(const SmallBuild& build, const Try& now, std::uint64_t expected) {
    try {
        const FailingAllocations failing(now.number, now.and_later);
        if (build.digest(now.threads) != expected) return "another result";
    } catch (const std::bad_alloc&) {
        // as it should
    } catch (const std::exception& error) {
        return error.what();
    }
    try {
        return build.digest(now.threads) == expected ? "" : "another result afterwards";
    } catch (const std::exception& error) {
        return std::string("afterwards: ") + error.what();
    }
}

/// @param now  shared with the process that watches: which try is in work
std::vector<Defect> judge(const SmallBuild& build, RandomSource random, Try& now) {
    std::uint64_t expected = 0;
    try {
        expected = build.digest(1);
    } catch (const std::exception&) {
        return {};  // refused, as some random input is
    }
    for (int i = 0; i < kTries; ++i) {
        const int threads = 1 + static_cast<int>(random.below(4));
        const bool and_later = random.below(2) == 1;
        std::uint64_t count = 0;
        {
            const FailingAllocations none(UINT64_MAX, false);
            build.digest(threads);
            count = none.count();
        }
        const std::uint64_t number = 1 + random.below(count);
        now = {threads, number, and_later};
        const std::string ended = ending(build, now, expected);
        if (!ended.empty()) return {{build.name, ended}};
    }
    return {};
}

}  // namespace

int main(int count, char** arguments) {
    setenv("OMP_WAIT_POLICY", "passive", 0);  // small builds on busy processors: no spinning
    double seconds = 10;
    std::uint64_t seed = 1;
    for (int i = 1; i + 1 < count; i += 2) {
        if (std::strcmp(arguments[i], "--seconds") == 0) {
            seconds = std::strtod(arguments[i + 1], nullptr);
        } else if (std::strcmp(arguments[i], "--seed") == 0) {
            seed = std::strtoull(arguments[i + 1], nullptr, 10);
        } else {
            count = 0;
        }
    }
    if (count % 2 == 0) {
        std::fputs("usage: allocation_fuzzer [--seconds S] [--seed K]\n", stderr);
        return 2;
    }
    void* memory =
        mmap(nullptr, sizeof(Try), PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
    if (memory == MAP_FAILED) {
        std::fputs("allocation_fuzzer: no shared memory\n", stderr);
        return 2;
    }
    Try& now = *new (memory) Try;
    const auto start = std::chrono::steady_clock::now();
    const auto spent = [start] {
        return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    };
    std::uint64_t judged = 0, findings = 0;
    for (; spent() < seconds; ++seed, ++judged) {
        for (const SmallBuild& build : small_builds(seed)) {
            const auto defects =
                in_a_process([&] { return judge(build, RandomSource(seed), now); }, kPatience);
            for (const Defect& defect : defects) {
                std::printf("seed %llu, %s, allocation %llu%s of %d threads: %s\n",
                            static_cast<unsigned long long>(seed), build.name.c_str(),
                            static_cast<unsigned long long>(now.number),
                            now.and_later ? " and later" : "", now.threads,
                            defect.sentence.c_str());
                std::fflush(stdout);
            }
            findings += defects.size();
        }
    }
    std::printf("%llu seeds, %llu findings\n", static_cast<unsigned long long>(judged),
                static_cast<unsigned long long>(findings));
    return findings > 0 ? 1 : 0;
}
