// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_StudyRun.hpp"

#include <array>
#include <map>
#include <memory>

namespace Harmos::study {

/// What errors are measured in, in this order: energy norm, displacement in L2, contact pressure in L2, size
/// of the contact zone; with friction also slip in L2, size of the zone that sticks.
constexpr std::size_t measures = 6;
/// How many of them a study has: those of friction only where its scene has it.
std::size_t measuresOf(const Plan& plan);
extern const std::array<std::string, measures> measureNames;  ///< "contact_zone": in tables
extern const std::array<std::string, measures> measureTitles; ///< "size of the contact zone": in sentences
using Errors = std::array<double, measures>;

/// Relative errors of a run, NaN where there is nothing to measure; all relative to the reference's norms.
struct ErrorParts {
  Errors total;          ///< run − reference
  Errors discretisation; ///< tight run on the same mesh − reference
  Errors solver;         ///< run − tight run on the same mesh with the same local solver
  Errors local;          ///< tight run with this local solver − tight run with an exact one
  double tightTolerance; ///< that the tight run reached
};

/// Errors of runs of one study against its reference, told apart.
///
/// Reference, tight runs and comparisons are made when they are first asked for; those of the last scene
/// alone are kept. The reference's own error is Richardson's estimate from three meshes: with differences d₁
/// = ‖u_coarser − u_finest‖ and d₂ = ‖u_coarsest − u_coarser‖ of one rate, e = d₁²/(d₂ − d₁) = d₁/(d₂/d₁ −
/// 1). The ratio d₂/d₁ is taken within [√2, 8]: half an order to three orders, if meshes are halved. Sizes of
/// zones, in contact or sticking, are sums of the areas of whole points: they are known to half the largest
/// area of one of these at best.
class ErrorJudge {
 public:
  ErrorJudge(const Teuchos::RCP<const Teuchos::Comm<int>>& comm, const Plan& plan, const Log& log);

  /// Of a run of which nothing is known.
  static ErrorParts unknown();

  /// @throws NumericalError on all ranks if the reference or a tight run has no solution. @note Collective.
  ErrorParts partsOf(const Setting& setting, const Outcome& outcome);

  /// Relative, of the reference itself. @note Collective when first asked for.
  const Errors& referenceErrors();

 private:
  struct Tight {
    std::shared_ptr<const run::FinishedRun> run;
    double tolerance;
  };
  using Sizes = std::shared_ptr<const fem::SizeField>;
  Tight tightRun(std::vector<std::string> assignments, const std::string& what, const Sizes& sizes) const;
  void makeReference();
  void turnTo(const Setting& setting, const Sizes& sizes);
  Errors relative(const run::SolutionNorms& norms) const;

  Teuchos::RCP<const Teuchos::Comm<int>> comm_;
  const Plan& plan_;
  const Log& log_;
  std::shared_ptr<const run::FinishedRun> reference_;
  run::SolutionNorms norms_;
  Errors own_{};
  // Of the present scene.
  std::vector<std::string> scene_;
  Sizes sizes_;
  Tight tight_;
  std::unique_ptr<const run::SolutionComparison> comparison_;
  Errors discretisation_{};
  std::map<std::vector<std::string>, Tight> inexact_; ///< tight runs by local solver
};

} // namespace Harmos::study
