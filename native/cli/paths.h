// SPDX-License-Identifier: GPL-3.0-or-later
// Whether the files that the command is to write can be written: told before the work, not after it.
#pragma once

#include <initializer_list>
#include <string>

namespace wardmis {

// A file that is read or written, and the option that names it. An empty path: it is not used.
struct NamedFile {
  const char* option;
  const std::string& path;
};

// Throws Error(kFile) unless `path` can become a file: its folder exists and is writable, and it is no device or
// folder.
void checkWritable(const std::string& path);

// Throws Error(kUsage) unless `path` is called as an OpenEXR.
void checkNamedExr(const std::string& path);

// Throws Error(kUsage) if two of them are the same file, of which one would replace the other.
void checkDistinct(std::initializer_list<NamedFile> files);

}  // namespace wardmis
