// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace Harmos::run {

/// Peak of the resident memory of this process in MiB, from the kernel's accounting; 0 where there is none.
/// Local.
double peakMemoryMiB();

} // namespace Harmos::run
