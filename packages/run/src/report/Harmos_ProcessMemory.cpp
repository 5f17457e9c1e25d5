// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_ProcessMemory.hpp"

#include <fstream>
#include <string>

namespace Harmos::run {

double peakMemoryMiB() {
  std::ifstream status("/proc/self/status");
  std::string word;
  while (status >> word)
    if (word == "VmHWM:") {
      double kib = 0.0;
      status >> kib;
      return kib / 1024.0;
    }
  return 0.0;
}

} // namespace Harmos::run
