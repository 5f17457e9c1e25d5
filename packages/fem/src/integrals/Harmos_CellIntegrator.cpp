// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_CellIntegrator.hpp"

#include "Harmos_Errors.hpp"
#include "Harmos_Log.hpp"

#include <algorithm>

namespace Harmos::fem {
namespace {

using Matrix = std::array<std::array<double, 3>, 3>;

// Determinant and inverse of the leading block of order d.
double invert(const Matrix& j, int d, Matrix& inverse) {
  if (d == 2) {
    const double det = j[0][0] * j[1][1] - j[0][1] * j[1][0];
    inverse[0][0] = j[1][1] / det;
    inverse[0][1] = -j[0][1] / det;
    inverse[1][0] = -j[1][0] / det;
    inverse[1][1] = j[0][0] / det;
    return det;
  }
  for (std::size_t a = 0; a < 3; ++a)
    for (std::size_t b = 0; b < 3; ++b) {
      const std::size_t r = (b + 1) % 3, s = (b + 2) % 3, u = (a + 1) % 3, v = (a + 2) % 3;
      inverse[a][b] = j[r][u] * j[s][v] - j[r][v] * j[s][u]; // cofactors, transposed
    }
  const double det = j[0][0] * inverse[0][0] + j[0][1] * inverse[1][0] + j[0][2] * inverse[2][0];
  for (auto& row : inverse)
    for (double& entry : row)
      entry /= det;
  return det;
}

} // namespace

CellIntegrator::CellIntegrator(const Mesh& mesh, const ReferenceElement& element)
    : mesh_(mesh),
      element_(element),
      corners_(static_cast<std::size_t>(element.basisSize())),
      measures_(static_cast<std::size_t>(element.points())),
      gradients_(static_cast<std::size_t>(element.points() * element.basisSize())) {
  HARMOS_REQUIRE(element.basisSize() == mesh.nodesPerCell(), "element and mesh are of different cell types");
}

void CellIntegrator::turnTo(int cell) {
  cell_ = cell;
  const int* nodes = mesh_.cell(cell);
  const int d = mesh_.dimension();
  const auto dimension = static_cast<std::size_t>(d);
  const Point first = mesh_.local(nodes[0]);
  // Relative to the first node, which keeps the cell's place out of the rounding errors.
  for (std::size_t i = 0; i < corners_.size(); ++i) {
    const Point x = mesh_.local(nodes[i]);
    for (std::size_t k = 0; k < 3; ++k)
      corners_[i][k] = x[k] - first[k];
  }
  for (int q = 0; q < points(); ++q) {
    Matrix j{}, inverse{};
    for (std::size_t i = 1; i < corners_.size(); ++i) {
      const Point& g = element_.gradient(static_cast<int>(i), q);
      for (std::size_t a = 0; a < dimension; ++a)
        for (std::size_t b = 0; b < dimension; ++b)
          j[a][b] += corners_[i][a] * g[b];
    }
    const double det = invert(j, d, inverse);
    if (!(det > 0.0)) {
      const Point x = position(q);
      const std::string place = "(" + scientific(x[0], 6) + ", " + scientific(x[1], 6) +
                                (d == 3 ? ", " + scientific(x[2], 6) : "") + ")";
      throw NumericalError("cell " + std::to_string(cell) + " (" + shapeOf(mesh_.cellType).name +
                               ") is inverted or has no " + (d == 2 ? "area" : "volume") +
                               ": its Jacobian is " + scientific(det) + " at " + place +
                               " relative to the subdomain's anchor; check the order of its nodes and their "
                               "coordinates",
                           {{"cell", std::to_string(cell)}, {"jacobian", scientific(det)}});
    }
    measures_[static_cast<std::size_t>(q)] = element_.weight(q) * det;
    if (mesh_.isAxisymmetric || !mesh_.thickness.empty())
      measures_[static_cast<std::size_t>(q)] *= mesh_.around(cell_, position(q));
    for (int i = 0; i < basisSize(); ++i) {
      const Point& g = element_.gradient(i, q);
      Point& gradient = gradients_[static_cast<std::size_t>(q * basisSize() + i)];
      gradient = {};
      for (std::size_t a = 0; a < dimension; ++a)
        for (std::size_t b = 0; b < dimension; ++b)
          gradient[a] += inverse[b][a] * g[b];
    }
  }
}

Point CellIntegrator::position(int q) const {
  Point x = mesh_.local(mesh_.cell(cell_)[0]);
  for (std::size_t i = 1; i < corners_.size(); ++i)
    for (std::size_t k = 0; k < 3; ++k)
      x[k] += element_.value(static_cast<int>(i), q) * corners_[i][k];
  return x;
}

double CellIntegrator::size() const {
  double sum = 0.0;
  for (double measure : measures_)
    sum += measure;
  return sum;
}

BlockAssembler::BlockAssembler(const Mesh& mesh, int components) : mesh_(mesh), components_(components) {
  const auto n = static_cast<std::size_t>(mesh.numberOfNodes());
  const auto perCell = static_cast<std::size_t>(mesh.nodesPerCell());
  std::vector<std::size_t> count(n, 0);
  for (int node : mesh.cells)
    count[static_cast<std::size_t>(node)] += perCell;
  std::vector<std::vector<int>> neighbours(n);
  for (std::size_t i = 0; i < n; ++i)
    neighbours[i].reserve(count[i]);
  for (std::size_t c = 0; c < mesh.cells.size(); c += perCell)
    for (std::size_t a = 0; a < perCell; ++a) {
      std::vector<int>& row = neighbours[static_cast<std::size_t>(mesh.cells[c + a])];
      row.insert(row.end(), mesh.cells.begin() + static_cast<std::ptrdiff_t>(c),
                 mesh.cells.begin() + static_cast<std::ptrdiff_t>(c + perCell));
    }
  offsets_ = {0};
  for (std::vector<int>& row : neighbours) {
    std::sort(row.begin(), row.end());
    row.erase(std::unique(row.begin(), row.end()), row.end());
    columns_.insert(columns_.end(), row.begin(), row.end());
    offsets_.push_back(columns_.size());
    for (int a = 0; a < components; ++a) {
      for (int node : row)
        for (int b = 0; b < components; ++b)
          matrix_.columns.push_back(node * components + b);
      matrix_.offsets.push_back(matrix_.columns.size());
    }
    std::vector<int>().swap(row);
  }
  matrix_.values.assign(matrix_.columns.size(), 0.0);
}

void BlockAssembler::add(int cell, const std::vector<double>& values) {
  const int* nodes = mesh_.cell(cell);
  const auto m = static_cast<std::size_t>(components_);
  const std::size_t width = static_cast<std::size_t>(mesh_.nodesPerCell()) * m;
  for (std::size_t i = 0; i < width / m; ++i) {
    const auto row = static_cast<std::size_t>(nodes[i]);
    const auto begin = columns_.begin() + static_cast<std::ptrdiff_t>(offsets_[row]);
    const auto end = columns_.begin() + static_cast<std::ptrdiff_t>(offsets_[row + 1]);
    for (std::size_t j = 0; j < width / m; ++j) {
      const auto place = static_cast<std::size_t>(std::lower_bound(begin, end, nodes[j]) - begin) * m;
      for (std::size_t a = 0; a < m; ++a) {
        double* target = matrix_.values.data() + matrix_.offsets[row * m + a] + place;
        for (std::size_t b = 0; b < m; ++b)
          target[b] += values[(i * m + a) * width + j * m + b];
      }
    }
  }
}

} // namespace Harmos::fem
