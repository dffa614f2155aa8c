// SPDX-License-Identifier: GPL-3.0-or-later
#include "realmodel/base/version.hpp"

namespace realmodel {

const char* version() noexcept {
    return REALMODEL_VERSION;
}

}  // namespace realmodel
