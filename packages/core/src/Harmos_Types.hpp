// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_TrilinosVersion.hpp"

namespace Harmos {

/// The one set of types Harmos is instantiated for: Tpetra's defaults, whatever the installation chose.
///
/// Tpetra's classes are only declared here. A source file that uses one of them includes its header; one that
/// passes pointers to them does not.
using Scalar = double;
using LocalOrdinal = Details::LocalOrdinal;
using GlobalOrdinal = Details::GlobalOrdinal;
using Node = Details::Node;

using Map = Tpetra::Map<LocalOrdinal, GlobalOrdinal, Node>;
using MultiVector = Tpetra::MultiVector<Scalar, LocalOrdinal, GlobalOrdinal, Node>;
using Operator = Tpetra::Operator<Scalar, LocalOrdinal, GlobalOrdinal, Node>;
using CrsMatrix = Tpetra::CrsMatrix<Scalar, LocalOrdinal, GlobalOrdinal, Node>;
using Import = Tpetra::Import<LocalOrdinal, GlobalOrdinal, Node>;

} // namespace Harmos
