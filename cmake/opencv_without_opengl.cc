// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// The three functions of GLX that OpenCV's core asks for by name. Curvereg draws into memory and never opens a window:
// without these definitions each executable would load libGLX, whose Debian package brings Mesa and LLVM. Hidden, so
// that a process that does load libGLX calls the real ones.
#define CURVEREG_HIDDEN __attribute__((visibility("hidden")))

extern "C" {

using GlFunction = void (*)();

CURVEREG_HIDDEN GlFunction glXGetProcAddressARB(const unsigned char* /*name*/) { return nullptr; }
CURVEREG_HIDDEN void* glXGetCurrentContext() { return nullptr; }
CURVEREG_HIDDEN void* glXGetCurrentDisplay() { return nullptr; }

}  // extern "C"
