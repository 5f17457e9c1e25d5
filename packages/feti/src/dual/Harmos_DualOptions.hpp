// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_ClusterChoice.hpp"
#include "Harmos_CoarseOptions.hpp"
#include "Harmos_Log.hpp"
#include "Harmos_ParameterSpec.hpp"
#include "Harmos_Rates.hpp"

#include <Teuchos_ParameterList.hpp>

#include <optional>
#include <string>

namespace Harmos::feti {

/// Which adaptive coarse vectors there are.
enum class AdaptiveVectors {
  OnDemand, ///< none, but those of all once the solver crawls
  None,
  All ///< from the first iteration on
};

struct AdaptiveOptions {
  AdaptiveVectors vectors = AdaptiveVectors::OnDemand;
  double threshold = 10.0; ///< of μ; see AdaptiveSpace
};

/// The list "Dual operator" of a deck: how products with F and with its preconditioner are made.
struct DualOptions {
  std::optional<DualForm> form; ///< nothing: by the cost model
  LocalInverseOptions inverses; ///< its form is decided by the run
  bool mayRound = false;        ///< products of the implicit form in single precision, where that is no loss
  std::optional<PreconditionerKind> preconditioner; ///< nothing: with the form, by the cost model
  /// Null: stiffness where materials differ from body to body or region to region, else multiplicity.
  std::optional<PreconditionerScaling> scaling;
  PreconditionerScaling scalingFor(bool hasSeveralMaterials, double contrast) const;
  /// Null: stiffness where subdomains differ in it by more than muchContrast, else none.
  std::optional<RowWeights> weights;
  /// @param contrast of the stiffness of subdomains, the largest over the smallest.
  RowWeights weightsFor(double contrast) const;
  /// Below, the orthogonal projector costs hardly a product: 18 at 1, 30 at 100 (docs/stability.md).
  static constexpr double muchContrast = 30.0;
  AdaptiveOptions adaptive;
  CoarseOptions coarse;     ///< of the list "Decomposition": coarseFrom()
  ClusterOptions clusters;  ///< likewise: clustersFrom()
  int expectedProducts = 0; ///< 0: as usual
  int memoryBudgetMiB = 0;
  Rates rates;                     ///< of the cost model
  std::optional<DualForms> before; ///< FormLimits::before

  /// With what the tolerance that is solved to says of them. @param tolerance 0: not known.
  LocalInverseOptions inversesFor(double tolerance) const;

  /// What was decided.
  struct Decided {
    LocalInverseOptions inverses;
    PreconditionerKind preconditioner;
    DualForms forms() const { return {inverses.form, preconditioner}; }
    /// Whether local factors are in single precision, as asked for.
    bool isSingle() const { return inverses.precision == Precision::Single; }
    /// That subdomains are joined to, of all ranks; 0: none.
    long long clusters() const { return inverses.clusters ? inverses.clusters->total() : 0; }
    /// "condensed, double, Dirichlet preconditioner": for a summary.
    std::string describe() const;
  };
  /// As asked for, or by the cost model.
  /// @param usualProducts expected, where the options name none. @param mayLump FormLimits::mayLump.
  /// @param tolerance as inversesFor().
  /// @throws InputError on all ranks if nothing fits into the memory budget. @note Collective.
  Decided decided(const SubdomainSystem& system, const Constraints& constraints, int usualProducts,
                  bool mayLump, const Log& log, double tolerance = 0.0) const;

  /// `clusters`, Auto decided. @param usualProducts as decided().
  /// @note Collective, as decideClusters().
  ClusterOptions clustersFor(const SubdomainSystem& system, const Constraints& constraints,
                             const Decided& decided, int usualProducts, const Log& log) const;

  /// Products that an elastic body, or a membrane, usually takes to a tolerance: eight or ten for each power
  /// of ten.
  static int usualProducts(bool isElastic, double tolerance);

  /// Adds the list "Decomposition", how Dirichlet conditions are enforced, to a specification.
  static void addDecompositionTo(ParameterSpec& deck);
  static std::optional<DirichletForm> decompositionFrom(const Teuchos::ParameterList& list);
  /// `coarse` with what that list says of it and the rates that are here.
  CoarseOptions coarseFrom(const Teuchos::ParameterList& decomposition) const;
  static ClusterOptions clustersFrom(const Teuchos::ParameterList& decomposition);

  /// Adds the list to the specification of a deck.
  static void addTo(ParameterSpec& deck);
  /// From a validated list. @throws InputError for a file of rates that says nothing of them.
  static DualOptions fromList(const Teuchos::ParameterList& list);
};

} // namespace Harmos::feti
