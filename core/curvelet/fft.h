// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// Discrete Fourier transforms of rasters, on FFTW. All are unnormalised: a transform and its inverse together
// multiply by rows * cols. Spectra are in natural order (frequency k at index k mod n); "half spectra" of real images
// hold columns 0 .. cols/2 only, row after row.
//
// Plans are made with FFTW_ESTIMATE: FFTW_MEASURE would choose by timing, and the bytes of the result with it.
// A plan is immutable and may be executed by any number of threads at once. Plans are kept in a small cache, the
// core's only process-wide state; it is guarded by a mutex and changes no result.
#ifndef CURVEREG_CORE_CURVELET_FFT_H_
#define CURVEREG_CORE_CURVELET_FFT_H_

#include <complex>
#include <cstddef>
#include <memory>
#include <mutex>
#include <vector>

namespace curvereg {

// Uninitialised array with the alignment that FFTW's vector instructions need. Every spectrum handed to an FftPlan
// lives in one (or in another array of FFTW's alignment).
template <typename T>
class FftBuffer {
 public:
  FftBuffer() = default;
  explicit FftBuffer(std::size_t size);
  T* data() { return data_.get(); }
  const T* data() const { return data_.get(); }
  std::size_t size() const { return size_; }
  T& operator[](std::size_t i) { return data_.get()[i]; }
  const T& operator[](std::size_t i) const { return data_.get()[i]; }

 private:
  struct Free {
    void operator()(T* data) const;
  };
  std::unique_ptr<T, Free> data_;
  std::size_t size_ = 0;
};

// Buffers of one size for the tasks of a parallel loop: as many as tasks run at once, so that a serial loop works in
// one that stays in the processor's cache. Thread-safe. Contents are undefined at Take.
template <typename T>
class FftBufferPool {
 public:
  explicit FftBufferPool(std::size_t buffer_size) : buffer_size_(buffer_size) {}
  FftBuffer<T> Take();
  void Give(FftBuffer<T> buffer);

 private:
  std::size_t buffer_size_;
  std::mutex mutex_;
  std::vector<FftBuffer<T>> free_;
};

enum class FftKind {
  kRealToHalf,      // real image -> half spectrum, exp(-i ...)
  kHalfToReal,      // half spectrum -> real image, exp(+i ...)
  kForward,         // complex, exp(-i ...)
  kInverse,         // complex, exp(+i ...)
  kInverseColumns,  // complex, exp(+i ...), along the rows index only, of the first active_cols columns
  kHalfRowsToReal,  // each row of a half spectrum -> a row of the real image: what kInverseColumns leaves to do
};

struct FftShape {
  int rows = 0;         // > 0
  int cols = 0;         // > 0; of the image, also where half spectra have cols/2 + 1 columns
  int active_cols = 0;  // kInverseColumns only: columns to transform; their stride is cols/2 + 1
  bool operator==(const FftShape&) const = default;
};

// T is float or double. Execute with the arguments that the kind names; anything else is a bug of the caller.
template <typename T>
class FftPlan {
 public:
  using Complex = std::complex<T>;
  FftPlan(const FftShape& shape, FftKind kind);
  ~FftPlan();
  FftPlan(const FftPlan&) = delete;
  FftPlan& operator=(const FftPlan&) = delete;

  // kRealToHalf. `image` of any alignment (the usual one of the heap avoids a copy); left as it is.
  void Execute(const T* image, Complex* half_spectrum) const;
  // kHalfToReal, kHalfRowsToReal. Destroys the half spectrum. `image` of any alignment, as above.
  void Execute(Complex* half_spectrum, T* image) const;
  // kForward, kInverse, kInverseColumns; in place. kInverseColumns leaves the other columns as they are.
  void Execute(Complex* data) const;

 private:
  FftShape shape_;
  FftKind kind_;
  void* plan_ = nullptr;
};

// The plan for `shape` and `kind`, made at first use, then from the cache (128 plans, the least recently used is
// dropped; plans in use live on). Thread-safe. Preconditions: as in FftShape.
template <typename T>
std::shared_ptr<const FftPlan<T>> GetFftPlan(const FftShape& shape, FftKind kind);

}  // namespace curvereg

#endif  // CURVEREG_CORE_CURVELET_FFT_H_
