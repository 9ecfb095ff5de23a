// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "program/command_syntax.h"

#include <CLI/App.hpp>
#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>
#include <algorithm>
#include <cstdint>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace curvereg {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::Not;

class CommandSyntaxTest : public ::testing::Test {
 protected:
  void Parse(std::vector<std::string> arguments) {
    std::reverse(arguments.begin(), arguments.end());  // as CLI11 expects them
    app_.parse(arguments);
  }
  std::string Help() { return app_.help(); }

  CLI::App app_{"test", "test"};
  CommandSyntax syntax_{app_};
};

TEST_F(CommandSyntaxTest, ReadsValuesOfEveryKind) {
  std::string text;
  std::vector<std::string> words;
  double number = 0.0;
  int count = 0;
  std::uint32_t small = 0;
  std::uint64_t large = 0;
  bool flag = false;
  syntax_.AddOption("--text", text, "");
  syntax_.AddOption("WORDS", words, "");
  syntax_.AddOption("--number", number, "");
  syntax_.AddOption("--count", count, "");
  syntax_.AddOption("--small", small, "");
  syntax_.AddOption("--large", large, "");
  syntax_.AddFlag("--flag", flag, "");
  Parse({"one", "two", "--text", "a b", "--number", "-1.5", "--count", "-7", "--small", "4294967295", "--large",
         "18446744073709551615", "--flag"});
  EXPECT_EQ(text, "a b");
  EXPECT_THAT(words, ElementsAre("one", "two"));
  EXPECT_EQ(number, -1.5);
  EXPECT_EQ(count, -7);
  EXPECT_EQ(small, 4294967295U);
  EXPECT_EQ(large, 18446744073709551615U);
  EXPECT_TRUE(flag);
}

TEST_F(CommandSyntaxTest, ValuesThatAreNotGivenStay) {
  int count = 3;
  syntax_.AddOption("--count", count, "");
  Parse({});
  EXPECT_EQ(count, 3);
}

TEST_F(CommandSyntaxTest, SettersAndActionsAreCalledWhenGiven) {
  std::vector<int> values;
  int calls = 0;
  syntax_.AddSetter<int>(
      "--value", [&](const int& value) { values.push_back(value); }, "");
  syntax_.AddFlagAction("--act", [&] { ++calls; });
  Parse({"--value", "5"});
  EXPECT_THAT(values, ElementsAre(5));
  EXPECT_EQ(calls, 0);
  Parse({"--act"});
  EXPECT_EQ(calls, 1);
}

TEST_F(CommandSyntaxTest, RefusesWhatIsNotAllowed) {
  int count = 0;
  double share = 0.0;
  std::string kind;
  std::string other;
  std::string checked;
  const OptionSyntax option = syntax_.AddOption("--kind", kind, "").OneOf({"a", "b"});
  syntax_.AddOption("--count", count, "").Within(0, 4);
  syntax_.AddOption("--share", share, "").Within(0.0, 1.0);
  syntax_.AddOption("--other", other, "").Excludes(option);
  syntax_.AddOption("--checked", checked, "").Check([](const std::string& text) {
    return std::string(text == "good" ? "" : "must be good");
  });
  EXPECT_THROW(Parse({"--kind", "c"}), CLI::ValidationError);
  EXPECT_THROW(Parse({"--count", "5"}), CLI::ValidationError);
  EXPECT_THROW(Parse({"--share", "1.5"}), CLI::ValidationError);
  EXPECT_THROW(Parse({"--checked", "bad"}), CLI::ValidationError);
  EXPECT_THROW(Parse({"--kind", "a", "--other", "x"}), CLI::ExcludesError);
  EXPECT_NO_THROW(Parse({"--kind", "b", "--count", "4", "--share", "1", "--checked", "good"}));
  EXPECT_EQ(kind, "b");
}

TEST_F(CommandSyntaxTest, RequiresWhatIsRequired) {
  std::string name;
  syntax_.AddOption("NAME", name, "").Required();
  EXPECT_THROW(Parse({}), CLI::RequiredError);
}

TEST_F(CommandSyntaxTest, KnowsWhichCommandWasNamed) {
  CommandSyntax outer = syntax_.AddCommand("outer", "");
  outer.AddCommand("first", "");
  outer.AddCommand("second", "");
  outer.RequireCommand();
  CommandSyntax other = syntax_.AddCommand("other", "");
  EXPECT_THROW(Parse({"outer"}), CLI::RequiredError);
  Parse({"outer", "second"});
  EXPECT_TRUE(outer.WasNamed());
  EXPECT_TRUE(outer.WasNamed("second"));
  EXPECT_FALSE(outer.WasNamed("first"));
  EXPECT_FALSE(other.WasNamed());
}

TEST_F(CommandSyntaxTest, TheHelpShowsWhatWasDeclared) {
  int count = 12;
  bool hidden = false;
  syntax_.AddOption("--count", count, "how many").Within(0, 99).ShowDefault().ValueName("N").Group("Numbers");
  syntax_.AddFlag("--hidden", hidden, "not shown").Group("");
  syntax_.SetFooter("the last line");
  EXPECT_THAT(Help(), HasSubstr("--count N"));
  EXPECT_THAT(Help(), HasSubstr("12"));
  EXPECT_THAT(Help(), HasSubstr("how many"));
  EXPECT_THAT(Help(), HasSubstr("Numbers"));
  EXPECT_THAT(Help(), HasSubstr("the last line"));
  EXPECT_THAT(Help(), Not(HasSubstr("hidden")));
}

TEST_F(CommandSyntaxTest, ReadsTheEnvironmentWhereAnOptionIsNotGiven) {
  std::string server = "default";
  syntax_.AddOption("--server", server, "").Environment("CURVEREG_COMMAND_SYNTAX_TEST");
  setenv("CURVEREG_COMMAND_SYNTAX_TEST", "from the environment", 1);
  Parse({});
  EXPECT_EQ(server, "from the environment");
  Parse({"--server", "given"});
  EXPECT_EQ(server, "given");
  unsetenv("CURVEREG_COMMAND_SYNTAX_TEST");
}

}  // namespace
}  // namespace curvereg
