// SPDX-License-Identifier: GPL-3.0-or-later
#if !defined(_OPENMP)

#include "base/parallel.hpp"

#include <exception>
#include <vector>

namespace realmodel {

namespace {

thread_local bool in_team = false;

}  // namespace

void run_team(int threads, const std::function<void(std::size_t own, std::size_t team)>& work) {
    if (threads <= 1 || in_team) return work(0, 1);
    const auto team = static_cast<std::size_t>(threads);
    const auto run = [&](std::size_t own) {
        in_team = true;
        work(own, team);
        in_team = false;
    };
    std::vector<std::thread> others;
    others.reserve(team - 1);
    std::size_t own = 1;
    try {
        for (; own < team; ++own)
            others.emplace_back(run, own);
    } catch (const std::exception&) {
        // There are no more threads to be had: this one does their work.
    }
    run(0);
    for (; own < team; ++own)
        run(own);
    for (std::thread& other : others)
        other.join();
}

}  // namespace realmodel

#endif
