// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_SubdomainInput.hpp"

#include "Harmos_Errors.hpp"
#include "Harmos_TrilinosVersion.hpp"

#include <Tpetra_CrsMatrix.hpp>

#include <algorithm>
#include <numeric>

namespace Harmos::feti {
namespace {

LocalMatrix withSortedRows(LocalMatrix matrix) {
  std::vector<std::pair<int, double>> row;
  for (std::size_t i = 0; i + 1 < matrix.offsets.size(); ++i) {
    const auto begin = static_cast<std::ptrdiff_t>(matrix.offsets[i]),
               end = static_cast<std::ptrdiff_t>(matrix.offsets[i + 1]);
    if (std::is_sorted(matrix.columns.begin() + begin, matrix.columns.begin() + end))
      continue;
    row.clear();
    for (std::ptrdiff_t k = begin; k < end; ++k)
      row.emplace_back(matrix.columns[static_cast<std::size_t>(k)],
                       matrix.values[static_cast<std::size_t>(k)]);
    std::sort(row.begin(), row.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
    for (std::ptrdiff_t k = begin; k < end; ++k) {
      matrix.columns[static_cast<std::size_t>(k)] = row[static_cast<std::size_t>(k - begin)].first;
      matrix.values[static_cast<std::size_t>(k)] = row[static_cast<std::size_t>(k - begin)].second;
    }
  }
  return matrix;
}

} // namespace

template<class Offset>
std::shared_ptr<const LocalMatrix> localMatrix(int rows, const Offset* offsets, const int* columns,
                                               const double* values) {
  if (rows < 1)
    throw InputError("a subdomain's matrix needs at least one row, not " + std::to_string(rows));
  LocalMatrix result;
  result.offsets.clear();
  for (int i = 0; i <= rows; ++i) {
    if (offsets[i] < (i > 0 ? offsets[i - 1] : Offset(0)))
      throw InputError("the offsets of a subdomain's matrix decrease at row " + std::to_string(i));
    result.offsets.push_back(static_cast<std::size_t>(offsets[i]));
  }
  result.columns.assign(columns, columns + result.offsets.back());
  result.values.assign(values, values + result.offsets.back());
  for (int column : result.columns)
    if (column < 0 || column >= rows)
      throw InputError("a subdomain's matrix of " + std::to_string(rows) + " rows has a column " +
                       std::to_string(column));
  return std::make_shared<const LocalMatrix>(withSortedRows(std::move(result)));
}

template std::shared_ptr<const LocalMatrix> localMatrix(int, const int*, const int*, const double*);
template std::shared_ptr<const LocalMatrix> localMatrix(int, const std::size_t*, const int*, const double*);

std::shared_ptr<const LocalMatrix> localMatrix(const CrsMatrix& matrix) {
  if (!matrix.isFillComplete())
    throw InputError("a subdomain's matrix is not fill-complete; call fillComplete() first");
  const Map &rows = *matrix.getRowMap(), &columns = *matrix.getColMap();
  const auto here = static_cast<LocalOrdinal>(localSize(rows));
  // Columns are numbered as rows are.
  std::vector<int> rowOf(localSize(columns));
  for (std::size_t k = 0; k < rowOf.size(); ++k) {
    rowOf[k] = rows.getLocalElement(columns.getGlobalElement(static_cast<LocalOrdinal>(k)));
    if (rowOf[k] < 0)
      throw InputError("a subdomain's matrix has column " +
                       std::to_string(columns.getGlobalElement(static_cast<LocalOrdinal>(k))) +
                       ", which is not one of its rows on this rank; pass the matrix of the torn subdomain");
  }
  const auto local = matrix.getLocalMatrixHost();
  std::vector<std::size_t> offsets = {0};
  std::vector<int> places;
  std::vector<double> values;
  for (LocalOrdinal i = 0; i < here; ++i) {
    const auto row = local.rowConst(i);
    for (LocalOrdinal k = 0; k < row.length; ++k) {
      places.push_back(rowOf[static_cast<std::size_t>(row.colidx(k))]);
      values.push_back(row.value(k));
    }
    offsets.push_back(values.size());
  }
  return localMatrix(static_cast<int>(here), offsets.data(), places.data(), values.data());
}

Subdomain makeSubdomain(long long number, std::shared_ptr<const LocalMatrix> stiffness,
                        std::vector<double> load, std::vector<long long> dofs, Kernel motions,
                        std::vector<FixedDof> fixed) {
  const std::string name = "subdomain " + std::to_string(number);
  if (!stiffness)
    throw InputError(name + " has no stiffness matrix");
  const auto rows = static_cast<std::size_t>(stiffness->rows());
  if (load.size() != rows || dofs.size() != rows)
    throw InputError(name + ": a matrix of " + std::to_string(rows) +
                         " rows needs as many loads and global dofs, not " + std::to_string(load.size()) +
                         " and " + std::to_string(dofs.size()),
                     {{"subdomain", std::to_string(number)}});
  std::vector<int> all(rows);
  std::iota(all.begin(), all.end(), 0);
  Subdomain result;
  result.number = number;
  result.stiffness = std::move(stiffness);
  result.load = std::make_shared<const std::vector<double>>(std::move(load));
  result.interface = std::make_shared<const std::vector<int>>(std::move(all));
  result.numbers = std::move(dofs);
  result.fixed = std::move(fixed);
  result.motions = std::make_shared<const Kernel>(std::move(motions));
  return result;
}

} // namespace Harmos::feti
