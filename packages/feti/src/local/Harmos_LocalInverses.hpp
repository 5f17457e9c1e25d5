// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_ClusterInverse.hpp"
#include "Harmos_Constraints.hpp"
#include "Harmos_InverseQuality.hpp"
#include "Harmos_LocalInverse.hpp"
#include "Harmos_SubdomainSystem.hpp"

#include <memory>
#include <vector>

namespace Harmos::feti {

/// The two forms of the dual operator.
enum class DualForm {
  Implicit, ///< a product is a solve with each sparse factorisation
  Condensed ///< a product is one with a dense matrix of each subdomain's boundary
};

/// How local inverses are made.
struct LocalInverseOptions : LocalInverseSettings {
  DualForm form = DualForm::Condensed;
  bool share = true; ///< congruent subdomains share one factorisation
  bool roundSchur =
      false; ///< S for a preconditioner in single precision, where a subdomain's condition allows
  /// LocalInverse::roundProducts() to so much; 0: not.
  double productError = 0.0;
  /// Whether most will be: between 1e-7 and 5e-6 was measured on subdomains of bodies of 1000 to 4000 nodes.
  bool expectsRoundedProducts() const { return productError >= 5e-6; }
  bool checkNullPivots = false; ///< compare the kernels with MUMPS' null pivots
  /// Analyses that were made already; null: none.
  std::shared_ptr<FactorizationContext> context;
  /// Subdomains that are joined; null: each is by itself.
  std::shared_ptr<const Clusters> clusters;
};

/// Subdomains of this rank with one matrix and one boundary, which share what is made of them.
struct CongruenceClass {
  std::vector<int> members;  ///< subdomains of this rank
  std::vector<int> boundary; ///< dofs that a constraint touches in any of them, and what it takes to hold the
                             ///< kernel; rising
  bool operator==(const CongruenceClass& other) const {
    return members == other.members && boundary == other.boundary;
  }
};

namespace Details {
/// An inverse that was made and verified.
struct MadeInverse {
  std::shared_ptr<LocalInverse> inverse;
  InverseQuality quality;
  bool isReplaced = false; ///< by one of another form
};
} // namespace Details

/// The classes of a system; each subdomain its own if nothing is to be shared. Local.
std::vector<CongruenceClass> congruenceClasses(const SubdomainSystem& system, const Constraints& constraints,
                                               bool share, int fixingPlaces);

/// One generalised inverse for every subdomain of a rank: the only one that F, d̃ and the recovery may use.
///
/// Different generalised inverses give different F and d̃ (only PFP and Pd agree). Whoever mixes them gets a
/// solver that converges to a wrong answer, which tests/unit/feti/test_mixed_inverses.cpp shows. Therefore
/// DualOperator, DualProblem and recover() take this one object.
///
/// Where subdomains are joined to clusters, K⁺ is that of the clusters: joined() goes with the inverses of
/// the subdomains wherever these are used.
///
/// Congruent subdomains share an inverse: one factorisation, one S, one S⁺, and products with all of them at
/// once. What makes them congruent is the content of their matrices, see SubdomainSystem.
class LocalInverses {
 public:
  /// None; see makeLocalInverses().
  LocalInverses() = default;
  /// Those that the caller made, an inverse for each class, and answers for.
  LocalInverses(std::vector<CongruenceClass> classes, std::vector<std::unique_ptr<LocalInverse>> inverses);

  const std::vector<CongruenceClass>& classes() const { return classes_; }
  const LocalInverse& inverse(std::size_t ofClass) const { return *inverses_[ofClass]; }
  /// Its boundary operator, which keeps it.
  std::shared_ptr<const BoundaryOperator> boundaryOperator(std::size_t ofClass) const {
    return {inverses_[ofClass], &inverses_[ofClass]->boundaryOperator()};
  }
  /// What makes these the inverses of clusters; null: each subdomain is by itself.
  const ClusterInverse* joined() const { return joined_.get(); }
  std::shared_ptr<const ClusterInverse> sharedJoined() const { return joined_; }
  /// Factorisations held on this rank.
  int distinctFactorizations() const { return static_cast<int>(inverses_.size()); }
  /// The largest of the estimated condition numbers, on this rank; 1 without subdomains.
  double condition() const { return condition_; }
  /// The largest ‖KK⁺Kx − Kx‖/‖Kx‖ that was seen, on this rank; of products before they are rounded.
  double defect() const { return defect_; }
  /// Of those held on this rank, how many have LocalInverse::hasRoundedProducts().
  int roundedFactorizations() const;
  /// Of those held on this rank, how many are solves where they were to be condensed: see
  /// makeLocalInverses().
  int replacedFactorizations() const;
  /// LocalInverse::restoreProducts() of all of them; what was made of them with products has to be made anew,
  /// operators not. @throws NumericalError on all ranks. @note Collective.
  void restoreProducts(const Teuchos::Comm<int>& comm);
  /// Memory held on this rank.
  double bytes() const;
  /// What was spent on this rank's factors so far.
  FactorizationCounts counts() const;

  /// Become those of a system or of constraints that have changed, and are verified again. Of classes with
  /// the members and the boundary of before, inverses of the same matrices stay, and others are numerical
  /// factorisations by the analyses that are there. All else is made anew. Operators made from these inverses
  /// are to be made anew.
  /// @param isSame of this rank's subdomains, whether matrix and kernel are what they were; empty: none.
  /// @throws NumericalError as makeLocalInverses(); on ranks that failed the classes of before are there
  /// without inverses then, and no subdomain is the same in the next call. @note Collective.
  void renew(const SubdomainSystem& system, const Constraints& constraints,
             const LocalInverseOptions& options, const std::vector<char>& isSame = {});

 private:
  void take(CongruenceClass item, Details::MadeInverse made);
  void forget();
  void judge();
  std::vector<ClusterInverse::Group> groups() const;
  void join(const std::shared_ptr<const Clusters>& clusters);

  std::vector<CongruenceClass> classes_;
  std::vector<std::shared_ptr<LocalInverse>> inverses_; // null after a failure
  std::vector<char> isReplaced_;
  std::vector<InverseQuality> qualities_;
  FactorizationCounts spent_; // on inverses that are no more
  double condition_ = 1.0;
  double defect_ = 0.0;
  std::shared_ptr<FactorizationContext> context_;
  std::shared_ptr<ClusterInverse> joined_;
};

/// Makes them and verifies each: ‖K K⁺ K x − K x‖ ≤ δ ‖Kx‖, δ see defectLimit(), and ‖D⁻¹Kv‖ > 1e-12 ‖v‖ for
/// v = (I − RRᵀ)K⁺b, with pseudo-random x and b. A disagreement, or a factor that does not exist, means that
/// the subdomain has more rigid motions than its kernel says; the error names it and the cause. A condensed
/// inverse in double precision that is not good enough is replaced by solves first.
/// @throws NumericalError on all ranks.
/// @note Collective.
/// Guarded by tests/unit/feti/local/test_local_inverse.cpp.
LocalInverses makeLocalInverses(const SubdomainSystem& system, const Constraints& constraints,
                                const LocalInverseOptions& options = {});

/// R of the coarse problem that goes with them: that of the clusters, or of the subdomains.
RigidMotions motionsOf(const SubdomainSystem& system, const LocalInverses& inverses);

} // namespace Harmos::feti
