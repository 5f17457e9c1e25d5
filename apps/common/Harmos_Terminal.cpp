// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_Terminal.hpp"

#include <cstdlib>
#include <fcntl.h>
#include <string>
#include <sys/ioctl.h>
#include <unistd.h>

namespace Harmos::app {
namespace {

int widthOf(int file) {
  constexpr int usual = 80;
  if (::isatty(file) == 0)
    return 0;
  struct winsize size = {};
  const bool isKnown = ::ioctl(file, TIOCGWINSZ, &size) == 0 && size.ws_col > 1;
  return isKnown ? size.ws_col - 1 : usual - 1;
}

} // namespace

int terminalWidth() {
  const int own = widthOf(STDOUT_FILENO);
  if (own == 0 || std::getenv("OMPI_COMM_WORLD_SIZE") == nullptr)
    return own;
  const std::string path = "/proc/" + std::to_string(::getppid()) + "/fd/1";
  const int file = ::open(path.c_str(), O_WRONLY | O_NOCTTY | O_NONBLOCK);
  if (file < 0)
    return 0;
  const int width = widthOf(file);
  ::close(file);
  return width;
}

} // namespace Harmos::app
