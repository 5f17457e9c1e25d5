// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_StudyCharts.hpp"

#include <cstdlib>
#include <filesystem>

namespace Harmos::study {
namespace {

// For the shell, whatever it holds.
std::string quoted(const std::string& word) {
  std::string result = "'";
  for (char c : word)
    result += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return result + "'";
}

bool succeeds(const std::string& command) {
  return std::system(command.c_str()) == 0;
}

// Beside this program, in the build tree and in an installed one, wherever it was moved to.
std::string toolOfCharts() {
  std::error_code failure;
  const std::filesystem::path program = std::filesystem::read_symlink("/proc/self/exe", failure);
  return failure ? "" : (program.parent_path() / "harmos-study-plot").string();
}

} // namespace

bool drawCharts(const std::string& directory, const Log& log) {
  const std::string tool = toolOfCharts();
  // Debian's own interpreter first: it is the one that sees Debian's python3-* packages.
  for (const std::string python : {"/usr/bin/python3", "python3"}) {
    if (!std::filesystem::exists(tool) || !succeeds(python + " -c 'import matplotlib' > /dev/null 2>&1"))
      continue;
    if (succeeds(python + " " + quoted(tool) + " " + quoted(directory) + " > /dev/null"))
      return true;
  }
  log.info("No charts (Python with Matplotlib is missing); draw them with harmos-study-plot " +
           quoted(directory));
  return false;
}

} // namespace Harmos::study
