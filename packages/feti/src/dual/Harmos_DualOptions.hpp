// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_DualPreconditioner.hpp"
#include "Harmos_LocalInverses.hpp"
#include "Harmos_Log.hpp"
#include "Harmos_ParameterSpec.hpp"

#include <Teuchos_ParameterList.hpp>

#include <optional>
#include <string>

namespace Harmos::feti {

/// The list "Dual operator" of a deck: how products with F and with its preconditioner are made.
struct DualOptions {
  std::optional<DualForm> form; ///< nothing: by the cost model
  LocalInverseOptions inverses; ///< its form is decided by the run
  PreconditionerKind preconditioner = PreconditionerKind::Dirichlet;
  /// Null: stiffness where materials differ from body to body or region to region, else multiplicity.
  std::optional<PreconditionerScaling> scaling;
  PreconditionerScaling scalingFor(bool hasSeveralMaterials) const;
  int expectedProducts = 0; ///< 0: 30 for membranes, 100 for elastic bodies
  int memoryBudgetMiB = 0;

  /// The options of local inverses, their form decided: as asked for, or by the cost model.
  /// @param usualProducts expected, where the options name none.
  /// @throws InputError on all ranks if nothing fits into the memory budget. @note Collective.
  LocalInverseOptions decided(const SubdomainSystem& system, const Constraints& constraints,
                              int usualProducts, const Log& log) const;

  /// Adds the list "Decomposition", how Dirichlet conditions are enforced, to a specification.
  static void addDecompositionTo(ParameterSpec& deck);
  static std::optional<DirichletForm> decompositionFrom(const Teuchos::ParameterList& list);

  /// Adds the list to the specification of a deck.
  static void addTo(ParameterSpec& deck);
  /// From a validated list.
  static DualOptions fromList(const Teuchos::ParameterList& list);

  /// "condensed, double, Dirichlet": what a run used, for its summary.
  std::string describe(DualForm used) const;
};

} // namespace Harmos::feti
