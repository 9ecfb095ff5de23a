// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// How the C library's heap treats the buffers of some megabytes that every scan needs.
#ifndef CURVEREG_PROGRAM_HEAP_TUNING_H_
#define CURVEREG_PROGRAM_HEAP_TUNING_H_

namespace curvereg {

// Lets the process keep up to some 100 MB that it freed instead of giving it back to the kernel, which would clear each
// page again at the next scan: without it two scans sent along cost 12 ms more than the core alone, with it 4 ms
// (bench/service_latency_bench.cc). Of the whole process, so called by programs, once, at their start. Does nothing
// where the C library is not glibc.
void KeepFreedMemory();

}  // namespace curvereg

#endif  // CURVEREG_PROGRAM_HEAP_TUNING_H_
