// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Tpetra_Details_DefaultTypes.hpp>
#include <Tpetra_Map_fwd.hpp>
#include <Tpetra_MultiVector_fwd.hpp>
#include <Tpetra_Operator_fwd.hpp>

namespace Harmos {

/// The one set of types Harmos is instantiated for: Tpetra's defaults, whatever the installation chose.
using Scalar = double;
using LocalOrdinal = Tpetra::Details::DefaultTypes::local_ordinal_type;
using GlobalOrdinal = Tpetra::Details::DefaultTypes::global_ordinal_type;
using Node = Tpetra::Details::DefaultTypes::node_type;

using Map = Tpetra::Map<LocalOrdinal, GlobalOrdinal, Node>;
using MultiVector = Tpetra::MultiVector<Scalar, LocalOrdinal, GlobalOrdinal, Node>;
using Operator = Tpetra::Operator<Scalar, LocalOrdinal, GlobalOrdinal, Node>;

} // namespace Harmos
