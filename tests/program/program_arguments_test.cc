// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "program/program_arguments.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <CLI/App.hpp>
#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>

#include <string>
#include <vector>

namespace curvereg {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

// A program with a command, as both programs have them.
class ProgramArgumentsTest : public ::testing::Test {
 protected:
  ProgramArgumentsTest() {
    app_.add_option("--server", server_);
    app_.add_option("--token", token_);
    app_.add_flag("--switch", is_on_);
    command_->add_option("FILE", files_);
    command_->add_option("--out", out_)->check(CheckNotEmpty);
    command_->add_option("--count", count_);
  }
  // What is wrong, or empty.
  std::string Parse(std::vector<const char*> arguments) {
    arguments.insert(arguments.begin(), "program");
    try {
      ParseArguments(app_, static_cast<int>(arguments.size()), arguments.data());
    } catch (const CLI::ParseError& error) {
      return error.what();
    }
    return "";
  }

  CLI::App app_{"a program", "program"};
  CLI::App* command_ = app_.add_subcommand("send", "a command");
  std::string server_ = "unset", token_ = "unset", out_ = "unset";
  std::vector<std::string> files_;
  int count_ = -1;
  bool is_on_ = false;
};

TEST_F(ProgramArgumentsTest, AnEmptyValueTakesNoOtherArgument) {
  EXPECT_EQ(Parse({"--server=", "--token=t", "send", "--count=3", "a", "b"}), "");
  EXPECT_EQ(server_, "");
  EXPECT_EQ(token_, "t");
  EXPECT_THAT(files_, ElementsAre("a", "b"));
}

TEST_F(ProgramArgumentsTest, AnEmptyValueMayComeLast) {
  EXPECT_EQ(Parse({"send", "a", "--count=3", "--out=x"}), "");
  EXPECT_EQ(Parse({"--server="}), "");
  EXPECT_EQ(server_, "");
}

TEST_F(ProgramArgumentsTest, TheOptionJudgesItsEmptyValue) {
  EXPECT_EQ(Parse({"send", "--out=", "a"}), "--out: must not be empty");
  EXPECT_EQ(Parse({"send", "--out", "", "a"}), "--out: must not be empty");
}

TEST_F(ProgramArgumentsTest, ASwitchHasNoEmptyValue) {
  EXPECT_EQ(Parse({"--switch="}), "--switch: expected true or false, not \"\"");
  EXPECT_EQ(Parse({"--switch=false"}), "");
  EXPECT_FALSE(is_on_);
  EXPECT_EQ(Parse({"--switch"}), "");
  EXPECT_TRUE(is_on_);
}

TEST_F(ProgramArgumentsTest, ValuesAndWhatFollowsTwoDashesStayAsTheyAre) {
  EXPECT_EQ(Parse({"--server", "--token=", "send", "--out", "send", "--", "--out="}), "");
  EXPECT_EQ(server_, "--token=");
  EXPECT_EQ(token_, "unset");
  EXPECT_EQ(out_, "send");
  EXPECT_THAT(files_, ElementsAre("--out="));
}

TEST_F(ProgramArgumentsTest, UnknownOptionsAreNamedAsTheyWereGiven) {
  EXPECT_THAT(Parse({"--nonsense=", "send"}), HasSubstr("--nonsense="));
  EXPECT_THAT(Parse({"--count="}), HasSubstr("--count="));  // of the command only
}

TEST_F(ProgramArgumentsTest, NothingAtAllIsNoArgument) {
  ParseArguments(app_, 0, nullptr);
  EXPECT_EQ(server_, "unset");
}

}  // namespace
}  // namespace curvereg
