// SPDX-License-Identifier: GPL-3.0-or-later
// Parts of the command that are loaded when they are wanted, from files that lie beside it or are missing.
#pragma once

#include <dlfcn.h>

#include <filesystem>
#include <string>

namespace wardmis {

template <class Interface>
struct Module {
  const Interface* interface = nullptr;
  std::string problem;  // why it is not there
};

// The interface that the module's function `symbol` returns, if it is of this version.
template <class Interface>
Module<Interface> loadModule(const std::string& name, const char* symbol, int version) {
  std::error_code unreadable;
  const auto folder = std::filesystem::read_symlink("/proc/self/exe", unreadable).parent_path();
  for (const auto& file : {folder / name, folder.parent_path() / "lib" / "wardmis" / name}) {
    if (std::error_code error; !std::filesystem::exists(file, error)) continue;
    void* module = dlopen(file.c_str(), RTLD_NOW | RTLD_LOCAL);
    if (!module) return {nullptr, dlerror()};
    const auto get = reinterpret_cast<const Interface* (*)()>(dlsym(module, symbol));
    if (!get || get()->version != version)
      return {nullptr, file.string() + " belongs to another version of the command"};
    return {get(), {}};
  }
  return {nullptr, name + " does not lie beside it"};
}

}  // namespace wardmis
