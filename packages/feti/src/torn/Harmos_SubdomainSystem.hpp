// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_Frame.hpp"
#include "Harmos_Kernel.hpp"
#include "Harmos_LocalMatrix.hpp"

#include <Teuchos_Comm.hpp>
#include <Teuchos_RCP.hpp>

#include <array>
#include <map>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

namespace Harmos::feti {

/// A prescribed value u(dof) = value; the dof is a local one.
struct FixedDof {
  int dof;
  double value;
};

/// One torn piece, as an application hands it over. What is the same in several subdomains is to be shared by
/// them: matrices, loads, kernels and lists of interface dofs are held by pointer.
struct Subdomain {
  long long number = 0;                              ///< 0, 1, ... over all ranks, without gaps
  std::shared_ptr<const LocalMatrix> stiffness;      ///< without boundary conditions
  std::shared_ptr<const std::vector<double>> load;   ///< a value for each row of the stiffness
  std::shared_ptr<const std::vector<int>> interface; ///< local dofs that may have copies in other subdomains,
                                                     ///< be fixed, or be in constraint rows; rising
  std::vector<long long> numbers;        ///< global number of each interface dof; equal numbers are copies of
                                         ///< one dof; gaps allowed
  std::vector<FixedDof> fixed;           ///< Dirichlet conditions; the same on all copies of a dof
  std::shared_ptr<const Kernel> motions; ///< kernel of the stiffness without boundary conditions
  /// Where it is, if that is known: clusters are bricks by it; see partitionIntoClusters().
  std::optional<std::array<double, 3>> centre = std::nullopt;
  /// Interface dofs on which constraint rows may act later, where these come and go: inverses are made for
  /// them, too. Null: none.
  std::shared_ptr<const std::vector<int>> reserved = nullptr;
};

/// How Dirichlet conditions are enforced.
enum class DirichletForm {
  Primal, ///< FETI: in the matrix, by the trivial equation k u = k g, k the mean diagonal
  Dual    ///< Total FETI: by a Lagrange multiplier each; every subdomain floats
};

/// A vector of values for each subdomain of this rank, copies being independent: u, f, Ku.
using TornVector = std::vector<std::vector<double>>;

/// K = diag(K_i), f and R of the torn problem, verified. Its structure is immutable; loads, prescribed values
/// and the values of the matrices may be set anew.
///
/// The kernels are those of the matrices with the Dirichlet conditions in the chosen form, with orthonormal
/// columns (RᵀR = I), and are verified: ‖K_i R_i‖ ≤ 1e-12 ‖K_i‖ ‖R_i‖.
///
/// Stiffness matrices that agree to 1e-12 √(k_ii k_jj) are held once, whatever the application gave:
/// matrix(i) of congruent subdomains with the same Dirichlet dofs is one object, and its address tells.
/// Guarded by tests/unit/feti/test_subdomain_system.cpp.
class SubdomainSystem {
 public:
  /// @param subdomains those of this rank; a rank may have none.
  /// @throws InputError, NumericalError on all ranks for inconsistent sizes, numbers that are not finite, a
  ///         kernel that is none.
  /// @note Collective.
  SubdomainSystem(Teuchos::RCP<const Teuchos::Comm<int>> comm, std::vector<Subdomain> subdomains,
                  DirichletForm form);

  /// New loads, by this rank's subdomains; all else stays. What was made of the old ones (DualProblem) is to
  /// be made anew.
  /// @throws InputError on all ranks for loads of another length, or that are not finite. @note Collective.
  void setLoads(std::vector<std::shared_ptr<const std::vector<double>>> loads);
  /// New values of the Dirichlet conditions, by this rank's subdomains and in the order of Subdomain::fixed,
  /// whose dofs stay. What was made of the old ones (Constraints::setBounds(), DualProblem) is to be made
  /// anew.
  /// @throws InputError on all ranks likewise. @note Collective.
  void setPrescribed(const std::vector<std::vector<double>>& values);
  /// New stiffness matrices with the graphs of the old ones, and their kernels where they change too. What
  /// was made of the old ones is to be made anew; see LocalInverses::renew(). Of subdomains whose values
  /// do not change matrix(i) and kernel(i) stay the same objects.
  /// @param motions null pointers: as they were.
  /// @throws InputError, NumericalError on all ranks, as the constructor, and for another graph.
  /// @note Collective. The system is as it was if this throws.
  void setMatrices(const std::vector<std::shared_ptr<const LocalMatrix>>& stiffness,
                   const std::vector<std::shared_ptr<const Kernel>>& motions = {});

