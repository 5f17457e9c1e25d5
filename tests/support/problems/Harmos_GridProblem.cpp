// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_GridProblem.hpp"

#include "Harmos_TrilinosVersion.hpp"

#include <Ifpack2_Factory.hpp>
#include <MueLu_CreateTpetraPreconditioner.hpp>
#include <Tpetra_CrsMatrix.hpp>
#include <Tpetra_Import.hpp>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <vector>

namespace Harmos {
namespace {

// Row i of a grid: its index along x, and along y.
struct Place {
  int i, j;
};

Place place(const GridProblem& grid, GlobalOrdinal index) {
  return {static_cast<int>(index % grid.n), static_cast<int>(index / grid.n)};
}

Teuchos::ParameterList multigridParameters() {
  Teuchos::ParameterList list;
  list.set("verbosity", std::string("none"));
  list.set("coarse: max size", 500);
  list.set("smoother: type", std::string("RELAXATION"));
  list.sublist("smoother: params").set("relaxation: type", std::string("Symmetric Gauss-Seidel"));
  return list;
}

} // namespace

GridProblem gridProblem(const Teuchos::RCP<const Teuchos::Comm<int>>& comm, int n, double lengthX,
                        double lengthY, const std::function<double(double)>& weight,
                        const std::function<double(double, double)>& load,
                        const std::function<double(double, double)>& boundary) {
  GridProblem grid;
  grid.boundary = boundary;
  grid.n = n;
  grid.lengthX = lengthX;
  grid.lengthY = lengthY;
  const auto size = static_cast<Tpetra::global_size_t>(n) * static_cast<Tpetra::global_size_t>(n);
  grid.map = Teuchos::rcp(new Map(size, 0, comm));
  grid.rhs = gridFunction(grid, [&](double x, double y) { return load(x, y) * grid.hx() * grid.hy(); });
  grid.matrix = Teuchos::rcp(new CrsMatrix(grid.map, 5));
  const double hx = grid.hx(), hy = grid.hy();
  const auto rhs = grid.rhs->getLocalViewHost(Tpetra::Access::ReadWrite);
  std::vector<GlobalOrdinal> columns;
  std::vector<double> values;
  for (std::size_t l = 0; l < localSize(*grid.map); ++l) {
    const GlobalOrdinal row = grid.map->getGlobalElement(static_cast<LocalOrdinal>(l));
    const Place at = place(grid, row);
    const double x = (at.i + 1) * hx, w = weight(x), east = weight(x + hx), west = weight(x - hx);
    // Each edge belongs to two triangles; a triangle's weight is the mean of its corners.
    const double toEast = 0.5 * (w + east) * hy / hx, toWest = 0.5 * (w + west) * hy / hx;
    const double along = (4.0 * w + east + west) / 6.0 * hx / hy;
    columns = {row};
    values = {toEast + toWest + 2.0 * along};
    const double y = (at.j + 1) * hy;
    const auto couple = [&](int di, int dj, double value) {
      if (at.i + di < 0 || at.i + di >= n || at.j + dj < 0 || at.j + dj >= n) {
        if (boundary)
          rhs(l, 0) += value * boundary(x + di * hx, y + dj * hy);
        return;
      }
      const GlobalOrdinal column = row + di + static_cast<GlobalOrdinal>(dj) * n;
      columns.push_back(column);
      values.push_back(-value);
    };
    couple(-1, 0, toWest);
    couple(1, 0, toEast);
    couple(0, -1, along);
    couple(0, 1, along);
    grid.matrix->insertGlobalValues(row, Teuchos::arrayViewFromVector(columns),
                                    Teuchos::arrayViewFromVector(values));
  }
  grid.matrix->fillComplete();
  return grid;
}

Teuchos::RCP<MultiVector> gridFunction(const GridProblem& grid,
                                       const std::function<double(double, double)>& value) {
  const auto result = Teuchos::rcp(new MultiVector(grid.map, 1));
  const auto view = result->getLocalViewHost(Tpetra::Access::OverwriteAll);
  for (std::size_t l = 0; l < view.extent(0); ++l) {
    const Place at = place(grid, grid.map->getGlobalElement(static_cast<LocalOrdinal>(l)));
    view(l, 0) = value((at.i + 1) * grid.hx(), (at.j + 1) * grid.hy());
  }
  return result;
}

void interpolate(const GridProblem& coarse, const MultiVector& from, const GridProblem& fine,
                 MultiVector& to) {
  // The coarse points around a fine one, as offsets of the point below and to the left, −1 … n_c − 1.
  const auto below = [&](int k) {
    const double position = (k + 1) * static_cast<double>(coarse.n + 1) / (fine.n + 1) - 1.0;
    return std::pair<int, double>(static_cast<int>(std::floor(position)), position - std::floor(position));
  };
  int first = coarse.n, last = -1;
  for (std::size_t l = 0; l < localSize(*fine.map); ++l) {
    const int j = below(place(fine, fine.map->getGlobalElement(static_cast<LocalOrdinal>(l))).j).first;
    first = std::min(first, std::max(j, 0));
    last = std::max(last, std::min(j + 1, coarse.n - 1));
  }
  std::vector<GlobalOrdinal> needed;
  for (int j = first; j <= last; ++j)
    for (int i = 0; i < coarse.n; ++i)
      needed.push_back(static_cast<GlobalOrdinal>(j) * coarse.n + i);
  const auto neededMap =
      Teuchos::rcp(new Map(Teuchos::OrdinalTraits<Tpetra::global_size_t>::invalid(),
                           Teuchos::arrayViewFromVector(needed), 0, coarse.map->getComm()));
  MultiVector values(neededMap, 1);
  values.doImport(from, Tpetra::Import<LocalOrdinal, GlobalOrdinal, Node>(coarse.map, neededMap),
                  Tpetra::INSERT);
  const auto source = values.getLocalViewHost(Tpetra::Access::ReadOnly);
  const auto value = [&](int i, int j) {
    if (i < 0 || j < 0 || i >= coarse.n || j >= coarse.n)
      return coarse.boundary ? coarse.boundary((i + 1) * coarse.hx(), (j + 1) * coarse.hy()) : 0.0;
    return source(static_cast<std::size_t>(j - first) * static_cast<std::size_t>(coarse.n) +
                      static_cast<std::size_t>(i),
                  0);
  };
  const auto target = to.getLocalViewHost(Tpetra::Access::OverwriteAll);
  for (std::size_t l = 0; l < target.extent(0); ++l) {
    const Place at = place(fine, fine.map->getGlobalElement(static_cast<LocalOrdinal>(l)));
    const auto [i, s] = below(at.i);
    const auto [j, t] = below(at.j);
    target(l, 0) = (1 - t) * ((1 - s) * value(i, j) + s * value(i + 1, j)) +
                   t * ((1 - s) * value(i, j + 1) + s * value(i + 1, j + 1));
  }
}

Teuchos::RCP<Operator> multigrid(const Teuchos::RCP<CrsMatrix>& matrix) {
  Teuchos::ParameterList list = multigridParameters();
  return MueLu::CreateTpetraPreconditioner(Teuchos::rcp_implicit_cast<Operator>(matrix), list);
}

Teuchos::RCP<Operator> incompleteFactor(const Teuchos::RCP<CrsMatrix>& matrix, int fill) {
  using RowMatrix = Tpetra::RowMatrix<Scalar, LocalOrdinal, GlobalOrdinal, Node>;
  const auto factor = Ifpack2::Factory().create<RowMatrix>("RILUK", matrix);
  Teuchos::ParameterList list;
  list.set("fact: iluk level-of-fill", fill);
  factor->setParameters(list);
  factor->initialize();
  factor->compute();
  return factor;
}

MultigridOnFace::MultigridOnFace(Teuchos::RCP<const CrsMatrix> matrix, double tolerance)
    : matrix_(std::move(matrix)), tolerance_(tolerance) {}

Teuchos::RCP<const Operator> MultigridOnFace::build(const MultiVector& free) {
  if (!hierarchy_.is_null()) {
    MultiVector change(free, Teuchos::Copy);
    change.update(-1.0, *lastFree_, 1.0);
    if (change.getVector(0)->norm1() <= tolerance_ * static_cast<double>(free.getGlobalLength()))
      return hierarchy_;
  }
  const auto start = std::chrono::steady_clock::now();
  lastFree_ = Teuchos::rcp(new MultiVector(free, Teuchos::Copy));
  MultiVector mask(matrix_->getColMap(), 1);
  if (matrix_->getGraph()->getImporter().is_null())
    mask.assign(free);
  else
    mask.doImport(free, *matrix_->getGraph()->getImporter(), Tpetra::INSERT);
  if (face_.is_null())
    face_ = Teuchos::rcp(new CrsMatrix(*matrix_, Teuchos::Copy));
  else
    face_->resumeFill();
  {
    const auto isFree = mask.getLocalViewHost(Tpetra::Access::ReadOnly);
    const auto rows = free.getLocalViewHost(Tpetra::Access::ReadOnly);
    const auto from = matrix_->getLocalMatrixHost();
    const auto to = face_->getLocalMatrixHost();
    for (LocalOrdinal r = 0; r < from.numRows(); ++r)
      for (auto e = from.graph.row_map(r); e < from.graph.row_map(r + 1); ++e) {
        const LocalOrdinal c = from.graph.entries(e);
        const bool diagonal =
            matrix_->getColMap()->getGlobalElement(c) == matrix_->getRowMap()->getGlobalElement(r);
        const bool keep = diagonal || (rows(r, 0) != 0.0 && isFree(c, 0) != 0.0);
        to.values(e) = keep ? from.values(e) : 0.0;
      }
  }
  // The aggregates are those of the whole matrix: on a face, points without couplings would be left out, and
  // be missing when they are freed.
  if (hierarchy_.is_null()) {
    Teuchos::ParameterList list = multigridParameters();
    list.set("reuse: type", std::string("tP"));
    const auto whole = Teuchos::rcp(new CrsMatrix(*matrix_, Teuchos::Copy));
    hierarchy_ = MueLu::CreateTpetraPreconditioner(Teuchos::rcp_implicit_cast<Operator>(whole), list);
  } else {
    face_->fillComplete(face_->getDomainMap(), face_->getRangeMap());
  }
  using Hierarchy = MueLu::TpetraOperator<Scalar, LocalOrdinal, GlobalOrdinal, Node>;
  MueLu::ReuseTpetraPreconditioner(face_, *Teuchos::rcp_dynamic_cast<Hierarchy>(hierarchy_, true));
  seconds_ += std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  return hierarchy_;
}

} // namespace Harmos
