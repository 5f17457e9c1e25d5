// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_DualSolution.hpp"
#include "Harmos_KeyedNumbers.hpp"
#include "Harmos_SolverMonitor.hpp"
#include "Harmos_Types.hpp"

#include <functional>
#include <vector>

namespace Harmos::run {

/// The span of the solutions found within a step: differences of the spring forces f on rows and of the
/// openings x of these rows. Bodies are linear, so x_0 + Σc_j Δx_j belongs to f_0 + Σc_j Δf_j as long as the
/// contacts are those of the last solution x_0. A combination that satisfies the law of the interfaces is
/// found without a further solve, as a stationary point of
///
///     E(c) = W(x(c)) + Ψ(x(c)),   ∂E/∂c_j = Δx_j · (f_law(x) − f),
///
/// where W is the energy of the bodies, by Newton's method with the eigenvalues of its matrix made positive.
/// Where E has negative curvature, because the law softens more steeply than the bodies are stiff, the method
/// descends and leaves saddle points (Dauphin et al.: NeurIPS 2014). It accelerates the iteration of springs
/// between two solves as conjugate gradients accelerate a gradient method (Narkiss, Zibulevsky: Sequential
/// subspace optimization, Technion CCIT 559, 2005).
///
/// Openings and forces are those of this rank's rows, multipliers shared; inner products are sums over ranks.
/// Guarded by tests/unit/effects/test_damage_update.cpp.
class AnswerSpan {
 public:
  using Vector = std::vector<double>;
  /// Forces by which the law holds rows that are open so far. Local.
  using Law = std::function<Vector(const Vector& openings)>;

  /// @param rows of this rank; to outlive this. @param weights of them, > 0: stiffnesses, for lengths of
  /// openings.
  AnswerSpan(const KeyedNumbers& rows, Vector weights);

  /// A step begins, of which nothing is known.
  void begin();
  /// Differences so far: they have led nowhere.
  void forget() { directions_.clear(); }
  /// @param noise of an answer: what is not longer than this share of it, beyond what is spanned, is not
  /// kept. @note Collective.
  void add(const Vector& openings, const Vector& forces, const feti::WarmStart& multipliers,
           double tolerance);
  struct Found {
    Vector openings;
    feti::WarmStart multipliers; ///< that go with them; null: those of the last answer
  };
  /// From the last answer on; it, where nothing is better. @pre an answer of this step. @note Collective.
  Found settle(const Law& law) const;

  /// @note Collective.
  void exchange(qp::StateArchive<MultiVector>& archive, const feti::DualProblem& problem);

 private:
  struct Pair {
    Vector openings, forces, mu;
    Teuchos::RCP<MultiVector> multiplier; // null where nobody asks for it
    double reach = 0.0;                   // how long the difference was of which it is the direction

    void add(double factor, const Pair& more);
    void scale(double factor);
  };
  double dot(const Vector& a, const Vector& b) const;
  static Pair copy(const Pair& pair);
  void exchange(qp::StateArchive<MultiVector>& archive, const feti::DualProblem& problem, Pair& pair,
                const std::string& name) const;
  Vector at(const Vector& c, bool ofForces) const;
  Vector gradient(const Law& law, const Vector& c) const;
  double lengthWithin(const Vector& c, const Vector& p, std::vector<bool>& isFree) const;
  Vector direction(const Law& law, const Vector& c, const Vector& gradient,
                   const std::vector<bool>& isFree) const;

  const KeyedNumbers& rows_;
  Vector weights_;
  Pair last_;
  bool hasLast_ = false;
  std::vector<Pair> directions_; // orthogonal, of length one
};

} // namespace Harmos::run
