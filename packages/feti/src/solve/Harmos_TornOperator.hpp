// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_ConstraintRow.hpp"
#include "Harmos_SubdomainSystem.hpp"
#include "Harmos_Types.hpp"

#include <Tpetra_Operator.hpp>

#include <memory>
#include <vector>

namespace Harmos::feti {

/// The operator A = Σ L_iᵀ K_i L_i on global dofs, applied by the torn matrices. A FETI solver needs it
/// instead of an assembled matrix, which lacks the contributions of the subdomains.
///
/// Rows of fixed dofs are those of the identity: the right-hand side contains the prescribed values there.
/// The right-hand side is the load; loads of the subdomains are ignored.
///
/// Guarded by tests/unit/feti/test_torn_operator.cpp.
class TornOperator : public Operator {
 public:
  /// @param subdomains those of this rank, all of whose dofs have global numbers: see makeSubdomain().
  /// @param rows contacts and ties that go with the operator; apply() does not look at them.
  /// @throws InputError on all ranks for a subdomain whose interface is not all of it. @note Collective.
  TornOperator(Teuchos::RCP<const Teuchos::Comm<int>> comm, std::vector<Subdomain> subdomains,
               std::vector<ConstraintRow> rows = {});

  const Teuchos::RCP<const Teuchos::Comm<int>>& comm() const { return comm_; }
  const std::vector<Subdomain>& subdomains() const { return subdomains_; }
  const std::vector<ConstraintRow>& rows() const { return rows_; }

  /// Every dof once, on one of the ranks that have it.
  Teuchos::RCP<const Map> getDomainMap() const override { return map_; }
  Teuchos::RCP<const Map> getRangeMap() const override { return map_; }
  /// Symmetric only without fixed dofs.
  bool hasTransposeApply() const override { return false; }

  /// Y = αAX + βY. @note Collective.
  void apply(const MultiVector& X, MultiVector& Y, Teuchos::ETransp mode = Teuchos::NO_TRANS,
             Scalar alpha = 1.0, Scalar beta = 0.0) const override;

  /// A right-hand side as loads, shared equally by the copies of a dof, and values of fixed dofs.
  struct TornRhs {
    std::vector<std::shared_ptr<const std::vector<double>>> loads;
    std::vector<std::vector<double>> prescribed;
  };
  /// @param column of b. @note Collective.
  TornRhs torn(const MultiVector& b, std::size_t column) const;
  /// The mean of the copies of each dof. @param column of x. @note Collective.
  void join(const TornVector& u, MultiVector& x, std::size_t column) const;

 private:
  std::vector<double> toOverlap(const MultiVector& x, std::size_t column) const;
  void addOverlap(const std::vector<double>& overlap, MultiVector& y, std::size_t column) const;

  Teuchos::RCP<const Teuchos::Comm<int>> comm_;
  std::vector<Subdomain> subdomains_;
  std::vector<ConstraintRow> rows_;
  Teuchos::RCP<const Map> map_, overlapMap_;
  Teuchos::RCP<const Import> import_;
  std::vector<std::vector<int>> places_; // of each subdomain's dofs in overlapMap_
  std::vector<double> copies_;           // of each dof of overlapMap_, over all ranks
  std::vector<bool> isFixed_;            // of each dof of map_
};

} // namespace Harmos::feti
