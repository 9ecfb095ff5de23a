// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "eval/figures.h"

#include <fcntl.h>
#include <signal.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <filesystem>

#include "absl/strings/str_cat.h"
#include "absl/strings/strip.h"

extern char** environ;

namespace curvereg {
namespace {

namespace fs = std::filesystem;

// Exit status of the script if matplotlib is missing.
constexpr int kNoMatplotlib = 77;

std::vector<std::string> FiguresIn(const std::string& folder) {
  std::vector<std::string> names;
  std::error_code error;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder, error)) {
    const std::string name = entry.path().filename().string();
    if (name.starts_with("figure_") && name.ends_with(".png")) names.push_back(name);
  }
  std::sort(names.begin(), names.end());
  return names;
}

std::string ReadToEnd(int fd) {
  std::string text;
  char buffer[4096];
  for (;;) {
    const ssize_t count = read(fd, buffer, sizeof buffer);
    if (count < 0 && errno == EINTR) continue;
    if (count <= 0) return text;
    text.append(buffer, static_cast<std::size_t>(count));
  }
}

struct ProcessEnd {
  int exit_status = -1;  // -1: ended by a signal
  std::string messages;  // what it wrote to standard output and standard error
};

// Runs the program and waits for it. Its messages are caught: our standard output is for the result alone.
absl::StatusOr<ProcessEnd> Run(const std::vector<std::string>& arguments) {
  int ends[2];
  if (pipe2(ends, O_CLOEXEC) != 0) return absl::InternalError(absl::StrCat("pipe: ", std::strerror(errno)));
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_adddup2(&actions, ends[1], STDOUT_FILENO);
  posix_spawn_file_actions_adddup2(&actions, ends[1], STDERR_FILENO);
  posix_spawnattr_t attributes;  // our blocked signals must not be inherited, or ^C would not end it
  posix_spawnattr_init(&attributes);
  sigset_t none;
  sigemptyset(&none);
  posix_spawnattr_setsigmask(&attributes, &none);
  posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETSIGMASK);

  std::vector<char*> argv;
  for (const std::string& argument : arguments) argv.push_back(const_cast<char*>(argument.c_str()));
  argv.push_back(nullptr);
  pid_t child = 0;
  const int error = posix_spawn(&child, argv[0], &actions, &attributes, argv.data(), environ);
  posix_spawnattr_destroy(&attributes);
  posix_spawn_file_actions_destroy(&actions);
  close(ends[1]);
  ProcessEnd end;
  if (error == 0) end.messages = ReadToEnd(ends[0]);
  close(ends[0]);
  if (error != 0) return absl::FailedPreconditionError(absl::StrCat(arguments[0], ": ", std::strerror(error)));
  int status = 0;
  while (waitpid(child, &status, 0) < 0 && errno == EINTR) {
  }
  end.exit_status = WIFEXITED(status) ? WEXITSTATUS(status) : -1;
  return end;
}

std::string LastLine(const std::string& text) {
  const std::string stripped(absl::StripTrailingAsciiWhitespace(text));
  return stripped.substr(stripped.rfind('\n') + 1);  // npos + 1 is 0
}

std::string ScriptOf(Drawing drawing) {
  const char* name = drawing == Drawing::kTraverse ? "draw_traverse_report.py" : "draw_evaluation.py";
  std::error_code error;
  const fs::path executable = fs::read_symlink("/proc/self/exe", error);
  const fs::path installed = executable.parent_path() / "../share/curvereg" / name;
  if (fs::exists(installed, error)) return installed.lexically_normal().string();
  return (fs::path(CURVEREG_DRAW_FOLDER) / name).string();
}

// -B: nothing is to be left beside the scripts.
std::vector<std::string> CommandOf(const FigureOptions& options, const std::string& script, Drawing drawing,
                                   const std::string& folder) {
  std::vector<std::string> command = {options.python, "-B", script};
  if (drawing == Drawing::kPairEvaluation) command.push_back("pairs");
  if (drawing == Drawing::kTraverseEvaluation) command.push_back("traverse");
  command.push_back(folder);
  return command;
}

}  // namespace

absl::StatusOr<std::vector<std::string>> DrawFigures(const std::string& folder, Drawing drawing,
                                                     const FigureOptions& options) {
  std::error_code error;
  for (const std::string& name : FiguresIn(folder)) fs::remove(fs::path(folder) / name, error);

  const std::string script = options.script.empty() ? ScriptOf(drawing) : options.script;
  if (!fs::exists(options.python, error)) {
    return absl::FailedPreconditionError(
        absl::StrCat("no figures: ", options.python, " is missing (Debian: python3, python3-matplotlib)"));
  }
  if (!fs::exists(script, error)) {
    return absl::FailedPreconditionError(absl::StrCat("no figures: ", script, " is missing"));
  }
  const absl::StatusOr<ProcessEnd> end = Run(CommandOf(options, script, drawing, folder));
  if (!end.ok()) return absl::FailedPreconditionError(absl::StrCat("no figures: ", end.status().message()));
  if (end->exit_status == kNoMatplotlib) {
    return absl::FailedPreconditionError("no figures: matplotlib is missing (Debian: python3-matplotlib)");
  }
  if (end->exit_status != 0) {
    return absl::InternalError(absl::StrCat("no figures: ", script, " failed: ", LastLine(end->messages)));
  }
  return FiguresIn(folder);
}

}  // namespace curvereg
