// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_FollowingLimits.hpp"
#include "Harmos_Qp.hpp"
#include "Harmos_TestModel.hpp"

#include <Tpetra_MultiVector.hpp>
#include <Tpetra_Operator.hpp>

#include <functional>
#include <memory>
#include <random>
#include <vector>

namespace Harmos {

/// A small quadratic program, the same on all ranks: min ½xᵀAx − bᵀx, l ≤ x ≤ u, discs, Cx = c.
struct SmallQp {
  Dense a;
  std::vector<double> b;
  std::vector<double> lower, upper; ///< empty or ∓∞ where absent
  Dense c;
  std::vector<double> cRhs;
  std::vector<qp::Disc> discs = {}; ///< of neighbouring entries, which have no bounds
  /// Limits that follow: of entries or of discs next to their sources; their bounds and radii are of no
  /// account.
  std::vector<qp::FollowingLimit> follows = {};
  /// Of entries without bounds: part of the cost.
  std::vector<qp::SoftBound> soft = {};

  int size() const { return a.rows; }
  double cost(const std::vector<double>& x) const;
};

/// The solution by enumeration of all active sets, without discs: exact, and shares nothing with the solvers.
/// @param multipliers receives those of the equalities.
std::vector<double> bruteForce(const SmallQp& qp, std::vector<double>* multipliers = nullptr);

/// The same with soft bounds, by enumeration of the sides that entries are on. @param solve what is left
/// then: bruteForce(), or with discs interiorPoint(). @return empty where rounding errors leave no answer.
std::vector<double> bruteForceOfSides(const SmallQp& qp,
                                      const std::function<std::vector<double>(const SmallQp&)>& solve);

/// Makes soft bounds of about every other entry that has no bounds: to one side, to both, or of no width.
/// @param least, most of curvatures, as parts of the mean of A's diagonal.
void addSoftBounds(std::mt19937& random, SmallQp& qp, double least, double most);

/// Orthonormal columns made of random ones; the first given ones are kept as far as they go.
Dense randomOrthonormal(std::mt19937& random, int n, const std::vector<std::vector<double>>& first = {});

/// Q diag(0, …, 0, 1, …, condition) Qᵀ with eigenvalues in geometric progression.
Dense withSpectrum(const Dense& q, int nullity, double condition);

/// A strictly convex QP with eigenvalues in [1, condition], whose bounds are feasible with the equalities.
SmallQp randomQp(std::mt19937& random, int n, int equalities, bool bounds, double condition = 100.0);

/// The same with as many discs as come to a third of the entries, in random places of some size.
SmallQp randomFrictionQp(std::mt19937& random, int n, int equalities, double condition = 100.0);

/// The inverse of a matrix' diagonal.
Dense jacobi(const Dense& matrix);

/// Orthonormalises the rows of C and adapts c.
void orthonormalizeRows(SmallQp& qp);

/// A replicated dense matrix as a Tpetra operator between maps of any distribution.
class DenseOperator : public Operator {
 public:
  DenseOperator(Dense matrix, Teuchos::RCP<const Map> domain, Teuchos::RCP<const Map> range)
      : matrix_(std::move(matrix)), domain_(std::move(domain)), range_(std::move(range)) {}
  Teuchos::RCP<const Map> getDomainMap() const override { return domain_; }
  Teuchos::RCP<const Map> getRangeMap() const override { return range_; }
  bool hasTransposeApply() const override { return true; }
  void apply(const MultiVector& X, MultiVector& Y, Teuchos::ETransp mode = Teuchos::NO_TRANS,
             Scalar alpha = 1.0, Scalar beta = 0.0) const override;

 private:
  Dense matrix_;
  Teuchos::RCP<const Map> domain_, range_;
};

/// The same values on all ranks into a distributed or replicated vector, and back. Collective.
Teuchos::RCP<MultiVector> toVector(const std::vector<double>& values, const Teuchos::RCP<const Map>& map);
std::vector<double> fromVector(const MultiVector& vector);

/// Discs of one rank; null if there are none on any. @param map whose ranks hold whole discs.
std::shared_ptr<const qp::LocalDiscs> localDiscs(const std::vector<qp::Disc>& discs, const Map& map);

/// A SmallQp as a Problem over the ranks of the test.
struct DistributedQp {
  explicit DistributedQp(const SmallQp& qp, qp::EqualityStructure structure = qp::EqualityStructure::General);

  /// @param inverse approximate, of A.
  void precondition(const Dense& inverse) const;

  Teuchos::RCP<const Map> map;
  Teuchos::RCP<MultiVector> solution;
  Teuchos::RCP<MultiVector> multiplier;
  Teuchos::RCP<qp::TpetraProblem> problem;
};

} // namespace Harmos
