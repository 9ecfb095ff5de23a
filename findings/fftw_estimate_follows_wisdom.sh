#!/usr/bin/env bash
# SPDX-FileCopyrightText: 2026 The Curvereg authors
# SPDX-License-Identifier: Apache-2.0
#
# FFTW 3.3.10: FFTW_ESTIMATE is not deterministic within a process.
#
# The usual guess: FFTW_ESTIMATE chooses a plan without measurements, so the same input always gives the same bytes.
# Observed: wisdom belongs to the process. If any code in it, for example another library, plans a size with FFTW_MEASURE,
# later FFTW_ESTIMATE plans of that size use the measured plan. It rounds differently, and since it depends on timing it
# also differs between runs.
#
# Why it matters: features and descriptors computed by FFT change in their last bits, depending on what else the process
# did before. Decisions near a threshold can flip, and results cannot be compared by digest.
# What to do: call fftw_forget_wisdom() before planning (the script shows that this restores the first bytes), or control
# all users of FFTW in the process.
set -euo pipefail

name=libfftw3-dev pinned=3.3.10-1
version=$(dpkg-query -W -f '${Version}' $name 2>/dev/null || echo missing)
echo "$name $version (described: $pinned)"
if [ "$version" = missing ] || { [ "$version" != "$pinned" ] && [ -z "${FINDINGS_ANY_VERSION:-}" ]; }; then
  echo "cannot be shown: $name $pinned is needed" && exit 77
fi
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$work"

cat >show.c <<'C'
#include <fftw3.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static int rows, cols;
static double* image;
static fftw_complex* spectrum;

static size_t bytes(void) { return sizeof(fftw_complex) * rows * (cols / 2 + 1); }

/* A copy of the transform of a fixed image, planned with FFTW_ESTIMATE. */
static char* transform(void) {
  fftw_plan plan = fftw_plan_dft_r2c_2d(rows, cols, image, spectrum, FFTW_ESTIMATE);
  unsigned state = 1;
  for (int i = 0; i < rows * cols; ++i) {
    state = state * 1664525u + 1013904223u;
    image[i] = (state >> 8) / 16777216.0 - 0.5;
  }
  fftw_execute(plan);
  fftw_destroy_plan(plan);
  return memcpy(malloc(bytes()), spectrum, bytes());
}

/* 1: as described, 0: measuring changed nothing, -1: not as described. */
static int show(int num_rows, int num_cols) {
  rows = num_rows;
  cols = num_cols;
  image = fftw_malloc(sizeof(double) * rows * cols);
  spectrum = fftw_malloc(bytes());
  char* first = transform();
  char* second = transform();
  fftw_plan other = fftw_plan_dft_r2c_2d(rows, cols, image, spectrum, FFTW_MEASURE); /* by another part of the program */
  fftw_destroy_plan(other);
  char* after = transform();
  fftw_forget_wisdom();
  char* forgotten = transform();
  size_t differ = 0;
  for (size_t i = 0; i < bytes(); i += sizeof(double)) differ += memcmp(first + i, after + i, sizeof(double)) != 0;
  printf("%3d x %3d  repeated: %s  after FFTW_MEASURE elsewhere: %zu of %zu numbers differ  wisdom forgotten: %s\n", rows,
         cols, memcmp(first, second, bytes()) ? "DIFFERENT" : "same bytes", differ, bytes() / sizeof(double),
         memcmp(first, forgotten, bytes()) ? "DIFFERENT" : "same bytes");
  if (memcmp(first, second, bytes()) || memcmp(first, forgotten, bytes())) return -1;
  return differ > 0;
}

int main(void) {
  const int sizes[][2] = {{128, 128}, {192, 192}, {256, 256}, {240, 320}, {90, 90}};
  int changed = 0;
  printf("%s, FFTW_ESTIMATE, 2-D real transforms\n", fftw_version);
  for (int i = 0; i < 5; ++i) {
    int result = show(sizes[i][0], sizes[i][1]);
    if (result < 0) return 1;
    changed += result;
  }
  return changed > 0 ? 0 : 1; /* measuring depends on time: not every size need change */
}
C
gcc -O1 show.c -lfftw3 -lm -o show
if ./show; then echo 'as described'; else echo 'NOT as described' && exit 1; fi
