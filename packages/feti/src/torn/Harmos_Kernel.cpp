// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_Kernel.hpp"

#include "Harmos_Errors.hpp"

#include <Teuchos_LAPACK.hpp>

#include <algorithm>
#include <cmath>
#include <string>

namespace Harmos::feti {
namespace {

// Orthonormalises the columns in place: Householder QR, then Q.
void orthonormalize(Kernel& kernel) {
  if (kernel.columns == 0)
    return;
  if (kernel.rows < kernel.columns)
    throw NumericalError("a kernel has more columns than the subdomain has dofs");
  Teuchos::LAPACK<int, double> lapack;
  std::vector<double> tau(static_cast<std::size_t>(kernel.columns)),
      work(static_cast<std::size_t>(64 * kernel.columns));
  int info = 0;
  double largest = 0.0;
  for (double value : kernel.values)
    largest = std::max(largest, std::abs(value));
  lapack.GEQRF(kernel.rows, kernel.columns, kernel.values.data(), kernel.rows, tau.data(), work.data(),
               static_cast<int>(work.size()), &info);
  for (int k = 0; k < kernel.columns; ++k)
    if (!(std::abs(kernel.column(k)[k]) > 1e-12 * largest))
      throw NumericalError("the columns of a kernel are linearly dependent (column " + std::to_string(k) +
                               ")",
                           {{"column", std::to_string(k)}});
  lapack.ORGQR(kernel.rows, kernel.columns, kernel.columns, kernel.values.data(), kernel.rows, tau.data(),
               work.data(), static_cast<int>(work.size()), &info);
}

} // namespace

Kernel constantKernel(int rows) {
  return {rows, 1, std::vector<double>(static_cast<std::size_t>(rows), 1.0)};
}

Kernel translationKernel(int rows, int components, int component) {
  Kernel kernel{rows, 1, std::vector<double>(static_cast<std::size_t>(rows), 0.0)};
  for (int row = component; row < rows; row += components)
    kernel.values[static_cast<std::size_t>(row)] = 1.0;
  return kernel;
}

Kernel rigidBodyKernel(const std::vector<double>& coordinates, int dimension) {
  HARMOS_REQUIRE(dimension == 2 || dimension == 3,
                 "rigid motions are those of a body in the plane or in space");
  const auto d = static_cast<std::size_t>(dimension);
  const std::size_t points = coordinates.size() / d;
  std::vector<double> centre(d, 0.0);
  for (std::size_t k = 0; k < points * d; ++k)
    centre[k % d] += coordinates[k] / static_cast<double>(points);
  // Rotations of a size near one, whatever the units of length.
  double extent = 0.0;
  for (std::size_t k = 0; k < points * d; ++k)
    extent = std::max(extent, std::abs(coordinates[k] - centre[k % d]));
  const double scale = extent > 0.0 ? 1.0 / extent : 1.0;

  Kernel kernel;
  kernel.rows = static_cast<int>(points * d);
  kernel.columns = dimension == 2 ? 3 : 6;
  kernel.values.assign(points * d * static_cast<std::size_t>(kernel.columns), 0.0);
  const auto at = [&](std::size_t point, std::size_t component, std::size_t column) -> double& {
    return kernel.values[column * points * d + point * d + component];
  };
  for (std::size_t point = 0; point < points; ++point) {
    for (std::size_t c = 0; c < d; ++c)
      at(point, c, c) = 1.0;
    std::size_t column = d;
    for (std::size_t a = 0; a < d; ++a)
      for (std::size_t b = a + 1; b < d; ++b, ++column) { // in the plane of axes a and b
        at(point, a, column) = -scale * (coordinates[point * d + b] - centre[b]);
        at(point, b, column) = scale * (coordinates[point * d + a] - centre[a]);
      }
  }
  return kernel;
}

Kernel combinationsThatVanish(const Kernel& basis, std::vector<double> image, int m, double zero) {
  const int k = basis.columns;
  std::vector<double> sigma(static_cast<std::size_t>(k)), vt(static_cast<std::size_t>(k * k)),
      work(static_cast<std::size_t>(10 * (m + 3 * k)));
  int info = 0;
  double unused = 0.0;
  // The k×k Gram matrix would square the condition number: decompose the rows themselves.
  Teuchos::LAPACK<int, double>().GESVD('N', 'A', m, k, image.data(), m, sigma.data(), &unused, 1, vt.data(),
                                       k, work.data(), static_cast<int>(work.size()), &unused, &info);
  HARMOS_REQUIRE(info == 0, "the singular value decomposition of a kernel failed");
  Kernel result;
  result.rows = basis.rows;
  for (int v = 0; v < k; ++v) {
    if (sigma[static_cast<std::size_t>(v)] > zero)
      continue;
    ++result.columns;
    for (int i = 0; i < basis.rows; ++i) {
      double sum = 0.0;
      for (int c = 0; c < k; ++c)
        sum += basis.column(c)[i] * vt[static_cast<std::size_t>(c * k + v)];
      result.values.push_back(sum);
    }
  }
  return result;
}

Kernel heldKernel(const Kernel& motions, const std::vector<int>& fixed) {
  Kernel basis = motions;
  orthonormalize(basis);
  if (fixed.empty() || basis.columns == 0)
    return basis;
  const int k = basis.columns;
  const int m = std::max(static_cast<int>(fixed.size()), k);
  std::vector<double> rows(static_cast<std::size_t>(m) * static_cast<std::size_t>(k), 0.0);
  for (int c = 0; c < k; ++c)
    for (std::size_t i = 0; i < fixed.size(); ++i)
      rows[static_cast<std::size_t>(c) * static_cast<std::size_t>(m) + i] = basis.column(c)[fixed[i]];
  // Columns of the basis have length one, so one fixed dof of a body of n dofs gives about n^(-1/2).
  return combinationsThatVanish(basis, std::move(rows), m,
                                1e-10 / std::sqrt(static_cast<double>(basis.rows)));
}

Kernel keptKernel(const Kernel& motions, const LocalMatrix& addition) {
  Kernel basis = motions;
  orthonormalize(basis);
  if (basis.columns == 0)
    return basis;
  const auto n = static_cast<std::size_t>(basis.rows);
  std::vector<double> image(n * static_cast<std::size_t>(basis.columns), 0.0);
  for (int c = 0; c < basis.columns; ++c)
    addition.multiply(basis.column(c), image.data() + static_cast<std::size_t>(c) * n);
  // As above; and what counts as zero must also pass for zero when the kernel is verified.
  return combinationsThatVanish(basis, std::move(image), basis.rows,
                                1e-12 * addition.infinityNorm() / std::sqrt(static_cast<double>(n)));
}

void removeKernel(const Kernel& kernel, std::vector<double>& v) {
  for (int k = 0; k < kernel.columns; ++k) {
    const double* r = kernel.column(k);
    double product = 0.0;
    for (std::size_t i = 0; i < v.size(); ++i)
      product += r[i] * v[i];
    for (std::size_t i = 0; i < v.size(); ++i)
      v[i] -= product * r[i];
  }
}

Kernel restricted(const Kernel& kernel, const std::vector<int>& dofs) {
  Kernel rows;
  rows.rows = static_cast<int>(dofs.size());
  rows.columns = kernel.columns;
  for (int k = 0; k < kernel.columns; ++k)
    for (int dof : dofs)
      rows.values.push_back(kernel.column(k)[dof]);
  return rows;
}

double smallestSingularValue(const Kernel& kernel) {
  const int m = kernel.rows, k = kernel.columns;
  if (k == 0 || m < k)
    return 0.0;
  std::vector<double> a = kernel.values, sigma(static_cast<std::size_t>(k)),
                      work(static_cast<std::size_t>(10 * (m + 3 * k)));
  int info = 0;
  double unused = 0.0;
  Teuchos::LAPACK<int, double>().GESVD('N', 'N', m, k, a.data(), m, sigma.data(), &unused, 1, &unused, 1,
                                       work.data(), static_cast<int>(work.size()), &unused, &info);
  HARMOS_REQUIRE(info == 0, "the singular value decomposition of a kernel failed");
  return sigma.back();
}

double kernelDefect(const LocalMatrix& matrix, const Kernel& kernel) {
  const double norm = matrix.infinityNorm();
  std::vector<double> image(static_cast<std::size_t>(kernel.rows));
  double result = 0.0;
  for (int k = 0; k < kernel.columns; ++k) {
    matrix.multiply(kernel.column(k), image.data());
    double largest = 0.0, largestImage = 0.0;
    for (int i = 0; i < kernel.rows; ++i) {
      largest = std::max(largest, std::abs(kernel.column(k)[i]));
      largestImage = std::max(largestImage, std::abs(image[static_cast<std::size_t>(i)]));
    }
    // A column of zeros is no motion, and a NaN must not be lost in a comparison.
    const double defect = largest > 0.0 && norm > 0.0 ? largestImage / (norm * largest) : 1.0;
    if (!(defect <= result))
      result = defect;
  }
  return result;
}

} // namespace Harmos::feti
