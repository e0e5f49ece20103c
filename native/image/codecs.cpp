// SPDX-License-Identifier: GPL-3.0-or-later
#include "image/codecs.h"

#include "image/module.h"

namespace wardmis {

static const Module<CodecsInterface>& loaded() {
  static const auto module = loadModule<CodecsInterface>("wardmis_codecs.so", "wardmisCodecs", kCodecsVersion);
  return module;
}

const CodecsInterface& codecs() {
  static constexpr CodecsInterface kNone{};
  return loaded().interface ? *loaded().interface : kNone;
}

std::string codecMissing(const char* library) {
  return std::string("this command comes without ") + library +
         (loaded().interface ? ", which was not there when it was built" : ": " + loaded().problem);
}

}  // namespace wardmis
