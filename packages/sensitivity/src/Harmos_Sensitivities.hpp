// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_Functional.hpp"

#include <memory>
#include <string>
#include <vector>

namespace Harmos::sensitivity {

/// How the answer of a FetiSolver changes with its data, and how functionals of it do.
///
/// While the same contacts are closed, (u, λ) is the solution of a linear system with the matrix of the last
/// face,
///
///     K u + B_Aᵀ λ_A = f,   B_A u = c_A,
///
/// so that a change of the data α changes Φ(u, λ) by
///
///     dΦ/dα = ∂Φ/∂α − vᵀ(K′u − f′ + B′ᵀλ) − ηᵀ(B′u − c′),
///     K v + B_Aᵀ η = Φ_u,   B_A v = Φ_λ,   η = 0 where contacts are open
///
/// (Haslinger and Mäkinen: Introduction to Shape Optimization, 2003, chapters 3 and 4; of contact problems
/// Sokołowski and Zolésio 1992, section 4.6). One linear solution with the factors that are there for a
/// functional and any number of data; of the energy none.
///
/// Where contacts are weak, closed without a force or touching though open, (u, λ) has derivatives from one
/// side only: those that rate() finds, to which the adjoint, which takes such contacts for what they are now,
/// does not belong. The energy is differentiable all the same.
///
/// Guarded by tests/unit/sensitivity/test_gap_gradients.cpp.
class Sensitivities {
 public:
  /// At the last solution of a solver, which is to outlive this, and to keep its data meanwhile.
  /// @param rows those that the solver has. @param weakShare contacts with a force below this share of the
  /// largest one, and a gap below this share of the largest displacement, are weak.
  /// @throws InputError on all ranks where there is no converged solution; for friction whose limit follows
  /// the force, and adhesion, which have no energy that is least. @note Collective.
  Sensitivities(feti::FetiSolver& solver, const std::vector<ConstraintRow>& rows, double weakShare = 1e-6);

  /// (v, η) of a functional. @param tolerance of the linear solution. @param withDisplacement else v is
  /// empty. @throws InputError on all ranks with friction, but of the energy; NumericalError if the linear
  /// solution fails. @note Collective.
  Functional::Adjoint adjoint(const Functional& functional, const Response& response, double tolerance,
                              bool withDisplacement = true);

  /// How u and λ change from here on, to one side, with data that do.
  struct Rate {
    feti::TornVector displacement;
    std::vector<double> forces; ///< of the rows that this rank gave
  };
  /// @param loads f′; empty: none. @param bounds c′ of the rows that this rank gave. @throws as adjoint().
  /// @note Collective.
  Rate rate(const feti::TornVector& loads, const std::vector<double>& bounds, double tolerance);

  /// Contacts that are weak, on all ranks.
  long long weakContacts() const { return weakContacts_; }
  /// Products with F that adjoints and rates took so far.
  int products() const { return products_; }

 private:
  feti::FetiSolver::Increment increment(const feti::TornVector& loads, const std::vector<double>& bounds,
                                        bool isAdjoint, double tolerance, bool withDisplacement);

  feti::FetiSolver& solver_;
  std::vector<ConstraintRow> rows_; // with statuses, without bounds
  std::vector<char> isWeak_;
  long long weakContacts_ = 0;
  bool hasLimited_ = false;
  int products_ = 0;
};

} // namespace Harmos::sensitivity
