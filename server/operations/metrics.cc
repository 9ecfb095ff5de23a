// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "server/operations/metrics.h"

#include <prometheus/counter.h>
#include <prometheus/family.h>
#include <prometheus/gauge.h>
#include <prometheus/histogram.h>
#include <prometheus/registry.h>
#include <prometheus/text_serializer.h>

#include <algorithm>
#include <map>
#include <mutex>
#include <optional>
#include <shared_mutex>
#include <utility>
#include <vector>

#include "core/methods/registration_names.h"
#include "core/register_scans.h"
#include "server/operations/metric_children.h"
#include "server/operations/process_statistics.h"

namespace curvereg::server {
namespace {

using prometheus::Counter;
using prometheus::Histogram;
using CounterFamily = prometheus::Family<Counter>;
using HistogramFamily = prometheus::Family<Histogram>;

double Seconds(std::chrono::nanoseconds duration) { return std::chrono::duration<double>(duration).count(); }

prometheus::MetricFamily Sample(const std::string& name, const std::string& help, prometheus::MetricType type,
                                double value) {
  prometheus::ClientMetric metric;
  metric.counter.value = value;
  metric.gauge.value = value;  // the serializer reads the one that the type names
  return {name, help, type, {metric}};
}

std::vector<prometheus::MetricFamily> ProcessFamilies() {
  using prometheus::MetricType;
  const ProcessStatistics process = ReadProcessStatistics();
  return {
      Sample("process_cpu_seconds_total", "User and system CPU time spent [s]", MetricType::Counter,
             process.cpu_seconds),
      Sample("process_resident_memory_bytes", "Resident memory", MetricType::Gauge, process.resident_bytes),
      Sample("process_virtual_memory_bytes", "Virtual memory", MetricType::Gauge, process.virtual_bytes),
      Sample("process_start_time_seconds", "Start of the process since 1970 [s]", MetricType::Gauge,
             process.start_time_seconds),
      Sample("process_open_fds", "Open file descriptors", MetricType::Gauge, process.num_open_files),
      Sample("process_max_fds", "File descriptors that may be open", MetricType::Gauge, process.max_open_files),
      Sample("process_threads", "Threads of the process", MetricType::Gauge, process.num_threads),
  };
}

}  // namespace

struct Metrics::State {
  // What is counted for one method.
  struct Rpc {
    Counter& started;
    Counter& received;
    Counter& sent;
    prometheus::Gauge& open;
    // By code; most codes never come.
    LabelledChildren<Counter> handled;
    LabelledChildren<Histogram> handling;
  };
  struct Reading {
    prometheus::MetricType type;
    std::string help;
    std::function<double()> read;
  };

  CounterFamily& Counters(const char* name, const char* help) {
    return prometheus::BuildCounter().Name(name).Help(help).Register(registry);
  }
  HistogramFamily& Histograms(const char* name, const char* help) {
    return prometheus::BuildHistogram().Name(name).Help(help).Register(registry);
  }

  Rpc& Of(const std::string& service, const std::string& method) {
    {
      const std::shared_lock lock(rpc_mutex);
      if (const auto methods = rpcs.find(service); methods != rpcs.end()) {
        if (const auto rpc = methods->second.find(method); rpc != methods->second.end()) return *rpc->second;
      }
    }
    const std::unique_lock lock(rpc_mutex);
    std::unique_ptr<Rpc>& rpc = rpcs[service][method];
    if (rpc == nullptr) rpc = MakeRpc({{"grpc_service", service}, {"grpc_method", method}});
    return *rpc;
  }

  std::unique_ptr<Rpc> MakeRpc(const prometheus::Labels& labels) {
    const auto with_code = [labels](const std::string& code) {
      prometheus::Labels all = labels;
      all["grpc_code"] = code;
      return all;
    };
    const auto make_handled = [this, with_code](const std::string& code) -> Counter& {
      return handled.Add(with_code(code));
    };
    const auto make_handling = [this, with_code](const std::string& code) -> Histogram& {
      return handling.Add(with_code(code), SecondsBuckets());
    };
    return std::unique_ptr<Rpc>(new Rpc{started.Add(labels), received.Add(labels), sent.Add(labels), open.Add(labels),
                                        LabelledChildren<Counter>(make_handled),
                                        LabelledChildren<Histogram>(make_handling)});
  }

  void SetReading(const std::string& name, Reading reading) {
    const std::lock_guard lock(readings_mutex);
    readings[name] = std::move(reading);
  }

