// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// Only in sanitizer builds: the Vulkan loader unloads drivers and layers, and after that the leak
// checker cannot tell whose memory it found. Nothing is unloaded here, so that leaks.supp can name
// the libraries. Seen by the loader, unlike all else that is compiled here: it is asked for by
// name.

extern "C" __attribute__((visibility("default"))) int dlclose(void* /*handle*/) {
  return 0;
}
