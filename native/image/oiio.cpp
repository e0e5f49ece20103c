// SPDX-License-Identifier: GPL-3.0-or-later
#include "image/oiio.h"

#include <stdexcept>

#include "image/module.h"

namespace wardmis {

const OiioInterface& oiio() {
  static const auto loaded = loadModule<OiioInterface>("wardmis_oiio.so", "wardmisOiio", kOiioVersion);
  if (!loaded.interface) throw std::runtime_error("this command comes without OpenImageIO: " + loaded.problem);
  return *loaded.interface;
}

}  // namespace wardmis
