// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// The differences between Trilinos 13 and current Trilinos (16 and later), all of them, in one place.

#include <TpetraCore_config.h>
#include <Trilinos_version.h>
#if TRILINOS_MAJOR_VERSION == 13
#include <KokkosClassic_DefaultNode_config.h>
#endif

#include <cstddef>

/// Tpetra's own *_fwd.hpp include all of Kokkos, 100 000 lines, for the name of one class: the default node.
/// Where that is the serial one of Trilinos 13, the classes are declared here. In all other installations
/// Tpetra's headers are included; the program is the same, it compiles for longer. Harmos_Version.cpp asserts
/// that the types agree.
#if TRILINOS_MAJOR_VERSION == 13 && defined(HAVE_TPETRA_DEFAULTNODE_SERIALWRAPPERNODE) &&                    \
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

namespace Harmos {

/// Number of entries of the map on this rank: getNodeNumElements() was renamed in Trilinos 13.4.
template<class MapType>
std::size_t localSize(const MapType& map) {
#if TRILINOS_MAJOR_MINOR_VERSION >= 130400
  return map.getLocalNumElements();
#else
  return map.getNodeNumElements();
#endif
}

} // namespace Harmos
