// SPDX-License-Identifier: GPL-3.0-or-later
// What the module wardmis_oiio gives to the command: plain C, so that neither types of C++ nor exceptions cross between
// them. A function returns null, or else what is wrong; that text, and encoded bytes, live until the thread's next
// call.
#pragma once

#include <cstddef>
#include <cstdint>

extern "C" {

struct OiioReader;

struct OiioFormat {
  int width, height, channels;  // channels: 1 to 4
  bool floats;                  // 32-bit floats, else bytes
  bool integers;  // what the file holds, also where it has more than 8 bits and is given as floats in 0..1
};

struct OiioInterface {
  int version;
  // Reads the head of a file in memory, which must outlive the reader.
  const char* (*open)(const void* file, size_t size, OiioReader** reader, OiioFormat* format);
  // Fills `pixels`, rows from the bottom.
  const char* (*read)(OiioReader* reader, void* pixels);
  void (*close)(OiioReader* reader);

  // Pictures: RGB of 8 bits in sRGB, rows from the top.
  // The colours of the map of this name for values in 0..1.
  const char* (*colourMap)(const char* name, const float* values, int count, uint8_t* rgb);
  // One line of `size` pixels that is centred on y and begins at x, or ends there; grey: 0 to 1.
  const char* (*drawText)(uint8_t* rgb, int width, int height, int x, int y, bool endsAtX, int size, const char* text,
                          float grey);
  // A picture as a file of the format that the extension of `name` says.
  const char* (*encode)(const char* name, const uint8_t* rgb, int width, int height, const void** bytes, size_t* size);
};

constexpr int kOiioVersion = 1;
// The module exports it by this name.
const OiioInterface* wardmisOiio();
}
