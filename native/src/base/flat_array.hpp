// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "realmodel/base/array.hpp"
