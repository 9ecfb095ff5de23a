// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// The arguments of a program, for curvereg-server and curvereg alike.
#ifndef CURVEREG_PROGRAM_PROGRAM_ARGUMENTS_H_
#define CURVEREG_PROGRAM_PROGRAM_ARGUMENTS_H_

#include <string>

namespace CLI {
class App;
}  // namespace CLI

namespace curvereg {

// As app.parse(argc, argv), but `--name=` gives the option an empty value; CLI11 alone takes the next argument for it,
// so that a script's `--data-dir=$UNSET` would swallow a flag. Throws CLI::ParseError, also for a switch with `=` and
// nothing after it.
void ParseArguments(CLI::App& app, int argc, const char* const* argv);

// Check of an option's text, as CLI11 asks for it: empty when it may pass, else what is wrong.
std::string CheckNotEmpty(const std::string& text);

}  // namespace curvereg

#endif  // CURVEREG_PROGRAM_PROGRAM_ARGUMENTS_H_
