// SPDX-License-Identifier: GPL-3.0-or-later
#include "image/oiio.h"

#include <dlfcn.h>

#include <filesystem>
#include <stdexcept>
#include <string>

namespace wardmis {
namespace {

struct Loaded {
  const OiioInterface* interface = nullptr;
  std::string problem = "wardmis_oiio.so does not lie beside it";
};

Loaded load() {
  std::error_code unreadable;
  const auto folder = std::filesystem::read_symlink("/proc/self/exe", unreadable).parent_path();
  for (const auto& file : {folder / "wardmis_oiio.so", folder.parent_path() / "lib" / "wardmis" / "wardmis_oiio.so"}) {
    if (std::error_code error; !std::filesystem::exists(file, error)) continue;
    void* module = dlopen(file.c_str(), RTLD_NOW | RTLD_LOCAL);
    if (!module) return {nullptr, dlerror()};
    const auto get = reinterpret_cast<decltype(&wardmisOiio)>(dlsym(module, "wardmisOiio"));
    if (!get || get()->version != kOiioVersion)
      return {nullptr, file.string() + " belongs to another version of the command"};
    return {get(), {}};
  }
  return {};
}

}  // namespace

const OiioInterface& oiio() {
  static const Loaded loaded = load();
  if (!loaded.interface) throw std::runtime_error("this command comes without OpenImageIO: " + loaded.problem);
  return *loaded.interface;
}

}  // namespace wardmis
