// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace Harmos {

/// Spares the start of MPI what a run on one machine does not need; to be called before MPI_Init.
///
/// Open MPI looks for network hardware (0.2 s with release 4) even where all ranks share a machine, and a
/// program without a launcher starts a daemon, for processes that it might spawn (0.1 s). Where the launcher
/// says that all ranks are on one machine, or nothing says that there is a launcher, the shared memory is
/// named as the only transport. What the user has chosen (OMPI_MCA_pml, _mtl, _btl) stays, and ranks on
/// several machines, other launchers and other MPI libraries are left alone.
///
/// @note Sets environment variables of this process. Measured in docs/embedding.md.
void prepareMpiStart();

} // namespace Harmos
