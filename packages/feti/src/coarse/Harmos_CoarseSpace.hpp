// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_CoarseRows.hpp"
#include "Harmos_FaceGram.hpp"
#include "Harmos_TrilinosVersion.hpp"
#include "Harmos_Types.hpp"

#include <string>
#include <vector>

namespace Harmos::feti {

/// The natural coarse space: G̃ = RᵀBᵀ, A = G̃G̃ᵀ and the projector P = I − G̃ᵀA⁻G̃ = I − GᵀG, where G = L⁻¹G̃,
/// LLᵀ = A, has orthonormal rows. Rows of G̃ that depend on the others are left out of G, which has the same
/// kernel all the same.
///
/// Vectors of motions have a number for each column of R of this rank, see RigidMotions: with clusters R is
/// that of the clusters. How A is factored, and by whom, is left to ReplicatedCoarse and DistributedCoarse.
///
/// Guarded by tests/unit/feti/coarse/test_coarse_space.cpp (P² = P, GGᵀ = I, rank deficiency, all forms).
class CoarseSpace {
 public:
  virtual ~CoarseSpace() = default;
  CoarseSpace(const CoarseSpace&) = delete;
  CoarseSpace& operator=(const CoarseSpace&) = delete;

  /// Rows of G; less than the kernel dimension if G̃ is rank deficient.
  virtual int dimension() const = 0;
  /// Rows of G̃.
  int kernelDimension() const { return motions_.dimension(); }
  /// R.
  const RigidMotions& motions() const { return motions_; }
  /// Estimated smallest over largest pivot of A among those kept.
  virtual double smallestPivotRatio() const = 0;
  /// 1 for motions of this rank that are left out because of rank deficiency.
  virtual std::vector<char> dependentMotions() const = 0;

  /// Whether it is a DistributedCoarse.
  virtual bool isDistributed() const = 0;
  /// How A is solved, for a log: "replicated, dense", ...
  virtual std::string description() const = 0;

  const CoarseRows& rows() const { return rows_; }
  /// Columns of R of this rank's subdomains, by their numbers.
  const std::vector<int>& ownColumns() const { return motions_.ownColumns(); }

  /// G̃λ. @note Collective, messages to neighbours.
  std::vector<double> multiply(const MultiVector& lambda, std::size_t column = 0) const;
  /// λ ← λ + factor·G̃ᵀs. @note Collective likewise.
  void addTransposed(double factor, const std::vector<double>& s, MultiVector& lambda,
                     std::size_t column = 0) const;
  /// A⁻e, zero at dependent motions. @note Collective.
  virtual std::vector<double> solve(const std::vector<double>& e) const = 0;
  /// ‖s‖ over all ranks. @note Collective, one reduction.
  double norm(const std::vector<double>& s) const;

  /// v ← Pv. @note Collective.
  virtual void project(MultiVector& v) const = 0;

  /// The equality rows of the dual problem, for which CCᵀ = I on the range of C: G, or GᵀG; null if
  /// dimension() is 0. This is to outlive them.
  virtual Teuchos::RCP<const Operator> equalityRows() const = 0;
  /// Of these rows, what PDAS needs on faces. This is to outlive it.
  virtual Teuchos::RCP<const qp::FaceGramMaker<MultiVector>> faceGram() const = 0;

  /// The solution of least norm of G̃_F G̃_Fᵀ δ = r, for r in its range, rows of B with mask 1.
  /// @note Collective.
  virtual std::vector<double> minimumNormSolution(const MultiVector& mask,
                                                  const std::vector<double>& r) const = 0;

 protected:
  /// @note Collective.
  CoarseSpace(const RigidMotions& motions, const Constraints& constraints);
  const Teuchos::RCP<const Teuchos::Comm<int>>& communicator() const { return comm_; }
  const Teuchos::Comm<int>& comm() const { return *comm_; }
  /// Columns that rows of this rank touch, rising, and what a vector of motions has there. @note Collective.
  const std::vector<int>& touchedColumns() const { return touchedColumns_; }
  std::vector<double> atTouched(const std::vector<double>& s) const;
  /// The diagonal of A, a vector of motions. @note Collective.
  std::vector<double> diagonal() const;

 private:
  Teuchos::RCP<const Teuchos::Comm<int>> comm_;
  RigidMotions motions_;
  CoarseRows rows_;
  std::vector<double> sumsOf(const MultiVector& touched) const;

  std::vector<int> touchedColumns_;
  std::vector<int> touched_;          // place in touchedColumns_, of each entry of rows_
  Teuchos::RCP<const Import> import_; // from own to touched columns
};

} // namespace Harmos::feti
