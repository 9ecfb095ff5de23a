// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// RegisterScans (core/register_scans.h) as a pcl::Registration, to be used where pcl::IterativeClosestPoint or
// pcl::GeneralizedIterativeClosestPoint was. What differs from those:
//
// * hasConverged() means that the verdict *accepts* the pose: the two clouds show the same place and the transform is
//   right. It must be asked. Otherwise getFinalTransformation() is the identity, as with all of PCL, which is no pose,
//   and the output is the source as it was; result() has the reasons and the rejected pose, if there is one.
// * No initial guess is needed. A guess other than the identity is one more hypothesis among those that are compared;
// it
//   takes the place of the transform of options().prior, whose covariance, if given, then applies to it.
// * PCL's own settings of iterations, distances, epsilons, estimators and rejectors have no effect; setOptions has.
// * Clouds lie in the sensor frame, see client/pcl_clouds.h. Points that are not finite are skipped.
// * PointSource and PointTarget should be equal: align() of PCL 1.13 does not compile for two types.
//
// getFitnessScore() is PCL's own. An assertion in Debian's libpcl ends the process when it is called for a source that
// has points that are not finite; pcl::removeNaNFromPointCloud removes them.
//
// Cost: that of RegisterScans; the target is prepared once for all sources, and at once with the first of them. An
// object is for one thread at a time and holds its target's preparation, several times the cloud's size.
#ifndef CURVEREG_CLIENT_PCL_REGISTRATION_H_
#define CURVEREG_CLIENT_PCL_REGISTRATION_H_

#include <pcl/common/transforms.h>
#include <pcl/console/print.h>
#include <pcl/registration/registration.h>

#include <memory>
#include <string>
#include <utility>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "client/pcl_clouds.h"
#include "core/base/rigid_transform.h"
#include "core/base/stop.h"
#include "core/methods/prepared_scan.h"
#include "core/methods/registration_options.h"
#include "core/methods/registration_result.h"
#include "core/register_scans.h"
#include "core/scan/scan.h"

namespace curvereg {

// Methods are named as PCL names its own.
// NOLINTBEGIN(readability-identifier-naming)
template <typename PointSource, typename PointTarget>
class CurveletRegistration : public pcl::Registration<PointSource, PointTarget, float> {
 public:
  using Base = pcl::Registration<PointSource, PointTarget, float>;
  using typename Base::Matrix4;
  using typename Base::PointCloudSource;
  using typename Base::PointCloudSourceConstPtr;
  using typename Base::PointCloudTargetConstPtr;
  using Ptr = pcl::shared_ptr<CurveletRegistration>;
  using ConstPtr = pcl::shared_ptr<const CurveletRegistration>;

  explicit CurveletRegistration(RegistrationOptions options = {}) : options_(std::move(options)) {
    Base::reg_name_ = "CurveletRegistration";
  }

  void setOptions(RegistrationOptions options) {
    options_ = std::move(options);
    prepared_target_.reset();  // its limits may have changed
  }
  const RegistrationOptions& options() const { return options_; }

  // Of the last align(): pose, verdict and evidence. "Not run" when the call could not be done.
  const RegistrationResult& result() const { return result_; }
  // Of the last align(): OK also when the pose was rejected; the error of RegisterScans when the call could not be
  // done, for example INVALID_ARGUMENT for a cloud of too few points or a guess that is not rigid.
  const absl::Status& status() const { return status_; }

  // After an empty cloud there is none: align() prints PCL's error, and hasConverged() is false. PCL's own methods keep
  // the cloud before and go on with it.
  void setInputSource(const PointCloudSourceConstPtr& cloud) override {
    Base::setInputSource(cloud);
    if (!cloud->empty()) return;
    Base::input_.reset();
    Clear();
  }
  void setInputTarget(const PointCloudTargetConstPtr& cloud) override {
    prepared_target_.reset();
    Base::setInputTarget(cloud);
    if (!cloud->empty()) return;
    Base::target_.reset();
    Clear();
  }

 protected:
  // `output` holds the points of the source that the indices select.
  void computeTransformation(PointCloudSource& output, const Matrix4& guess) override {
    Clear();
    absl::StatusOr<RegistrationResult> result = Register(std::make_shared<const Scan>(ScanFromPcl(output)), guess);
    if (!result.ok()) {
      status_ = result.status();
      PCL_ERROR("[curvereg::%s::align] %s\n", Base::getClassName().c_str(), std::string(status_.message()).c_str());
      return;
    }
    result_ = *std::move(result);
    if (!result_.verdict.accepted) return;
    Base::converged_ = true;
    Base::final_transformation_ = Base::transformation_ = result_.T_target_source->matrix().cast<float>();
    if constexpr (pcl::traits::has_normal_v<PointSource>) {
      pcl::transformPointCloudWithNormals(output, output, Base::final_transformation_);
    } else {
      pcl::transformPointCloud(output, output, Base::final_transformation_);
    }
  }

 private:
  // As before the first align().
  void Clear() {
    result_ = RegistrationResult();
    status_ = absl::OkStatus();
    Base::converged_ = false;
    Base::final_transformation_ = Base::transformation_ = Matrix4::Identity();
  }

  absl::StatusOr<RegistrationResult> Register(std::shared_ptr<const Scan> source, const Matrix4& guess) {
    RegistrationOptions options = options_;
    if (guess != Matrix4::Identity()) {
      RigidTransform T_target_source;
      T_target_source.matrix() = guess.template cast<double>();
      constexpr double kTolerance = 1e-3;  // of floats that went through many products
      if (!IsRigid(T_target_source, kTolerance))
        return absl::InvalidArgumentError("the guess is not a rigid transform");
      if (!options.prior.has_value()) options.prior.emplace();
      options.prior->T_target_source = Orthonormalised(T_target_source);
    }
    if (options.method != Method::kCurvelet && options.method != Method::kIcp) {  // the others prepare nothing
      return RegisterScans(*source, ScanFromPcl(*Base::target_), options);
    }
    PreparationOptions preparation;
    preparation.limits = options.limits;
    const auto prepare_source = [&](const Stop& stop) -> absl::StatusOr<std::shared_ptr<const PreparedScan>> {
      return PreparedScan::Create(source, preparation, stop);
    };
    const auto prepare_target = [&](const Stop& stop) -> absl::StatusOr<std::shared_ptr<const PreparedScan>> {
      if (prepared_target_ != nullptr) return prepared_target_;
      auto target = PreparedScan::Create(std::make_shared<const Scan>(ScanFromPcl(*Base::target_)), preparation, stop);
      if (!target.ok()) return target.status();
      prepared_target_ = *std::move(target);
      return prepared_target_;
    };
    return PrepareAndRegister(prepare_source, prepare_target, options);
  }

  RegistrationOptions options_;
  RegistrationResult result_;
  absl::Status status_;
  std::shared_ptr<const PreparedScan> prepared_target_;  // of target_; null until it is needed
};
// NOLINTEND(readability-identifier-naming)

}  // namespace curvereg

#endif  // CURVEREG_CLIENT_PCL_REGISTRATION_H_
