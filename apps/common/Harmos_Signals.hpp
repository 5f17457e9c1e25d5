// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_RunOptions.hpp"

namespace Harmos::app {

/// What signals told this process while an object of this class lives: SIGUSR1 and SIGTERM to write a
/// checkpoint and stop, SIGUSR2 to write one and go on. Batch systems send the first two when the time is up;
/// Open MPI's mpirun hands all three on to its ranks. A limit of the size of files (SIGXFSZ) does not end the
/// program any more: the write fails, as on a full disk. One object at a time.
class Signals {
 public:
  Signals();
  /// Puts back what the signals did before.
  ~Signals();
  Signals(const Signals&) = delete;
  Signals& operator=(const Signals&) = delete;

  /// Since the last call; a wish to stop stays.
  static run::Told told();
};

} // namespace Harmos::app
