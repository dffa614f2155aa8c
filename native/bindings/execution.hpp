// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <pybind11/pybind11.h>

#include "realmodel/base/execution.hpp"
#include "realmodel/base/memory.hpp"

namespace realmodel::bindings {

/// What Python knows as Execution: a call's number of threads, its device, and its progress, which
/// another thread of Python watches.
struct WatchedExecution {
    int threads = 0;
    pybind11::object device;  ///< what `functions` belong to, or None
    const Device* functions = nullptr;
    Progress progress;
};

/// How a call is run; null: on all threads, and nobody watches.
inline Execution run(WatchedExecution* execution) {
    return execution == nullptr
               ? Execution{}
               : Execution{execution->threads, &execution->progress, execution->functions};
}

/// When the work is done, refused or cancelled, what it had is the system's again.
struct MemoryRelease {
    MemoryRelease() = default;
    MemoryRelease(const MemoryRelease&) = delete;
    MemoryRelease& operator=(const MemoryRelease&) = delete;
    ~MemoryRelease() { give_back_memory(); }
};

/// What a call gives, which runs without the lock of the interpreter.
template <class Call>
auto unlocked(const Call& call) {
    const pybind11::gil_scoped_release release;
    return call();
}

}  // namespace realmodel::bindings
