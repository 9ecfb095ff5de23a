// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "core/curvelet/fft.h"

#include <fftw3.h>

#include <algorithm>
#include <cassert>
#include <list>
#include <mutex>
#include <new>
#include <utility>

namespace curvereg {
namespace {

constexpr std::size_t kCacheCapacity = 128;

// FFTW under one name for both precisions.
template <typename T>
struct Fftw;

template <>
struct Fftw<double> {
  using Plan = fftw_plan;
  using Complex = fftw_complex;
  static constexpr auto& kDft = fftw_plan_many_dft;
  static constexpr auto& kRealToHalf = fftw_plan_many_dft_r2c;
  static constexpr auto& kHalfToReal = fftw_plan_many_dft_c2r;
  static constexpr auto& kExecuteDft = fftw_execute_dft;
  static constexpr auto& kExecuteRealToHalf = fftw_execute_dft_r2c;
  static constexpr auto& kExecuteHalfToReal = fftw_execute_dft_c2r;
  static constexpr auto& kAlignmentOf = fftw_alignment_of;
  static constexpr auto& kDestroyPlan = fftw_destroy_plan;
};

template <>
struct Fftw<float> {
  using Plan = fftwf_plan;
  using Complex = fftwf_complex;
  static constexpr auto& kDft = fftwf_plan_many_dft;
  static constexpr auto& kRealToHalf = fftwf_plan_many_dft_r2c;
  static constexpr auto& kHalfToReal = fftwf_plan_many_dft_c2r;
  static constexpr auto& kExecuteDft = fftwf_execute_dft;
  static constexpr auto& kExecuteRealToHalf = fftwf_execute_dft_r2c;
  static constexpr auto& kExecuteHalfToReal = fftwf_execute_dft_c2r;
  static constexpr auto& kAlignmentOf = fftwf_alignment_of;
  static constexpr auto& kDestroyPlan = fftwf_destroy_plan;
};

// FFTW's planner, destruction included, is not thread-safe; execution is.
std::mutex& PlannerMutex() {
  static std::mutex& mutex = *new std::mutex;
  return mutex;
}

template <typename T>
typename Fftw<T>::Complex* AsFftw(std::complex<T>* data) {
  return reinterpret_cast<typename Fftw<T>::Complex*>(data);
}

template <typename T>
bool IsAligned(const T* data) {
  return Fftw<T>::kAlignmentOf(const_cast<T*>(data)) == 0;
}

std::size_t NumPixels(const FftShape& shape) {
  return static_cast<std::size_t>(shape.rows) * static_cast<std::size_t>(shape.cols);
}

template <typename T>
typename Fftw<T>::Plan MakePlan(const FftShape& shape, FftKind kind) {
  // FFTW_ESTIMATE looks at the addresses of the arrays, never at what they hold.
  FftBuffer<std::complex<T>> complex_buffer(NumPixels(shape) + static_cast<std::size_t>(shape.rows));
  FftBuffer<T> real_buffer(NumPixels(shape));
  auto* complex_data = AsFftw<T>(complex_buffer.data());
  T* real_data = real_buffer.data();
  const int size[2] = {shape.rows, shape.cols};
  const int half_cols = shape.cols / 2 + 1;
  const std::lock_guard<std::mutex> lock(PlannerMutex());
  switch (kind) {
    case FftKind::kRealToHalf:
      return Fftw<T>::kRealToHalf(2, size, 1, real_data, nullptr, 1, 0, complex_data, nullptr, 1, 0, FFTW_ESTIMATE);
    case FftKind::kHalfToReal:
      return Fftw<T>::kHalfToReal(2, size, 1, complex_data, nullptr, 1, 0, real_data, nullptr, 1, 0, FFTW_ESTIMATE);
    case FftKind::kForward:
    case FftKind::kInverse:
      return Fftw<T>::kDft(2, size, 1, complex_data, nullptr, 1, 0, complex_data, nullptr, 1, 0,
                           kind == FftKind::kForward ? FFTW_FORWARD : FFTW_BACKWARD, FFTW_ESTIMATE);
    case FftKind::kInverseColumns:
      return Fftw<T>::kDft(1, size, shape.active_cols, complex_data, nullptr, half_cols, 1, complex_data, nullptr,
                           half_cols, 1, FFTW_BACKWARD, FFTW_ESTIMATE);
    case FftKind::kHalfRowsToReal:
      return Fftw<T>::kHalfToReal(1, size + 1, shape.rows, complex_data, nullptr, 1, half_cols, real_data, nullptr, 1,
                                  shape.cols, FFTW_ESTIMATE);
  }
  return nullptr;
}

template <typename T>
struct CacheEntry {
  FftShape shape;
  FftKind kind;
  std::shared_ptr<const FftPlan<T>> plan;
};

template <typename T>
struct Cache {
  std::mutex mutex;
  std::list<CacheEntry<T>> entries;  // most recently used first
};

template <typename T>
Cache<T>& TheCache() {
  static Cache<T>& cache = *new Cache<T>;
  return cache;
}

// The cached plan, moved to the front; null when there is none. Precondition: the cache is locked.
template <typename T>
std::shared_ptr<const FftPlan<T>> Find(Cache<T>& cache, const FftShape& shape, FftKind kind) {
  const auto found = std::find_if(cache.entries.begin(), cache.entries.end(), [&](const CacheEntry<T>& entry) {
    return entry.shape == shape && entry.kind == kind;
  });
  if (found == cache.entries.end()) return nullptr;
  cache.entries.splice(cache.entries.begin(), cache.entries, found);
  return found->plan;
}

}  // namespace

template <typename T>
FftBuffer<T>::FftBuffer(std::size_t size)
    : data_(static_cast<T*>(fftw_malloc(std::max<std::size_t>(size, 1) * sizeof(T)))), size_(size) {
  if (data_ == nullptr) throw std::bad_alloc();  // as every container of the standard library does
}

template <typename T>
void FftBuffer<T>::Free::operator()(T* data) const {
  fftw_free(data);
}

template <typename T>
FftBuffer<T> FftBufferPool<T>::Take() {
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    if (!free_.empty()) {
      FftBuffer<T> buffer = std::move(free_.back());
      free_.pop_back();
      return buffer;
    }
  }
  return FftBuffer<T>(buffer_size_);
}

