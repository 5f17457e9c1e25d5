// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_BoundaryOperator.hpp"
#include "Harmos_LocalMatrix.hpp"
#include "Harmos_MultifrontalCholesky.hpp"

#include <map>
#include <memory>
#include <string>
#include <tuple>
#include <vector>

namespace Harmos::feti {

/// Which solver factors a subdomain's matrix.
struct SparseSolverChoice {
  /// "multifrontal" for MultifrontalCholesky, "MUMPS" for Harmos' adapter, or a name that Amesos2 knows.
  std::string name = "multifrontal";
  double blockLowRank = 0.0; ///< MumpsOptions::blockLowRank; MUMPS does it whatever the name

  static constexpr const char* multifrontal = "multifrontal";
  static constexpr const char* mumps = "MUMPS";
  bool isMultifrontal() const { return name == multifrontal && blockLowRank == 0.0; }
  /// The name of the solver at work.
  const char* effectiveName() const { return blockLowRank > 0.0 ? mumps : name.c_str(); }
  /// Whether it makes Schur complements, which the condensed form needs: Amesos2's solvers do not.
  bool hasSchurComplements() const { return name == multifrontal || name == mumps; }
  /// Whether there is such a solver.
  static bool isAvailable(const std::string& name);
  /// Their names: Harmos' own, MUMPS, and those of this Amesos2.
  static std::vector<std::string> available();
};

/// What was spent on factors.
struct FactorizationCounts {
  int analyses = 0;       ///< symbolic factorisations: orders of elimination, structures of factors
  int factorizations = 0; ///< numerical ones

  FactorizationCounts& operator+=(const FactorizationCounts& other) {
    analyses += other.analyses;
    factorizations += other.factorizations;
    return *this;
  }
};

/// What factorisations that are made one after the other share: memory to work in, and orders of elimination
/// by pattern, for which the first matrix pays. Hashes that agree by chance would be told apart by the
/// solver.
class FactorizationContext {
 public:
  /// Which order of a pattern that of other rows left follows: the last one, or always the first, so that
  /// orders do not depend on what was factored in between.
  enum class Likeness { Last, First };
  explicit FactorizationContext(Likeness likeness = Likeness::Last) : likeness_(likeness) {}

  /// The tree of a matrix with these rows left, made where it is not known. @param isNew whether it was made.
  std::shared_ptr<const FrontTree> tree(const LocalMatrix& pattern, const std::vector<int>& rest,
                                        FrontTree::Rest use, bool& isNew);
  /// MUMPS' order of elimination; empty where it is not known.
  std::vector<int>& position(const LocalMatrix& pattern, const std::vector<int>& rest);
  FrontWorkspace& workspace() { return workspace_; }
  /// Gives the memory back that is only needed while something is factored.
  void releaseWorkspace() { workspace_ = FrontWorkspace(); }

 private:
  using Key = std::tuple<std::size_t, std::size_t, std::vector<int>, bool>; ///< entries, hash, rest, absent
  std::map<Key, std::shared_ptr<const FrontTree>> trees_;
  Likeness likeness_;
  std::map<std::pair<std::size_t, std::size_t>, std::shared_ptr<const FrontTree>> models_; ///< of a pattern
  std::map<Key, std::vector<int>> positions_;
  FrontWorkspace workspace_;
};

/// How a LocalFactorization is made.
struct LocalFactorizationSettings {
  SparseSolverChoice solver;
  Precision precision = Precision::Double; ///< Single: L in float
  bool isRefined = true;                   ///< single precision: a step of iterative refinement each solution
  enum class Boundary {
    Absent,   ///< left out
    Condensed ///< A is condensed to it: static condensation
  };
  Boundary use = Boundary::Absent;
  std::vector<int> boundary; ///< b, rising
  std::vector<int> ends;     ///< of solveAtEnds()
};

/// The factorisation of one rank's sparse symmetric positive definite matrix A, or of A_ii of its rows i
/// without some rows b, by whichever solver: Harmos' own multifrontal Cholesky, or any of Amesos2, MUMPS by
/// Harmos' own adapter. Analysed and factored when it is made.
///
/// Guarded by tests/unit/feti/local/test_local_inverse.cpp, by all solvers.
class LocalFactorization {
 public:
  virtual ~LocalFactorization() = default;

  /// X ← A⁻¹X, or X_i ← A_ii⁻¹X_i where X_b is zero; count vectors of all rows, column after column.
  virtual void solve(double* x, int count) const = 0;
  /// The same where x is zero but at the ends, and only asked for there; other entries are undefined.
  virtual void solveAtEnds(double* x, int count) const = 0;

  // Of one with a condensed boundary.
  /// S = A_bb − A_bi A_ii⁻¹ A_ib, whole, column after column; it is handed over once.
  virtual std::vector<double> takeSchurComplement() = 0;
  /// reduced ← f_b − A_bi A_ii⁻¹ f_i, for count vectors.
  virtual void reduce(double* f, double* reduced, int count) const = 0;
  /// f ← (A_ii⁻¹(f_i − A_ib x_b), x_b) after reduce() of the same f.
  virtual void expand(double* f, double* boundary, int count) const = 0;

  /// Solutions are those with L in single precision from now on, not refined. @return whether that can be.
  virtual bool round() { return false; }
  /// After that: L is held in this precision, until refactor().
  virtual void keep(Precision) {}

  /// Of another matrix with the same graph: no new analysis.
  /// @throws InputError if the graph differs, and as makeLocalFactorization().
  virtual void refactor(const LocalMatrix& matrix) = 0;

  /// Of the factors, as far as the solver tells.
  virtual double bytes() const = 0;
  /// Memory that solveAtEnds() of so many vectors reads at least.
  virtual double bytesRead(int count) const = 0;
  /// Operations of a solution with one right-hand side.
  virtual double flops() const = 0;
  /// Analyses and factorisations that were made.
  virtual FactorizationCounts counts() const = 0;
};

/// @throws InputError for a solver that this Amesos2 lacks, NumericalError if the matrix is not positive
/// definite, InternalError. Local.
std::unique_ptr<LocalFactorization> makeLocalFactorization(const LocalMatrix& matrix,
                                                           const LocalFactorizationSettings& settings,
                                                           std::shared_ptr<FactorizationContext> context);

namespace Details {
/// The ways of makeLocalFactorization().
std::unique_ptr<LocalFactorization>
makeMultifrontalFactorization(const LocalMatrix& matrix, const LocalFactorizationSettings& settings,
                              std::shared_ptr<FactorizationContext> context);
std::unique_ptr<LocalFactorization> makeAmesosFactorization(const LocalMatrix& matrix,
                                                            const LocalFactorizationSettings& settings,
                                                            std::shared_ptr<FactorizationContext> context);
/// Whether Amesos2 has such a solver that works.
bool isInAmesos(const std::string& solver);
/// That a matrix has the graph that was analysed, which has this patternHash(). @throws InputError otherwise.
void requireGraph(std::size_t hash, const LocalMatrix& matrix);
} // namespace Details

} // namespace Harmos::feti
