// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <mpi.h>
#include <string>
#include <vector>

namespace Harmos::feti {

/// One factorisation by MUMPS (dmumps_c), with exceptions in the place of codes.
///
/// The matrix is given on the root of the communicator as triplets. Every MUMPS error becomes a
/// NumericalError or InternalError whose sentence names the remedy; warnings are collected. A workspace that
/// proves too small is enlarged and the factorisation repeated.
///
/// Guarded by tests/unit/feti/test_mumps.cpp.
/// @note All functions are collective over the communicator, which may be MPI_COMM_SELF.
class Mumps {
 public:
  /// MUMPS' SYM. With a symmetric kind, one triangle is to be given: MUMPS sums what it gets twice.
  enum class Symmetry { General = 0, PositiveDefinite = 1, Symmetric = 2 };

  struct Statistics {
    double factorEntries = 0.0;      ///< entries of the factors, INFOG(29)
    double factorizationFlops = 0.0; ///< RINFOG(3)
    double memoryMiB = 0.0;          ///< memory used on all ranks of the communicator, INFOG(22)
  };

  Mumps(MPI_Comm comm, Symmetry symmetry);
  ~Mumps();
  Mumps(const Mumps&) = delete;
  Mumps& operator=(const Mumps&) = delete;

  /// Analysis. @param rows, columns one-based; only the root's are read.
  void analyse(int order, std::vector<int> rows, std::vector<int> columns);

  /// Numerical factorisation of the values of the analysed entries; only the root's are read.
  void factorize(std::vector<double> values);

  /// Overwrites the right-hand sides, column after column, by the solutions; only the root's are touched.
  void solve(double* rightHandSides, int count);

  const Statistics& statistics() const { return statistics_; }
  const std::vector<std::string>& warnings() const { return warnings_; }

  /// What MUMPS' INFOG(1) means, with the remedy; detail is INFOG(2).
  static std::string explain(int code, int detail);

 private:
  struct Data;

  void call(int job);

  std::unique_ptr<Data> data_;
  Statistics statistics_;
  std::vector<std::string> warnings_;
};

} // namespace Harmos::feti
