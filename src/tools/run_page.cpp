// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include "rgbd_sfm_fusion/tools/run_page.h"

#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <stdexcept>
#include <utility>

namespace rgbd_sfm_fusion {
namespace {

namespace fs = std::filesystem;

/// The script is beside this program, installed or as a hidden link (cmake/Install.cmake).
std::string findProgram() {
  const fs::path folder = fs::read_symlink("/proc/self/exe").parent_path();
  for (const char* name : {"report_run", ".report_run"}) {
    if (fs::exists(folder / name)) return (folder / name).string();
  }
  throw std::runtime_error("there is no report_run in " + folder.string() +
                           ", which makes the page of --report: build or install the whole package");
}

/// @return the program's exit status; its output goes where ours does
int call(const std::vector<std::string>& words) {
  std::vector<char*> arguments;
  for (const std::string& word : words) arguments.push_back(const_cast<char*>(word.c_str()));
  arguments.push_back(nullptr);
  const pid_t child = fork();
  if (child < 0) throw std::runtime_error("cannot start " + words.front() + ": " + std::strerror(errno));
  if (child == 0) {
    execv(arguments.front(), arguments.data());
    constexpr int kCannotExecute = 126;  // the status that a shell gives
    _exit(kCannotExecute);
  }
  int status = 0;
  while (waitpid(child, &status, 0) < 0 && errno == EINTR) {
  }
  return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

}  // namespace

RunPage::RunPage(std::string path, std::string truth)
    : path_(std::move(path)), truth_(std::move(truth)), program_(findProgram()) {
  if (call(withTruth({program_, "--check", "--output", path_})) != 0)
    throw std::runtime_error("there can be no page, so nothing is done: see above, or leave out --report");
}

void RunPage::make(const std::string& bag, const std::string& results) const {
  if (call(withTruth({program_, bag, "--results", results, "--output", path_})) != 0)
    throw std::runtime_error("the run is complete in " + bag + " and " + results +
                             ", but it has no page: see above");
}

std::vector<std::string> RunPage::withTruth(std::vector<std::string> words) const {
  if (!truth_.empty()) words.insert(words.end(), {"--truth", truth_});
  return words;
}

const std::vector<std::string>& RunPage::topics() {
  static const std::vector<std::string> topics = {"/fusion/sfm_depth", "/fusion/sfm_variance",
                                                  "/fusion/image_rect"};
  return topics;
}

}  // namespace rgbd_sfm_fusion
