// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace Harmos::app {

/// Characters a line of the terminal that standard output is shown on; 0 if it is shown on none.
///
/// Under Open MPI every rank's standard output is a pseudo terminal, whether or not anybody sees it; what
/// counts is the standard output of the launcher, the parent process.
int terminalWidth();

} // namespace Harmos::app