template <typename T>
void FftBufferPool<T>::Give(FftBuffer<T> buffer) {
  const std::lock_guard<std::mutex> lock(mutex_);
  free_.push_back(std::move(buffer));
}

template <typename T>
FftPlan<T>::FftPlan(const FftShape& shape, FftKind kind) : shape_(shape), kind_(kind), plan_(MakePlan<T>(shape, kind)) {
  assert(plan_ != nullptr);
}

template <typename T>
FftPlan<T>::~FftPlan() {
  const std::lock_guard<std::mutex> lock(PlannerMutex());
  Fftw<T>::kDestroyPlan(static_cast<typename Fftw<T>::Plan>(plan_));
}

template <typename T>
void FftPlan<T>::Execute(const T* image, Complex* half_spectrum) const {
  assert(kind_ == FftKind::kRealToHalf);
  const auto plan = static_cast<typename Fftw<T>::Plan>(plan_);
  if (IsAligned(image)) {
    // A real-to-complex transform out of place leaves its input alone.
    Fftw<T>::kExecuteRealToHalf(plan, const_cast<T*>(image), AsFftw(half_spectrum));
    return;
  }
  FftBuffer<T> aligned(NumPixels(shape_));
  std::copy_n(image, NumPixels(shape_), aligned.data());
  Fftw<T>::kExecuteRealToHalf(plan, aligned.data(), AsFftw(half_spectrum));
}

template <typename T>
void FftPlan<T>::Execute(Complex* half_spectrum, T* image) const {
  assert(kind_ == FftKind::kHalfToReal || kind_ == FftKind::kHalfRowsToReal);
  const auto plan = static_cast<typename Fftw<T>::Plan>(plan_);
  if (IsAligned(image)) {
    Fftw<T>::kExecuteHalfToReal(plan, AsFftw(half_spectrum), image);
    return;
  }
  FftBuffer<T> aligned(NumPixels(shape_));
  Fftw<T>::kExecuteHalfToReal(plan, AsFftw(half_spectrum), aligned.data());
  std::copy_n(aligned.data(), NumPixels(shape_), image);
}

template <typename T>
void FftPlan<T>::Execute(Complex* data) const {
  assert(kind_ == FftKind::kForward || kind_ == FftKind::kInverse || kind_ == FftKind::kInverseColumns);
  Fftw<T>::kExecuteDft(static_cast<typename Fftw<T>::Plan>(plan_), AsFftw(data), AsFftw(data));
}

template <typename T>
std::shared_ptr<const FftPlan<T>> GetFftPlan(const FftShape& shape, FftKind kind) {
  Cache<T>& cache = TheCache<T>();
  {
    const std::lock_guard<std::mutex> lock(cache.mutex);
    if (auto plan = Find(cache, shape, kind)) return plan;
  }
  auto made = std::make_shared<const FftPlan<T>>(shape, kind);
  std::list<CacheEntry<T>> dropped;  // destroyed after the lock is released
  const std::lock_guard<std::mutex> lock(cache.mutex);
  if (auto plan = Find(cache, shape, kind)) return plan;  // another thread was faster
  cache.entries.push_front({shape, kind, made});
  if (cache.entries.size() > kCacheCapacity) {
    dropped.splice(dropped.begin(), cache.entries, std::prev(cache.entries.end()));
  }
  return made;
}

template class FftBuffer<float>;
template class FftBuffer<double>;
template class FftBuffer<std::complex<float>>;
template class FftBuffer<std::complex<double>>;
template class FftBufferPool<std::complex<float>>;
template class FftBufferPool<std::complex<double>>;
template class FftPlan<float>;
template class FftPlan<double>;
template std::shared_ptr<const FftPlan<float>> GetFftPlan(const FftShape&, FftKind);
template std::shared_ptr<const FftPlan<double>> GetFftPlan(const FftShape&, FftKind);

}  // namespace curvereg
