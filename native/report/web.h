// SPDX-License-Identifier: GPL-3.0-or-later
// The parts of the page, native/report/web/, compiled in.
#pragma once

#include <string_view>

namespace wardmis::web {

extern const std::string_view kPage, kStyle, kScript, kPlotly;

}  // namespace wardmis::web