  /// Frames of matrices and kernels, for each subdomain; none: matrices are as loads are. Constraints that
  /// were made before are to be made anew. In frames are rhs() and what is solved for, not loads and
  /// prescribed values. @throws InputError on all ranks for a subdomain with prescribed values in the matrix,
  /// and for numbers of components that do not go with it. @note Collective.
  void setFrames(std::vector<std::optional<Frame>> frames);
  /// Null: none.
  const Frame* frame(int i) const {
    return frames_.empty() || !frames_[static_cast<std::size_t>(i)] ? nullptr
                                                                    : &*frames_[static_cast<std::size_t>(i)];
  }
  /// Of what is solved for, from the frames, and into them. Local.
  void leaveFrames(TornVector& u) const;
  void enterFrames(TornVector& u) const;

  const Teuchos::RCP<const Teuchos::Comm<int>>& comm() const { return comm_; }
  DirichletForm dirichletForm() const { return form_; }

  /// Subdomains of this rank.
  int size() const { return static_cast<int>(subdomains_.size()); }
  const Subdomain& subdomain(int i) const { return subdomains_[static_cast<std::size_t>(i)]; }
  /// K_i with the trivial equations of the primal form.
  const LocalMatrix& matrix(int i) const { return *matrices_[static_cast<std::size_t>(i)]; }
  /// Its diagonal.
  const std::vector<double>& diagonal(int i) const { return *diagonals_[static_cast<std::size_t>(i)]; }
  /// f_i belonging to matrix(i); in the dual form without loads on prescribed values, of which multipliers do
  /// not tell then.
  const std::vector<double>& rhs(int i) const { return *rhs_[static_cast<std::size_t>(i)]; }
  /// R_i, orthonormal.
  const Kernel& kernel(int i) const { return *kernels_[static_cast<std::size_t>(i)]; }
  /// That of the matrices it was made with: what is chosen by it does not depend on those between.
  const Kernel& firstKernel(int i) const { return *firstKernels_[static_cast<std::size_t>(i)]; }
  /// Global number of the first column of R_i.
  int kernelOffset(int i) const { return kernelOffsets_[static_cast<std::size_t>(i)]; }

  long long globalSubdomains() const { return globalSubdomains_; }
  long long primalDimension() const { return primalDimension_; }
  /// Columns of R over all ranks.
  int kernelDimension() const { return kernelDimension_; }

  /// A vector of zeros of the right shape.
  TornVector zeroVector() const;

 private:
  void checkInput() const;
  void shareStiffness();
  // By what matrices and kernels are made of, with the dofs that are held.
  struct Known {
    std::map<std::pair<const LocalMatrix*, std::vector<int>>, std::shared_ptr<const LocalMatrix>> matrices;
    std::map<std::pair<const Kernel*, std::vector<int>>, std::shared_ptr<const Kernel>> kernels;
  };
  std::vector<int> heldDofs(const Subdomain& s) const;
  void build(Known known);
  void numberKernels();
  void updateRhs();

  Teuchos::RCP<const Teuchos::Comm<int>> comm_;
  std::vector<Subdomain> subdomains_;
  DirichletForm form_;
  std::vector<std::shared_ptr<const LocalMatrix>> matrices_;
  std::vector<std::shared_ptr<const std::vector<double>>> diagonals_, rhs_;
  std::vector<std::shared_ptr<const Kernel>> kernels_, firstKernels_;
  std::vector<std::optional<Frame>> frames_;
  std::vector<int> kernelOffsets_;
  long long globalSubdomains_ = 0;
  long long primalDimension_ = 0;
  int kernelDimension_ = 0;
};

} // namespace Harmos::feti
