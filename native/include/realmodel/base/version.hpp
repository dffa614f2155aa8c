// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

namespace realmodel {

/// Version of the program, as in the file VERSION, e.g. "0.1.0".
const char* version() noexcept;

}  // namespace realmodel
