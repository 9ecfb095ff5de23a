// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "wire/options_conversion.h"

#include <algorithm>
#include <cctype>
#include <functional>
#include <limits>
#include <string>

#include <gmock/gmock.h>

#include "core/methods/registration_names.h"
#include "tests/testing/matchers.h"
#include "tests/wire/conversion_samples.h"

namespace curvereg::wire {
namespace {

using ::curvereg::testing::IsNear;
using ::curvereg::testing::IsOk;
using ::testing::HasSubstr;

RegistrationOptions FullOptions() {
  RegistrationOptions options;
  options.method = Method::kIcp;
  options.prior = Prior{SomePose(), SomeCovariance()};
  options.seed = 0xFEDCBA9876543210ULL;
  options.num_threads = 3;
  options.time_budget_s = 1.75;
  return options;
}

// The wire name of a method is its command-line name in capitals.
TEST(OptionsConversionTest, EveryMethodHasItsNumber) {
  for (const Method method : AllMethods()) {
    std::string name = "METHOD_" + std::string(MethodName(method));
    std::transform(name.begin(), name.end(), name.begin(),
                   [](unsigned char c) { return c == '-' ? '_' : static_cast<char>(std::toupper(c)); });
    EXPECT_EQ(v1::Method_Name(ToWire(method)), name);
    const auto back = FromWire(ToWire(method));
    ASSERT_THAT(back, IsOk());
    EXPECT_EQ(*back, method);
  }
  EXPECT_EQ(AllMethods().size() + 1, static_cast<size_t>(v1::Method_ARRAYSIZE));
}

TEST(OptionsConversionTest, UnspecifiedMethodIsCurveletAndUnknownIsRefused) {
  const auto unspecified = FromWire(v1::METHOD_UNSPECIFIED);
  ASSERT_THAT(unspecified, IsOk());
  EXPECT_EQ(*unspecified, Method::kCurvelet);
  EXPECT_EQ(FieldOf(FromWire(static_cast<v1::Method>(99)).status()), "method");
}

TEST(OptionsConversionTest, OptionsComeBack) {
  const RegistrationOptions options = FullOptions();
  const auto back = FromWire(ToWire(options), 8);
  ASSERT_THAT(back, IsOk());
  EXPECT_EQ(back->method, options.method);
  ASSERT_TRUE(back->prior.has_value());
  EXPECT_THAT(back->prior->T_target_source, IsNear(SomePose(), 0.0, 1e-14));
  EXPECT_EQ(back->prior->covariance, options.prior->covariance);
  EXPECT_EQ(back->seed, options.seed);
  EXPECT_EQ(back->num_threads, 3);
  EXPECT_EQ(back->time_budget_s, options.time_budget_s);
}

TEST(OptionsConversionTest, EmptyOptionsAreTheDefaults) {
  const RegistrationOptions defaults;
  for (const auto& message : {v1::RegistrationOptions(), ToWire(defaults)}) {
    const auto options = FromWire(message, 0);
    ASSERT_THAT(options, IsOk());
    EXPECT_EQ(options->method, defaults.method);
    EXPECT_FALSE(options->prior.has_value());
    EXPECT_EQ(options->seed, defaults.seed);
    EXPECT_EQ(options->num_threads, defaults.num_threads);
    EXPECT_FALSE(options->time_budget_s.has_value());
  }
}

TEST(OptionsConversionTest, SeedZeroIsASeed) {
  v1::RegistrationOptions message;
  message.set_seed(0);
  const auto options = FromWire(message, 0);
  ASSERT_THAT(options, IsOk());
  EXPECT_EQ(options->seed, 0U);
}

TEST(OptionsConversionTest, ThreadsAreCutToTheBound) {
  const auto threads = [](uint32_t wanted, int bound) {
    v1::RegistrationOptions message;
    message.set_max_threads(wanted);
    const auto options = FromWire(message, bound);
    return options.ok() ? options->num_threads : -1;
  };
  EXPECT_EQ(threads(3, 8), 3);
  EXPECT_EQ(threads(9, 8), 8);
  EXPECT_EQ(threads(0, 8), 8);
  EXPECT_EQ(threads(0, 0), 0);
  EXPECT_EQ(threads(5, 0), 5);
  EXPECT_EQ(threads(0xFFFFFFFFU, 8), 8);
  EXPECT_EQ(threads(0xFFFFFFFFU, 0), std::numeric_limits<int>::max());
}

TEST(OptionsConversionTest, UnusableOptionsNameTheField) {
  const auto field_after = [](const std::function<void(v1::RegistrationOptions&)>& change) {
    v1::RegistrationOptions message = ToWire(FullOptions());
    change(message);
    return FieldOf(FromWire(message, 0).status());
  };
  EXPECT_EQ(field_after([](auto& m) { m.set_method(static_cast<v1::Method>(-1)); }), "method");
  EXPECT_EQ(field_after([](auto& m) { m.mutable_prior()->clear_t_target_source(); }), "prior.t_target_source");
  EXPECT_EQ(field_after([](auto& m) { m.mutable_prior()->mutable_t_target_source()->clear_rotation(); }),
            "prior.t_target_source.rotation");
  EXPECT_EQ(field_after([](auto& m) { m.mutable_prior()->mutable_covariance()->clear_upper_triangle(); }),
            "prior.covariance.upper_triangle");
  EXPECT_EQ(field_after([](auto& m) { m.mutable_time_budget()->Clear(); }), "time_budget");
  EXPECT_EQ(field_after([](auto& m) { m.mutable_time_budget()->set_seconds(-1); }), "time_budget");
  EXPECT_EQ(field_after([](auto& m) { m.mutable_time_budget()->set_nanos(2'000'000'000); }), "time_budget");
  EXPECT_EQ(field_after([](auto& m) { m.mutable_time_budget()->set_seconds(INT64_MAX); }), "time_budget");
}

TEST(OptionsConversionTest, BudgetsThatAreNoDurationsAreToldApart) {
  const auto message_of = [](int64_t seconds, int32_t nanos) {
    v1::RegistrationOptions message;
    message.mutable_time_budget()->set_seconds(seconds);
    message.mutable_time_budget()->set_nanos(nanos);
    return std::string(FromWire(message, 0).status().message());
  };
  EXPECT_THAT(message_of(1'000'000'000'000'000, 0), HasSubstr("10,000 years"));
  EXPECT_THAT(message_of(1, -1), HasSubstr("mixed signs"));
  EXPECT_THAT(message_of(1, 1'000'000'000), HasSubstr("nanos"));
  EXPECT_THAT(message_of(0, 0), HasSubstr("not above 0"));
  EXPECT_THAT(message_of(-1, -1), HasSubstr("not above 0"));
}

TEST(OptionsConversionTest, TinyBudgetsStayAboveZero) {
  RegistrationOptions options;
  options.time_budget_s = 1e-12;
  const auto back = FromWire(ToWire(options), 0);
  ASSERT_THAT(back, IsOk());
  EXPECT_EQ(back->time_budget_s, 1e-9);
}

}  // namespace
}  // namespace curvereg::wire
