// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_ClusterChoice.hpp"
#include "Harmos_PlanSurvey.hpp"
#include "Harmos_Rates.hpp"

namespace Harmos::plan {

/// Memory of a rank in bytes.
///
/// What the sources hold: packages/plan/src/Harmos_PlanCosts.cpp lists the terms. Peaks of set-up (the
/// copies of the largest dense block while it is made; the pairs of entries that make G̃G̃ᵀ) and of the end
/// (vectors of all dofs, arrays of the result file) do not come together: the largest counts.
struct RankMemory {
  double program = 0.0;    ///< libraries, MPI; and what the scene was made from, on rank 0
  double mesh = 0.0;       ///< meshes, stiffness matrices, loads, constraints
  double factors = 0.0;    ///< sparse
  double dense = 0.0;      ///< S⁺, and S with the Dirichlet preconditioner
  double joins = 0.0;      ///< what joins subdomains to clusters
  double coarse = 0.0;     ///< of the coarse problem, replicated or distributed
  double directions = 0.0; ///< of conjugate gradients, that are stored
  double temporary = 0.0;  ///< the largest of the peaks
  double sum() const { return program + mesh + factors + dense + joins + coarse + directions + temporary; }
};

/// What a run on so many ranks is expected to take; of the busiest rank.
struct PlanRow {
  int ranks = 1;
  long long leastSubdomains = 0, mostSubdomains = 0; ///< of a rank
  double imbalance = 1.0;                            ///< most over mean
  long long factorizations = 0;                      ///< of all ranks
  feti::DualForms forms;                             ///< of the dual operator
  long long clusters = 0;                            ///< as asked for, or chosen by the model; 0: none
  double productsGrowth = 1.0;                       ///< by them
  double clusterAspect = 1.0;                        ///< of their sides
  RankMemory memory;
  double totalMemory = 0.0; ///< bytes of all ranks
  // Seconds.
  double mesh = 0.0, assembly = 0.0, constraints = 0.0, factorization = 0.0, coarseSetup = 0.0;
  double product = 0.0; ///< with F, and with the preconditioner
  feti::StepShape shape;
  feti::StepSeconds step; ///< of a step, beside the product
  feti::StepCounts counts;
  double recovery = 0.0; ///< of displacements: for the right-hand side, and to judge an answer
  double face = 0.0;     ///< the coarse problem of an active set
  double setup() const { return mesh + assembly + constraints + factorization + coarseSetup + recovery; }
  double perStep() const { return product + step.sum(); }
  double least = 0.0, most = 0.0; ///< of the run with all its steps, without writing fields
};

/// Products with F that runs to the tolerance of the options are expected to take.
///
/// They grow with log₁₀(1/ε); the decks that come with Harmos, a finer one of them, and the model problem
/// took, for each power of ten:
///
///                 Dirichlet    lumped       none
///     membranes   1 … 12.5     1 … 15.5     3 … 15.5
///     elastic     2.5 … 20     3.7 … 26     8.5 … 36
///
/// Ill-conditioned problems take more: that is a range, no bound.
struct ProductRange {
  int least, most;
};
ProductRange expectedProducts(const scene::Scene& scene, const run::RunOptions& options);

/// @param mayLump FormLimits::mayLump. @param programBytes of a process before it has a scene. @param
/// sceneBytes what rank 0 has read scenes with.
PlanRow planRow(const PlanSurvey& survey, const run::RunOptions& options, bool elastic, bool mayLump,
                const ProductRange& products, const feti::Rates& rates, double programBytes,
                double sceneBytes, int ranks);

} // namespace Harmos::plan
