// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Teuchos_Comm.hpp>
#include <Teuchos_RCP.hpp>

namespace Harmos {

/// The communicator of all ranks of a test.
Teuchos::RCP<const Teuchos::Comm<int>> testComm();

} // namespace Harmos
