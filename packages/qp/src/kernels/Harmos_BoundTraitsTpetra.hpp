// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_BoundOps.hpp"
#include "Harmos_FaceOps.hpp"
#include "Harmos_Types.hpp"

namespace Harmos::qp {

/// Tpetra vectors, on the host.
template<>
struct BoundTraits<Scalar, MultiVector> {
  static std::size_t length(const MultiVector& v);
  static const double* read(const MultiVector& v);
  static double* write(MultiVector& v);
  static long long globalIndex(const MultiVector& v, std::size_t entry);
  static void sum(const MultiVector& like, double* sums, int count);
  static void sumAndMin(const MultiVector& like, double* sums, int count, double& least);
  static double maximum(const MultiVector& like, double value);
  static std::vector<double> gather(const MultiVector& v);
  static void scatter(const std::vector<double>& values, MultiVector& v);
};

extern template struct BoundOps<Scalar, MultiVector>;
extern template struct FaceOps<Scalar, MultiVector>;

} // namespace Harmos::qp