  prometheus::Registry registry;
  CounterFamily& started = Counters("grpc_server_started_total", "Calls started");
  CounterFamily& handled = Counters("grpc_server_handled_total", "Calls ended, by status code");
  CounterFamily& received = Counters("grpc_server_msg_received_total", "Messages received");
  CounterFamily& sent = Counters("grpc_server_msg_sent_total", "Messages sent");
  HistogramFamily& handling =
      Histograms("grpc_server_handling_seconds", "Time from the start of a call to its end, by status code [s]");
  prometheus::Family<prometheus::Gauge>& open =
      prometheus::BuildGauge().Name("curvereg_open_calls").Help("Open calls and streams").Register(registry);
  CounterFamily& rejected_family =
      Counters("curvereg_rejected_total", "Calls rejected because a limit is reached, by reason");
  HistogramFamily& stage_family = Histograms("curvereg_stage_seconds", "Wall time of each stage of a registration [s]");
  CounterFamily& verdict_family =
      Counters("curvereg_verdict_total", "Registrations by verdict and, when rejected, its first reason");

  Histogram& queue_wait = Histograms("curvereg_queue_wait_seconds", "Time that a registration waited for a worker [s]")
                              .Add({}, SecondsBuckets());
  Histogram& registration =
      Histograms("curvereg_registration_seconds", "Wall time of a registration [s]").Add({}, SecondsBuckets());
  Histogram& attempts = Histograms("curvereg_registration_attempts",
                                   "Attempts of a registration, each with dearer settings than the one before")
                            .Add({}, CountBuckets());
  Histogram& hypotheses =
      Histograms("curvereg_registration_hypotheses", "Poses that a registration tried").Add({}, CountBuckets());
  Histogram& inliers = Histograms("curvereg_registration_inliers", "Matches of a registration that agree with its pose")
                           .Add({}, CountBuckets());
  Counter& registered_points =
      Counters("curvereg_registration_points_total", "Finite points of the scans that were registered, of both")
          .Add({});
  Histogram& residual =
      Histograms("curvereg_residual_meters", "Surface distance of registered scans, RMSE [m]").Add({}, MetersBuckets());
  Histogram& overlap = Histograms("curvereg_overlap_ratio",
                                  "Share of ground that registered scans have in common, the smaller of the two")
                           .Add({}, RatioBuckets());
  Counter& scans = Counters("curvereg_received_scans_total", "Scans decoded from calls and uploads").Add({});
  Counter& points = Counters("curvereg_received_points_total", "Points of these scans").Add({});
  Counter& resumed = Counters("curvereg_uploads_resumed_total", "Uploads resumed after an interruption").Add({});
  Counter& uploads = Counters("curvereg_uploads_completed_total", "Uploads completed").Add({});
  Counter& upload_bytes = Counters("curvereg_uploads_completed_bytes_total", "Bytes of these uploads").Add({});
  Counter& checksum =
      Counters("curvereg_checksum_failures_total", "Bytes refused for a wrong checksum or digest").Add({});

  // All origins at once, so that they are there from the start.
  CounterFamily& tracked_family =
      Counters("curvereg_traverse_scans_total", "Scans of traverses with a pose, by its origin");
  Counter& by_registration = tracked_family.Add({{"origin", "registered"}});
  Counter& by_prior = tracked_family.Add({{"origin", "prior"}});
  Counter& by_segment_start = tracked_family.Add({{"origin", "segment_start"}});
  Histogram& tracking_latency = Histograms("curvereg_traverse_latency_seconds",
                                           "Time from the acknowledgement of a traverse's scan to its pose [s]")
                                    .Add({}, SecondsBuckets());
  Counter& taken_seconds = Counters("curvereg_traverse_acquisition_seconds_total",
                                    "Time from the acquisition of a traverse's scans to that of the next ones [s]")
                               .Add({});
  Counter& joined = Counters("curvereg_traverse_segments_joined_total", "Segments merged into another").Add({});
  Histogram& optimization =
      Histograms("curvereg_traverse_optimization_seconds", "Wall time of a revision of a traverse's poses [s]")
          .Add({}, SecondsBuckets());
  Counter& events = Counters("curvereg_traverse_events_total", "Events of traverses").Add({});

  LabelledChildren<Counter> rejected{[this](const std::string& reason) -> Counter& {
    return rejected_family.Add({{"reason", reason}});
  }};
  LabelledChildren<Histogram> stages{[this](const std::string& stage) -> Histogram& {
    return stage_family.Add({{"stage", stage}}, SecondsBuckets());
  }};
  LabelledChildren<Counter> verdicts{[this](const std::string& reason) -> Counter& {
    return verdict_family.Add({{"verdict", reason.empty() ? "accepted" : "rejected"}, {"reason", reason}});
  }};

