// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <vector>

namespace Harmos::qp {

/// What bounds need of a vector beyond Belos::MultiVecTraits; to be specialised for each vector type. Nothing
/// of the mathematics is here: BoundOps and its like are made of these.
///
/// Vectors have one column, and entries on the host.
///
/// Guarded by tests/unit/qp/test_bound_ops.cpp and docs/examples/own_vector.cpp.
template<class Scalar, class MV>
struct BoundTraits {
  /// Entries of this rank. Local.
  static std::size_t length(const MV& v);
  /// They themselves, until the vector is used in another way. Local.
  static const double* read(const MV& v);
  static double* write(MV& v);
  /// The number of an entry, whatever the distribution. Local.
  static long long globalIndex(const MV& v, std::size_t entry);

  // Over the ranks that share a vector; nothing where each has all of it.
  static void sum(const MV& like, double* sums, int count);
  /// The same, and the least of the ranks' numbers, in one reduction.
  static void sumAndMin(const MV& like, double* sums, int count, double& least);
  /// The largest of the ranks' numbers.
  static double maximum(const MV& like, double value);

  /// All entries of a short vector, on every rank. @throws InputError for numbers with gaps.
  static std::vector<double> gather(const MV& v);
  /// The inverse of gather(). Local.
  static void scatter(const std::vector<double>& values, MV& v);
};

} // namespace Harmos::qp
