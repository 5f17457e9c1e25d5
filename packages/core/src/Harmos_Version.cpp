// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_Version.hpp"

#include "Harmos_GitHash.hpp"
#include "Harmos_Types.hpp"

#include <Tpetra_Details_DefaultTypes.hpp>

#include <type_traits>

namespace Harmos {

// What Harmos_TrilinosVersion.hpp declares is what Tpetra has.
static_assert(std::is_same_v<LocalOrdinal, Tpetra::Details::DefaultTypes::local_ordinal_type>);
static_assert(std::is_same_v<GlobalOrdinal, Tpetra::Details::DefaultTypes::global_ordinal_type>);
static_assert(std::is_same_v<Node, Tpetra::Details::DefaultTypes::node_type>);

std::string version() {
  return HARMOS_VERSION;
}

std::string gitHash() {
  return HARMOS_GIT_HASH;
}

} // namespace Harmos
