// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_LocalMatrix.hpp"

#include <cstddef>
#include <vector>

namespace Harmos::feti {

/// A basis of the kernel of a subdomain matrix, column after column.
struct Kernel {
  int rows = 0;
  int columns = 0;
  std::vector<double> values;

  const double* column(int k) const {
    return values.data() + static_cast<std::size_t>(k) * static_cast<std::size_t>(rows);
  }
};

/// The constants: the kernel of a scalar operator.
Kernel constantKernel(int rows);
/// The translation along a component, of dofs = node · components + component: what bodies of revolution can
/// do without strain, along their axis.
Kernel translationKernel(int rows, int components, int component);

/// The rigid motions of an elastic body at given points, about their centre: two translations and a rotation
/// in the plane, three of each in space. dof = point · dimension + component.
/// @param coordinates dimension numbers a point.
/// @throws InternalError unless the dimension is 2 or 3.
Kernel rigidBodyKernel(const std::vector<double>& coordinates, int dimension);

/// An orthonormal basis of those combinations of the given motions that vanish on the fixed dofs.
///
/// Found by a singular value decomposition of the motions' rows at the fixed dofs; singular values below
/// 1e-10 of the largest possible one count as zero. Without fixed dofs the given motions are orthonormalised.
/// @throws NumericalError if the given motions are linearly dependent.
Kernel heldKernel(const Kernel& motions, const std::vector<int>& fixed);

/// An orthonormal basis of those combinations of the given motions R that a symmetric positive semidefinite
/// matrix A does not feel, ARα = 0: as xᵀ(K + A)x = 0 only where both terms vanish, the kernel of K + A if R
/// spans that of K. Singular values of AR below 1e-12 of the largest possible one count as zero.
/// @throws NumericalError if the given motions are linearly dependent.
Kernel keptKernel(const Kernel& motions, const LocalMatrix& addition);

/// The combinations Bα of the columns of an orthonormal basis B for which Mα = 0.
/// @param image M, m rows, as many as columns at least, columns after each other. @param zero singular values
/// up to it are none.
Kernel combinationsThatVanish(const Kernel& basis, std::vector<double> image, int m, double zero);

/// v ← (I − RRᵀ)v for a kernel with orthonormal columns.
void removeKernel(const Kernel& kernel, std::vector<double>& v);

/// The rows of the kernel at the given dofs, in their order.
Kernel restricted(const Kernel& kernel, const std::vector<int>& dofs);

/// The smallest singular value of the kernel as a matrix; 0 if it has more columns than rows, or none.
double smallestSingularValue(const Kernel& kernel);

/// max_k ‖K r_k‖_∞ / (‖K‖_∞ ‖r_k‖_∞): zero up to rounding errors if the columns are in the kernel of K.
double kernelDefect(const LocalMatrix& matrix, const Kernel& kernel);

} // namespace Harmos::feti
