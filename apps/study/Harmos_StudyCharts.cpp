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

// Of an installed program beside it, prefix/share/harmos/tools, wherever the prefix was moved to; else that
// of the sources.
std::string scriptOf(const std::string& name) {
  std::error_code failure;
  const std::filesystem::path program = std::filesystem::read_symlink("/proc/self/exe", failure);
  const std::filesystem::path installed =
      program.parent_path().parent_path() / "share" / "harmos" / "tools" / name;
  return !failure && std::filesystem::exists(installed) ? installed.string() : HARMOS_TOOLS_DIR "/" + name;
}

} // namespace

bool drawCharts(const std::string& directory, const Log& log) {
  const std::string script = scriptOf("plot_study.py");
  // Debian's own interpreter first: it is the one that sees Debian's python3-* packages.
  for (const std::string python : {"/usr/bin/python3", "python3"}) {
    if (!std::filesystem::exists(script) || !succeeds(python + " -c 'import matplotlib' > /dev/null 2>&1"))
      continue;
    if (succeeds(python + " " + quoted(script) + " " + quoted(directory) + " > /dev/null"))
      return true;
  }
  log.info("The charts are not drawn (Python with Matplotlib is needed): python3 docs/tools/plot_study.py " +
           quoted(directory));
  return false;
}

} // namespace Harmos::study
