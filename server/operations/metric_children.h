// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// The parts of metrics.cc that do not know what is counted. Only included there: prometheus-cpp stays out of our
// interfaces.
#ifndef CURVEREG_SERVER_OPERATIONS_METRIC_CHILDREN_H_
#define CURVEREG_SERVER_OPERATIONS_METRIC_CHILDREN_H_

#include <prometheus/histogram.h>

#include <functional>
#include <map>
#include <mutex>
#include <shared_mutex>
#include <string>
#include <utility>

namespace curvereg::server {

// From a small unary call on loopback (0.2 ms) to a long upload.
inline const prometheus::Histogram::BucketBoundaries& SecondsBuckets() {
  static const prometheus::Histogram::BucketBoundaries buckets = {
      0.0005, 0.001, 0.0025, 0.005, 0.01, 0.025, 0.05, 0.1, 0.25, 0.5, 1.0, 2.5, 5.0, 10.0, 30.0, 60.0, 300.0};
  return buckets;
}
inline const prometheus::Histogram::BucketBoundaries& CountBuckets() {
  static const prometheus::Histogram::BucketBoundaries buckets = {0.0,  1.0,  2.0,   3.0,   5.0,   10.0,
                                                                  20.0, 50.0, 100.0, 200.0, 500.0, 1000.0};
  return buckets;
}
inline const prometheus::Histogram::BucketBoundaries& MetersBuckets() {
  static const prometheus::Histogram::BucketBoundaries buckets = {0.005, 0.01, 0.02, 0.03, 0.05, 0.075,
                                                                  0.1,   0.15, 0.2,  0.5,  1.0};
  return buckets;
}
inline const prometheus::Histogram::BucketBoundaries& RatioBuckets() {
  static const prometheus::Histogram::BucketBoundaries buckets = {0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9, 1.0};
  return buckets;
}

// A family with one label: finding a child of the library's takes a lock and hashes all labels, this a shared lock and
// a few string comparisons. Children live as long as the family.
template <typename Metric>
class LabelledChildren {
 public:
  using MakeChild = std::function<Metric&(const std::string&)>;
  explicit LabelledChildren(MakeChild make) : make_(std::move(make)) {}

  Metric& Get(const std::string& label) {
    {
      const std::shared_lock lock(mutex_);
      const auto found = children_.find(label);
      if (found != children_.end()) return *found->second;
    }
    const std::unique_lock lock(mutex_);
    Metric*& child = children_[label];
    if (child == nullptr) child = &make_(label);
    return *child;
  }

 private:
  MakeChild make_;
  std::shared_mutex mutex_;
  std::map<std::string, Metric*> children_;
};

}  // namespace curvereg::server

#endif  // CURVEREG_SERVER_OPERATIONS_METRIC_CHILDREN_H_
