// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_NextMesh.hpp"

#include "Harmos_CellType.hpp"
#include "Harmos_Errors.hpp"
#include "Harmos_Exchange.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace Harmos::run {
namespace {

// The mean distance of two corners, over that of a cell whose edges have the length one: those that make a
// mesh of simplices have no others.
double meanEdge(const fem::PlacedMesh& placed, int cell) {
  const fem::CellShape& shape = fem::shapeOf(placed.mesh->cellType);
  const int* nodes = placed.mesh->cell(cell);
  double sum = 0.0, unit = 0.0;
  int pairs = 0;
  for (int a = 0; a < shape.corners; ++a)
    for (int b = 0; b < a; ++b, ++pairs) {
      const fem::Point x = placed.position(nodes[a]), y = placed.position(nodes[b]);
      sum += std::hypot(x[0] - y[0], x[1] - y[1], x[2] - y[2]);
      const fem::Point& u = shape.nodeCoordinates[static_cast<std::size_t>(a)];
      const fem::Point& v = shape.nodeCoordinates[static_cast<std::size_t>(b)];
      const double side = shape.isSimplex ? 1.0 : std::hypot(u[0] - v[0], u[1] - v[1], u[2] - v[2]);
      unit += side;
    }
  // Reference cells that are no simplices have edges of this length.
  const fem::Point& u = shape.nodeCoordinates[0];
  const fem::Point& v = shape.nodeCoordinates[1];
  const double edge = shape.isSimplex ? 1.0 : std::hypot(u[0] - v[0], u[1] - v[1], u[2] - v[2]);
  return sum / unit * edge;
}

double factorOf(double wish) {
  constexpr double finest = 0.5, coarsest = 2.0;
  return std::clamp(wish, finest, coarsest);
}

double cellsOf(const std::vector<double>& wishes, double c, double dimension) {
  double cells = 0.0;
  for (double wish : wishes)
    cells += std::pow(factorOf(c * wish), -dimension);
  return cells;
}

// The order of cells is not to depend on how they are spread, nor on the last bits of their places.
double largest(const std::vector<CellError>& cells) {
  double most = 0.0;
  for (const CellError& cell : cells)
    for (double coordinate : cell.centre)
      most = std::max(most, std::abs(coordinate));
  return most > 0.0 ? most : 1.0;
}

std::shared_ptr<const fem::SizeField> sizesAt(const std::vector<CellError>& cells,
                                              const std::vector<double>& lengths) {
  std::vector<fem::Point> places;
  for (const CellError& cell : cells)
    places.push_back(cell.centre);
  return std::make_shared<const fem::SizeField>(std::move(places), lengths);
}

std::array<long long, 3> keyOf(const fem::Point& x, double scale) {
  std::array<long long, 3> key{};
  for (std::size_t d = 0; d < 3; ++d)
    key[d] = std::llround(1e10 * x[d] / scale);
  return key;
}

} // namespace

std::vector<CellError> cellErrors(const Teuchos::Comm<int>& comm,
                                  const std::vector<scene::OwnedSubdomain>& owned,
                                  const std::vector<std::vector<double>>& squares) {
  std::vector<CellError> own;
  for (std::size_t i = 0; i < owned.size(); ++i) {
    const fem::PlacedMesh& placed = owned[i].mesh;
    const int corners = fem::shapeOf(placed.mesh->cellType).corners;
    for (int cell = 0; cell < placed.mesh->numberOfCells(); ++cell) {
      CellError item = {{}, meanEdge(placed, cell), squares[i][static_cast<std::size_t>(cell)]};
      for (int a = 0; a < corners; ++a)
        for (std::size_t d = 0; d < 3; ++d)
          item.centre[d] += placed.position(placed.mesh->cell(cell)[a])[d] / corners;
      own.push_back(item);
    }
  }
  std::vector<CellError> all = gatherAll(comm, own);
  std::sort(all.begin(), all.end(), [scale = largest(all)](const CellError& a, const CellError& b) {
    return keyOf(a.centre, scale) < keyOf(b.centre, scale);
  });
  return all;
}

NextMesh nextMesh(const std::vector<CellError>& cells, const MeshGoal& goal) {
  if (cells.empty())
    throw InternalError("a mesh without cells has no next one");
  const double p = goal.order, d = goal.dimension;
  double sum = 0.0;
  std::vector<double> wish; // r/C; of a cell without error there is no bound
  for (const CellError& cell : cells) {
    sum += std::pow(cell.square, d / (2.0 * p + d));
    wish.push_back(std::pow(cell.square, -1.0 / (2.0 * p + d)));
  }
  double c = sum > 0.0 ? std::pow(goal.error * goal.error / sum, 0.5 / p) : 1.0;
  NextMesh result = {nullptr, cellsOf(wish, c, d), {}};
  if (goal.maximumCells > 0.0 && result.cells > goal.maximumCells) {
    double most = c; // the number falls as this grows
    for (int k = 0; k < 200 && cellsOf(wish, most, d) > goal.maximumCells; ++k)
      most *= 2.0;
    for (int k = 0; k < 60; ++k) {
      const double middle = 0.5 * (c + most);
      (cellsOf(wish, middle, d) > goal.maximumCells ? c : most) = middle;
    }
    c = most;
    result.cells = cellsOf(wish, c, d);
  }
  for (std::size_t k = 0; k < cells.size(); ++k)
    result.lengths.push_back(factorOf(c * wish[k]) * cells[k].size / goal.stretch);
  result.sizes = sizesAt(cells, result.lengths);
  return result;
}

NextMesh finerAt(const std::vector<CellError>& cells, const std::vector<fem::Point>& places, int dimension,
                 double stretch) {
  constexpr double near = 1.5; // sizes of a cell, to its centre
  NextMesh result = {nullptr, 0.0, {}};
  for (const CellError& cell : cells) {
    const bool isNear = std::any_of(places.begin(), places.end(), [&](const fem::Point& place) {
      return std::hypot(place[0] - cell.centre[0], place[1] - cell.centre[1], place[2] - cell.centre[2]) <
             near * cell.size;
    });
    const double factor = isNear ? factorOf(0.0) : 1.0;
    result.cells += std::pow(factor, -dimension);
    result.lengths.push_back(factor * cell.size / stretch);
  }
  result.sizes = sizesAt(cells, result.lengths);
  return result;
}

} // namespace Harmos::run
