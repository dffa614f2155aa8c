// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "realmodel/base/progress.hpp"

namespace realmodel {

/// How a computation runs: on how many threads, and who watches and may cancel it.
struct Execution {
    int threads = 0;               ///< 0: as many as there are; no result depends on it
    Progress* progress = nullptr;  ///< null: nobody watches
};

}  // namespace realmodel