  std::shared_mutex rpc_mutex;
  std::map<std::string, std::map<std::string, std::unique_ptr<Rpc>>> rpcs;
  std::mutex readings_mutex;
  std::map<std::string, Reading> readings;
};

Metrics::Metrics() : state_(std::make_unique<State>()) {
  prometheus::BuildGauge()
      .Name("curvereg_build_info")
      .Help("Always 1; the label is the build")
      .Register(state_->registry)
      .Add({{"build", BuildId()}})
      .Set(1.0);
}

Metrics::~Metrics() = default;

void Metrics::RpcStarted(const std::string& service, const std::string& method) {
  State::Rpc& rpc = state_->Of(service, method);
  rpc.started.Increment();
  rpc.open.Increment();
}

void Metrics::RpcHandled(const std::string& service, const std::string& method, const std::string& code,
                         std::chrono::nanoseconds duration) {
  State::Rpc& rpc = state_->Of(service, method);
  rpc.handled.Get(code).Increment();
  rpc.handling.Get(code).Observe(Seconds(duration));
  rpc.open.Decrement();
}

void Metrics::MessageReceived(const std::string& service, const std::string& method) {
  state_->Of(service, method).received.Increment();
}

void Metrics::MessageSent(const std::string& service, const std::string& method) {
  state_->Of(service, method).sent.Increment();
}

void Metrics::Rejected(const std::string& reason) { state_->rejected.Get(reason).Increment(); }

void Metrics::QueueWaited(std::chrono::nanoseconds duration) { state_->queue_wait.Observe(Seconds(duration)); }

void Metrics::Registered(const RegistrationResult& result) {
  for (const StageTime& time : result.stage_times) state_->stages.Get(time.stage).Observe(time.seconds);
  state_->registration.Observe(result.total_seconds);
  const std::vector<Reason>& reasons = result.verdict.reasons;
  const bool is_rejected = !result.verdict.accepted;
  const Reason reason = reasons.empty() ? Reason::kNotRun : reasons.front();
  state_->verdicts.Get(is_rejected ? std::string(ReasonName(reason)) : std::string()).Increment();
  const Evidence& evidence = result.evidence;  // a measure without a value is below 0
  state_->attempts.Observe(evidence.num_attempts);
  state_->hypotheses.Observe(evidence.num_hypotheses);
  state_->inliers.Observe(evidence.num_inliers);
  state_->registered_points.Increment(static_cast<double>(evidence.num_source_points + evidence.num_target_points));
  if (evidence.residual_rmse_m >= 0.0) state_->residual.Observe(*evidence.residual_rmse_m);
  const std::optional<double> overlap = std::min(evidence.overlap_source, evidence.overlap_target);
  if (overlap >= 0.0) state_->overlap.Observe(*overlap);
}

void Metrics::ScanReceived(uint64_t num_points) {
  state_->scans.Increment();
  state_->points.Increment(static_cast<double>(num_points));
}

void Metrics::UploadResumed() { state_->resumed.Increment(); }

void Metrics::UploadCompleted(uint64_t num_bytes) {
  state_->uploads.Increment();
  state_->upload_bytes.Increment(static_cast<double>(num_bytes));
}

void Metrics::ChecksumFailed() { state_->checksum.Increment(); }

void Metrics::ScanTracked(v1::PoseOrigin origin, double latency_s, double acquisition_s) {
  if (origin == v1::POSE_ORIGIN_REGISTERED) {
    state_->by_registration.Increment();
  } else if (origin == v1::POSE_ORIGIN_PRIOR) {
    state_->by_prior.Increment();
  } else {
    state_->by_segment_start.Increment();
  }
  state_->tracking_latency.Observe(latency_s);
  state_->taken_seconds.Increment(acquisition_s);
}

void Metrics::SegmentJoined() { state_->joined.Increment(); }

void Metrics::TraverseOptimized(std::chrono::nanoseconds duration) { state_->optimization.Observe(Seconds(duration)); }

void Metrics::TraverseEvents(uint64_t num_events) { state_->events.Increment(static_cast<double>(num_events)); }

void Metrics::SetGauge(const std::string& name, const std::string& help, std::function<double()> read) {
  state_->SetReading(name, {prometheus::MetricType::Gauge, help, std::move(read)});
}

void Metrics::SetCounter(const std::string& name, const std::string& help, std::function<double()> read) {
  state_->SetReading(name, {prometheus::MetricType::Counter, help, std::move(read)});
}

std::string Metrics::Text() const {
  std::vector<prometheus::MetricFamily> families = state_->registry.Collect();
  // A family without children yet is left out of the text: Prometheus takes it for a metric without a value.
  std::erase_if(families, [](const prometheus::MetricFamily& family) { return family.metric.empty(); });
  {
    const std::lock_guard lock(state_->readings_mutex);
    for (const auto& [name, reading] : state_->readings) {
      families.push_back(Sample(name, reading.help, reading.type, reading.read()));
    }
  }
  for (prometheus::MetricFamily& family : ProcessFamilies()) families.push_back(std::move(family));
  return prometheus::TextSerializer().Serialize(families);
}

}  // namespace curvereg::server
