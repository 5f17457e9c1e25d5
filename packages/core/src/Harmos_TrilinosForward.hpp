// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// Declarations of Tpetra's classes without their headers.
///
/// Tpetra's own *_fwd.hpp include all of Kokkos, 100 000 lines, for the name of one class: the default node. Where
/// that is the serial one of Trilinos 13, it is declared here. In all other installations Tpetra's header is
/// included; the program is the same, it compiles for longer. Harmos_Version.cpp asserts that the types agree.

#include <KokkosClassic_DefaultNode_config.h>
#include <TpetraCore_config.h>
#include <Trilinos_version.h>

#if TRILINOS_MAJOR_VERSION == 13 && defined(HAVE_TPETRA_DEFAULTNODE_SERIALWRAPPERNODE) && \
    defined(HAVE_TPETRA_INST_INT_LONG_LONG)

namespace Kokkos {
class Serial;
class HostSpace;
namespace Compat {
template<class ExecutionSpace, class MemorySpace>
class KokkosDeviceWrapperNode;
}
} // namespace Kokkos

namespace Harmos::Details {
using LocalOrdinal = int;
using GlobalOrdinal = long long;
using Node = Kokkos::Compat::KokkosDeviceWrapperNode<Kokkos::Serial, Kokkos::HostSpace>;
} // namespace Harmos::Details

namespace Tpetra {
template<class LocalOrdinal, class GlobalOrdinal, class Node>
class Map;
template<class LocalOrdinal, class GlobalOrdinal, class Node>
class Import;
template<class LocalOrdinal, class GlobalOrdinal, class Node>
class Export;
template<class Scalar, class LocalOrdinal, class GlobalOrdinal, class Node>
class MultiVector;
template<class Scalar, class LocalOrdinal, class GlobalOrdinal, class Node>
class Operator;
template<class Scalar, class LocalOrdinal, class GlobalOrdinal, class Node>
class CrsMatrix;
} // namespace Tpetra

#else

#include <Tpetra_CrsMatrix_fwd.hpp>
#include <Tpetra_Details_DefaultTypes.hpp>
#include <Tpetra_Export_fwd.hpp>
#include <Tpetra_Import_fwd.hpp>
#include <Tpetra_Map_fwd.hpp>
#include <Tpetra_MultiVector_fwd.hpp>
#include <Tpetra_Operator_fwd.hpp>

namespace Harmos::Details {
using LocalOrdinal = Tpetra::Details::DefaultTypes::local_ordinal_type;
using GlobalOrdinal = Tpetra::Details::DefaultTypes::global_ordinal_type;
using Node = Tpetra::Details::DefaultTypes::node_type;
} // namespace Harmos::Details

#endif
