// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_BoundaryOperator.hpp"
#include "Harmos_ClusterInverse.hpp"
#include "Harmos_Types.hpp"

#include <Teuchos_RCP.hpp>
#include <Tpetra_Operator.hpp>

#include <exception>
#include <memory>
#include <vector>

namespace Harmos::feti {

/// Σ_i C_i A_i C_iᵀ over all subdomains, A_i an operator on boundary dofs, C_i sparse: what the dual operator
/// (C = B, A = K⁺_bb) and the dual preconditioners (C = B_D, A = S or K_bb) have in common.
///
/// Subdomains that share A_i are dealt with at once. Where they are joined to clusters, the inverse of these
/// takes part: groups are those that it was made of. A product costs one neighbour exchange each way
/// (Tpetra Import and Export of the rows that touch a subdomain of this rank) and no reduction.
///
/// A failure of a local operator on one rank cannot be thrown at once, or the others would wait in the
/// exchange. It is kept, and the result is poisoned with NaN, which the next reduction of any solver carries
/// to all ranks; rethrowFailure() then makes it an agreed error. Success so costs no reduction.
class SubdomainSum : public Operator {
 public:
  /// An entry of C_i of one member of a group.
  struct Entry {
    int row;   ///< local index in the importer's target map
    int place; ///< boundary dof, counted through the members: member · size + dof
    double value;
  };
  /// Subdomains with one operator.
  struct Group {
    std::shared_ptr<const BoundaryOperator> op;
    int members = 0;
    std::vector<Entry> entries;
  };

  /// @param importer from the rows that a rank owns to those that touch its subdomains.
  /// @param joined or null.
  SubdomainSum(Teuchos::RCP<const Import> importer, std::vector<Group> groups,
               std::shared_ptr<const ClusterInverse> joined = nullptr);

  Teuchos::RCP<const Map> getDomainMap() const override;
  Teuchos::RCP<const Map> getRangeMap() const override { return getDomainMap(); }
  bool hasTransposeApply() const override { return true; }

  /// Y = α(Σ C_i A_i C_iᵀ)X + βY. @note Collective.
  void apply(const MultiVector& X, MultiVector& Y, Teuchos::ETransp mode = Teuchos::NO_TRANS,
             Scalar alpha = 1.0, Scalar beta = 0.0) const override;

  /// Throws on all ranks the failure of a local operator, if one was kept. @note Collective.
  void rethrowFailure() const;

  const std::vector<Group>& groups() const { return groups_; }
  const Teuchos::RCP<const Import>& importer() const { return importer_; }

 private:
  void applyLocally(const double* in, double* out, std::size_t stride, int columns) const;
  void applyJoined(const double* in, double* out, std::size_t stride, int columns) const;

  Teuchos::RCP<const Import> importer_;
  std::vector<Group> groups_;
  std::shared_ptr<const ClusterInverse> joined_;
  mutable Teuchos::RCP<MultiVector> in_, out_, image_; // kept from product to product
  mutable std::vector<double> t_, u_;
  mutable std::vector<std::vector<double>> us_; // of all groups, where they are joined
  mutable std::exception_ptr failure_;
};

} // namespace Harmos::feti
