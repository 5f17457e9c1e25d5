// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_FormChoice.hpp"
#include "Harmos_RunOptions.hpp"
#include "Harmos_Scene.hpp"

#include <Teuchos_Comm.hpp>
#include <Teuchos_RCP.hpp>

#include <array>
#include <vector>

namespace Harmos::plan {

/// What the plan of a run has to know of a subdomain.
struct SurveyedSubdomain {
  // Numbers of the objects that it shares with others that are equal; see PlanSurvey.
  int mesh = 0, stiffness = 0, matrix = 0;
  int rows = 0, kernelColumns = 0, nodes = 0, nodesPerCell = 0, cells = 0;
  double ownBytes = 0.0; ///< of what nothing shares: numbers, named parts, its own load, its contact points
  double constraintEntries = 0.0; ///< of B_i
  double touchedRows = 0.0;       ///< of B_i
  double ownedRows = 0.0;         ///< dual rows of which it is the lowest subdomain
  double coarseEntries = 0.0;     ///< of G̃ in its own rows
  double coarsePairs = 0.0;       ///< pairs of such entries in a row: terms of G̃G̃ᵀ
  bool hasCentre = false;
  std::array<double, 3> centre{};
};

/// A scene, assembled and counted but not factored. The same on all ranks, whatever their number.
///
/// Equal objects of different ranks (meshes, stiffness matrices, and those with Dirichlet conditions) are
/// recognised by their shapes, the hash of their pattern and weighted sums of their values.
struct PlanSurvey {
  std::vector<SurveyedSubdomain> subdomains; ///< by number
  std::vector<std::vector<int>> boundaries;  ///< by number: dofs that B touches, and what holds the kernel
  std::vector<double> meshBytes, stiffnessBytes, matrixBytes; ///< of the distinct objects, by their numbers
  /// Of the distinct matrices with the union of their boundaries, by the symbolic analysis of Harmos' own
  /// multifrontal factorisation (feti::FrontTree), whatever solver the deck asks for. Of more than 64
  /// matrices, 64 are analysed; the others are scaled by n.
  std::vector<feti::FactorizationEstimate> matrices;
  int dimension = 2;      ///< of space
  int rigidBodyModes = 3; ///< of a free subdomain

  long long primalDimension = 0, dualDimension = 0, inequalities = 0;
  long long limited = 0; ///< rows of friction
  int kernelDimension = 0, coarseDimension = 0;
  double coarseFactorEntries = 0.0; ///< of L, LLᵀ = G̃G̃ᵀ
  bool coarseIsDense = true;
  long long steps = 1; ///< of the run

  int ranks = 1;                ///< that made the survey
  double secondsOfMeshes = 0.0; ///< on the slowest rank
  double secondsOfAssembly = 0.0;
  double secondsOfConstraints = 0.0;
  double secondsOfCoarseRows = 0.0;   ///< G̃, the pattern of G̃G̃ᵀ and its values
  double secondsOfCoarseFactor = 0.0; ///< L, which each rank computes whole
};

/// Meshes, assembles and sets up constraints and the coarse problem as a run does, and counts. Only the
/// coarse matrix is factored.
/// @throws as a run up to there. @note Collective.
PlanSurvey survey(const Teuchos::RCP<const Teuchos::Comm<int>>& comm, const scene::Scene& scene,
                  const run::RunOptions& options);

} // namespace Harmos::plan
