// SPDX-License-Identifier: GPL-3.0-or-later
// Operations that are patterns.
#pragma once

#include "program/operands.h"

namespace wardmis::patterns {

void run(Operation operation, const Operands& o);

}  // namespace wardmis::patterns
