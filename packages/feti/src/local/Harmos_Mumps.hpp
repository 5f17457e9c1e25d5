// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <mpi.h>
#include <string>
#include <vector>

namespace Harmos::feti {

/// How a factorisation by MUMPS is made.
struct MumpsOptions {
  /// MUMPS' SYM. With a symmetric kind, one triangle is to be given: MUMPS sums what it gets twice.
  enum class Symmetry { General = 0, PositiveDefinite = 1, Symmetric = 2 };
  /// ICNTL(7); MUMPS falls back to another ordering where it was built without the wanted one.
  enum class Ordering {
    Amd = 0,
    Given = 1,
    Amf = 2,
    Scotch = 3,
    Pord = 4,
    Metis = 5,
    Qamd = 6,
    Automatic = 7
  };
  enum class Precision { Double, Single };

  Symmetry symmetry = Symmetry::PositiveDefinite;
  Ordering ordering = Ordering::Metis;
  Precision precision = Precision::Double; ///< of the factors; data and results are in double all the same
  /// Pivots below this part of ‖A‖ count as zero (ICNTL(24), CNTL(3)); 0 looks for none. Cholesky never finds
  /// one: SYM = 1 has no pivot test.
  double nullPivotThreshold = 0.0;
  /// Blocks of the factors are compressed to this relative accuracy (ICNTL(35), CNTL(7)); 0 for none.
  double blockLowRank = 0.0;
  /// Whether each rank gives a share of the entries, which are summed (ICNTL(18) = 3), and not the root all.
  /// Null pivots are relative to the largest entry of a share then, the matrix is not scaled, and no part of
  /// it is left to ScaLAPACK, which finds no null pivots (ICNTL(13) = 1). The analysis brings the structure
  /// together on the root, without values.
  bool isDistributed = false;
  /// Limit of the working memory of each rank (ICNTL(23)); 0 for none.
  int memoryMiB = 0;
};

/// One factorisation by MUMPS (dmumps_c or smumps_c), with exceptions in the place of codes.
///
/// The matrix is given as triplets, on the root of the communicator or in shares. Every MUMPS error becomes a
/// NumericalError or InternalError whose sentence names the remedy; warnings are collected. A workspace that
/// proves too small is enlarged and the factorisation repeated.
///
/// With Schur rows b, and i the others,
///
///     S = A_bb − A_bi A_ii⁻¹ A_ib                       schurComplement()
///     g = f_b − A_bi A_ii⁻¹ f_i                         condense()
///     x_i = A_ii⁻¹ (f_i − A_ib x_b)                     expand(), after condense() of the same f
///     x_i = A_ii⁻¹ f_i,  x_b = 0                        solve()
///
/// Guarded by tests/unit/feti/local/test_mumps.cpp.
/// @note All functions are collective over the communicator, which may be MPI_COMM_SELF.
class Mumps {
 public:
  struct Statistics {
    double factorEntries = 0.0; ///< entries of the factors, INFOG(29); estimated by the analysis, INFOG(20)
    double factorizationFlops = 0.0; ///< RINFOG(3); estimated by the analysis, RINFOG(1)
    double memoryMiB = 0.0;          ///< on all ranks of the communicator, INFOG(22); estimated, INFOG(17)
    int analyses = 0, factorizations = 0; ///< that were made
  };

  explicit Mumps(MPI_Comm comm, const MumpsOptions& options = {});
  ~Mumps();
  Mumps(const Mumps&) = delete;
  Mumps& operator=(const Mumps&) = delete;

  /// Analysis. @param rows, columns one-based; only the root's are read, if entries are not in shares. @param
  /// schurRows zero-based.
  /// @param position for Ordering::Given: of each row in the order of elimination, one-based, Schur rows
  /// last.
  void analyse(int order, std::vector<int> rows, std::vector<int> columns, std::vector<int> schurRows = {},
               const std::vector<int>& position = {});

  /// The order of elimination found by analyse(), on the root: what `position` takes.
  std::vector<int> ordering() const;

  /// Numerical factorisation of the values of the analysed entries; only the root's are read. Once.
  void factorize(std::vector<double> values);

  /// The same of other values, with the analysis that is there: a step of Newton's method, of time. The
  /// entries, which factorize() has let go, are those that were analysed, in their order.
  /// @throws InputError if their number differs.
  void refactorize(std::vector<int> rows, std::vector<int> columns, std::vector<double> values);

  /// S, whole and symmetric for symmetric matrices, column after column; on the root. It is handed over once.
  std::vector<double> schurComplement();

  /// Overwrites the right-hand sides, column after column, by the solutions; only the root's are touched.
  void solve(double* rightHandSides, int count);

  /// @param reduced count columns with an entry for each Schur row. Only the root's arrays are touched.
  void condense(double* rightHandSides, double* reduced, int count);
  /// Overwrites the right-hand sides by the solutions. @param reduced the solutions at the Schur rows.
  void expand(double* rightHandSides, double* reduced, int count);

  /// Rows whose pivot was found to be null, zero-based, on the root; see MumpsOptions::nullPivotThreshold.
  std::vector<int> nullPivots() const;

  const Statistics& statistics() const;
  const std::vector<std::string>& warnings() const;

  /// What MUMPS' INFOG(1) means, with the remedy; detail is INFOG(2).
  static std::string explain(int code, int detail);
  /// What a warning, INFOG(1) > 0, means.
  static std::string explainWarning(int code);

  class Engine;

 private:
  std::unique_ptr<Engine> engine_;
};

} // namespace Harmos::feti
