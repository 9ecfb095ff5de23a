// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "bench/ratio.h"

#include <fftw3.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <memory>
#include <string_view>
#include <thread>

#include "bench/median_time.h"
#include "core/base/parallel.h"

namespace curvereg::bench {
namespace {

constexpr int kRounds = 31;

struct Row {
  std::string name;
  double plain_s, one_thread_s, two_threads_s;
};

Row Measure(const Work& plain, const Work& work) {
  const std::vector<double> seconds =
      MedianSeconds(kRounds, {[&] { plain.run_with(1); }, [&] { work.run_with(1); }, [&] { work.run_with(2); }});
  return {work.name, seconds[0], seconds[1], seconds[2]};
}

bool WriteJson(const std::string& path, const std::string& plain, const std::vector<Row>& rows) {
  std::ofstream file(path);
  file << "{\n  \"plain_work\": \"" << plain << "\",\n  \"processors\": " << std::thread::hardware_concurrency()
       << ",\n  \"rounds\": " << kRounds << ",\n  \"benchmarks\": [";
  const char* separator = "\n";
  for (const Row& row : rows) {
    file << separator << "    {\"name\": \"" << row.name << "\", \"plain_s\": " << row.plain_s
         << ", \"one_thread_s\": " << row.one_thread_s << ", \"two_threads_s\": " << row.two_threads_s << "}";
    separator = ",\n";
  }
  file << "\n  ]\n}\n";
  return static_cast<bool>(file.flush());
}

struct Free {
  void operator()(void* memory) const { fftwf_free(memory); }
  void operator()(fftwf_plan_s* plan) const { fftwf_destroy_plan(plan); }
};

struct RoundTrip {
  explicit RoundTrip(int size)
      : image(fftwf_alloc_real(static_cast<size_t>(size) * static_cast<size_t>(size))),
        spectrum(fftwf_alloc_complex(static_cast<size_t>(size) * static_cast<size_t>(size / 2 + 1))),
        forward(fftwf_plan_dft_r2c_2d(size, size, image.get(), spectrum.get(), FFTW_ESTIMATE)),
        inverse(fftwf_plan_dft_c2r_2d(size, size, spectrum.get(), image.get(), FFTW_ESTIMATE)) {
    // The inverse is not normalised, so that a wave would grow without end; zero costs the same.
    std::fill_n(image.get(), size * size, 0.0F);
  }
  std::unique_ptr<float, Free> image;
  std::unique_ptr<fftwf_complex, Free> spectrum;
  std::unique_ptr<fftwf_plan_s, Free> forward;
  std::unique_ptr<fftwf_plan_s, Free> inverse;
};

}  // namespace

// Entering an arena costs microseconds, so the limit is set around the work, as a caller would.
Work::Work(std::string work_name, std::function<void()> run)
    : name(std::move(work_name)),
      run_with([run = std::move(run)](int num_threads) { WithThreadLimit(num_threads, run); }) {}

Work::Work(std::string work_name, std::function<void(int)> run)
    : name(std::move(work_name)), run_with(std::move(run)) {}

Work CopyOf(const std::vector<Eigen::Vector3f>& points) {
  auto copy = std::make_shared<std::vector<Eigen::Vector3f>>(points);
  return {"copy of " + std::to_string(points.size()) + " points",
          [copy, &points] { std::copy(points.begin(), points.end(), copy->begin()); }};
}

Work FftRoundTrip(int size) {
  auto plans = std::make_shared<RoundTrip>(size);
  return {"r2c + c2r of " + std::to_string(size) + " x " + std::to_string(size), [plans] {
            fftwf_execute(plans->forward.get());
            fftwf_execute(plans->inverse.get());
          }};
}

int PrintRatios(int argc, char** argv, const Work& plain, const std::vector<Work>& works) {
  constexpr std::string_view kOutFlag = "--benchmark_out=";
  std::printf("plain work: %s; medians of %d rounds [ms]\n", plain.name.c_str(), kRounds);
  std::printf("%-34s %9s %10s %8s %11s %8s\n", "stage", "plain", "1 thread", "ratio", "2 threads", "ratio");
  std::vector<Row> rows;
  for (const Work& work : works) {
    rows.push_back(Measure(plain, work));
    const Row& row = rows.back();
    std::printf("%-34s %9.3f %10.3f %8.2f %11.3f %8.2f\n", row.name.c_str(), 1e3 * row.plain_s, 1e3 * row.one_thread_s,
                row.one_thread_s / row.plain_s, 1e3 * row.two_threads_s, row.two_threads_s / row.plain_s);
  }
  for (int i = 1; i < argc; ++i) {
    const std::string_view argument = argv[i];
    if (!argument.starts_with(kOutFlag)) continue;
    const std::string path(argument.substr(kOutFlag.size()));
    if (WriteJson(path, plain.name, rows)) continue;
    std::fprintf(stderr, "%s: cannot be written\n", path.c_str());
    return 1;
  }
  return 0;
}

}  // namespace curvereg::bench
