// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "realmodel/base/progress.hpp"

namespace realmodel {

struct Device;

/// How a computation runs: on how many threads, who watches and may cancel it, and whether a device
/// helps.
struct Execution {
    int threads = 0;                 ///< 0: as many as there are; no result depends on it
    Progress* progress = nullptr;    ///< null: nobody watches
    const Device* device = nullptr;  ///< null: none; no result depends on it
};

/// Has the threads of GNU's OpenMP library sleep soon while they have nothing to do, in a process
/// that loaded it before its environment said so (OMP_WAIT_POLICY). They spin only while there are
/// no more of them than processors: from now on there is one more, which sleeps.
void keep_waiting_threads_asleep();

}  // namespace realmodel
