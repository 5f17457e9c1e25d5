// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_DualPreconditioner.hpp"
#include "Harmos_LocalInverses.hpp"
#include "Harmos_ParameterSpec.hpp"
#include "Harmos_Scene.hpp"

#include <Teuchos_ParameterList.hpp>

#include <optional>
#include <string>

namespace Harmos::scene {

/// The list "Dual operator" of a deck: how products with F and with its preconditioner are made.
struct DualOptions {
  std::optional<feti::DualForm> form; ///< nothing: by the cost model
  feti::LocalInverseOptions inverses; ///< its form is decided by the run
  feti::PreconditionerKind preconditioner = feti::PreconditionerKind::Dirichlet;
  /// Null: stiffness where materials differ from body to body or region to region, else multiplicity.
  std::optional<feti::PreconditionerScaling> scaling;
  feti::PreconditionerScaling scalingFor(const Scene& scene) const;
  int expectedProducts = 0; ///< 0: 30 for membranes, 100 for elastic bodies
  int memoryBudgetMiB = 0;

  /// Adds the list to the specification of a deck.
  static void addTo(ParameterSpec& deck);
  /// From a validated list.
  static DualOptions fromList(const Teuchos::ParameterList& list);

  /// "condensed, double, Dirichlet": what a run used, for its summary.
  std::string describe(feti::DualForm used) const;
};

} // namespace Harmos::scene
