// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_InverseQuality.hpp"

#include "Harmos_Mumps.hpp"

#include <algorithm>
#include <cmath>

namespace Harmos::feti {
namespace {

// Maximum that keeps a NaN, which std::max loses.
double largerOf(double a, double b) {
  return b <= a ? a : b;
}

double largestOf(const double* v, std::size_t n) {
  double result = 0.0;
  for (std::size_t i = 0; i < n; ++i)
    result = largerOf(result, std::abs(v[i]));
  return result;
}

// Without underflow: squares of numbers near 1e-300 are zero.
double norm(const double* v, std::size_t n) {
  const double largest = largestOf(v, n);
  double sum = 0.0;
  for (std::size_t i = 0; largest > 0.0 && i < n; ++i)
    sum += (v[i] / largest) * (v[i] / largest);
  return largest > 0.0 ? largest * std::sqrt(sum) : largest;
}

// Connected parts of the graph of the entries that are not zero.
int connectedParts(const LocalMatrix& matrix) {
  std::vector<int> part(static_cast<std::size_t>(matrix.rows()), -1);
  int parts = 0;
  std::vector<int> front;
  // A row with nothing but a diagonal is a prescribed displacement.
  const auto isAlone = [&](int row) {
    const auto i = static_cast<std::size_t>(row);
    for (std::size_t k = matrix.offsets[i]; k < matrix.offsets[i + 1]; ++k)
      if (matrix.columns[k] != row && matrix.values[k] != 0.0)
        return false;
    return true;
  };
  for (int start = 0; start < matrix.rows(); ++start) {
    if (part[static_cast<std::size_t>(start)] >= 0 || isAlone(start))
      continue;
    front = {start};
    part[static_cast<std::size_t>(start)] = parts;
    while (!front.empty()) {
      const auto i = static_cast<std::size_t>(front.back());
      front.pop_back();
      for (std::size_t k = matrix.offsets[i]; k < matrix.offsets[i + 1]; ++k) {
        int& other = part[static_cast<std::size_t>(matrix.columns[k])];
        if (matrix.values[k] != 0.0 && other < 0) {
          other = parts;
          front.push_back(matrix.columns[k]);
        }
      }
    }
    ++parts;
  }
  return parts;
}

} // namespace

InverseQuality inverseQuality(const LocalMatrix& matrix, const Kernel& kernel, const LocalInverse& inverse) {
  const auto n = static_cast<std::size_t>(matrix.rows());
  // First column: Kx, for the defect. Second: b with much of the slow modes and without the known motions. K⁺
  // of a right-hand side in the range of K cannot show a motion that K does not resist and R does not
  // contain: K wipes the spurious part out again. That of any other b is dominated by it, because the
  // regularised matrix then has an eigenvalue at the level of rounding errors. Otherwise v is an ordinary
  // vector, of which K, its rows divided by their diagonal, leaves a part of the size of 1/κ at least.
  std::vector<double> x(n), columns(2 * n), image(n), b(n);
  for (std::size_t i = 0; i < n; ++i) {
    x[i] = std::sin(1.0 + 1.7 * static_cast<double>(i) + 0.3 * static_cast<double>(i % 7));
    b[i] = (2 * i < n ? 1.0 : -1.0) +
           0.5 * std::cos(0.5 + 2.3 * static_cast<double>(i) + 0.1 * static_cast<double>(i % 5));
  }
  removeKernel(kernel, b); // the known motions answer b with their own part, which is not looked for
  std::vector<double> kx(n);
  matrix.multiply(x.data(), kx.data());
  std::copy(kx.begin(), kx.end(), columns.begin());
  std::copy(b.begin(), b.end(), columns.begin() + static_cast<std::ptrdiff_t>(n));
  inverse.apply(columns.data(), 2);

  InverseQuality quality;
  matrix.multiply(columns.data(), image.data());
  for (std::size_t i = 0; i < n; ++i)
    image[i] -= kx[i];
  const double scale = norm(kx.data(), n);
  quality.defect = norm(image.data(), n) / scale; // no number is a failure as well

  std::vector<double> v(columns.begin() + static_cast<std::ptrdiff_t>(n), columns.end());
  removeKernel(kernel, v);
  matrix.multiply(v.data(), image.data());
  const std::vector<double> diagonal = matrix.diagonal();
  for (std::size_t i = 0; i < n; ++i)
    image[i] /= diagonal[i];
  quality.resistance = largestOf(image.data(), n) / largestOf(v.data(), n);
  return quality;
}

DefectLimit defectLimit(const InverseQuality& quality, const LocalInverseSettings& settings) {
  // Where κ is small, and what compressed factors leave: the user's accuracy times κ.
  const bool single = settings.precision == Precision::Single;
  const double factor = single ? 300.0 : 1e4, unitRoundoff = single ? 0x1p-24 : 0x1p-53;
  const double least = single ? 1e-4 : 1e-8;
  const double accuracy = std::max(factor * unitRoundoff, 10.0 * settings.solver.blockLowRank);
  // Two digits are the least that an answer is worth; double precision is to stay below the tolerance of an
  // ordinary run, 1e-4, by a factor.
  const double most = single || settings.solver.blockLowRank > 0.0 ? 1e-2 : 1e-5;
  const double rounding = std::max(least, accuracy * quality.condition());
  return {rounding, std::min(most, rounding)};
}

int countNullPivots(const LocalMatrix& matrix) {
  MumpsOptions options;
  options.symmetry = MumpsOptions::Symmetry::Symmetric;
  options.nullPivotThreshold = 1e-8;
  Mumps mumps(MPI_COMM_SELF, options);
  Triplets triplets = lowerTriangle(matrix, 1);
  mumps.analyse(matrix.rows(), std::move(triplets.rows), std::move(triplets.columns));
  mumps.factorize(std::move(triplets.values));
  return static_cast<int>(mumps.nullPivots().size());
}

HiddenMotion causeOfHiddenMotion(const LocalMatrix& matrix, const Kernel& kernel) {
  const int parts = connectedParts(matrix);
  if (parts > 1)
    return {"it consists of " + std::to_string(parts) +
                " parts that are not connected; make each a subdomain or connect them",
            false};
  if (kernel.columns == 0)
    return {"it lacks support: its Dirichlet conditions and other constraints leave a rigid-body mode free",
            true};
  return {"it contains a mechanism or a hinge (parts joined at too few nodes, a material of almost no "
          "stiffness), or its cells are so thin and nearly incompressible that rounding errors hide its "
          "stiffness",
          true};
}

} // namespace Harmos::feti
