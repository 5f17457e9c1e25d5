// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_Signals.hpp"

#include <array>
#include <csignal>

namespace Harmos::app {
namespace {

volatile std::sig_atomic_t isToSave = 0, isToStop = 0;

void onSignal(int signal) {
  (signal == SIGUSR2 ? isToSave : isToStop) = 1;
}

constexpr std::array<int, 4> signals = {SIGUSR1, SIGUSR2, SIGTERM, SIGXFSZ};
std::array<struct sigaction, signals.size()> before;

} // namespace

Signals::Signals() {
  isToSave = isToStop = 0;
  struct sigaction action = {};
  action.sa_flags = SA_RESTART; // reads and writes that a signal meets go on
  for (std::size_t k = 0; k < signals.size(); ++k) {
    action.sa_handler = signals[k] == SIGXFSZ ? SIG_IGN : onSignal;
    sigaction(signals[k], &action, &before[k]);
  }
}

Signals::~Signals() {
  for (std::size_t k = 0; k < signals.size(); ++k)
    sigaction(signals[k], &before[k], nullptr);
}

run::Told Signals::told() {
  if (isToStop != 0)
    return run::Told::Stop;
  const bool save = isToSave != 0;
  isToSave = 0;
  return save ? run::Told::Save : run::Told::Nothing;
}

} // namespace Harmos::app
