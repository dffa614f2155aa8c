// SPDX-License-Identifier: GPL-3.0-or-later
// Tests that repeat themselves do it less often under sanitizers, where each time takes ten times
// as long: the other builds judge every result, and what sanitizers look for is on paths that fewer
// repetitions take as well.
#pragma once

namespace realmodel {

#ifdef REALMODEL_SANITIZED
constexpr bool kSanitized = true;
#else
constexpr bool kSanitized = false;
#endif

}  // namespace realmodel
