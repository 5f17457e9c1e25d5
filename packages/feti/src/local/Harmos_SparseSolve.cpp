// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_SparseSolve.hpp"

#include "Harmos_Errors.hpp"
#include "Harmos_MumpsSolver.hpp"

#include <Amesos2.hpp>
#include <Teuchos_DefaultMpiComm.hpp>
#include <Tpetra_CrsMatrix.hpp>
#include <Tpetra_MultiVector.hpp>

#include <algorithm>
#include <cctype>

namespace Harmos::feti {
namespace {

Teuchos::RCP<const CrsMatrix> toTpetra(const LocalMatrix& matrix, const Teuchos::RCP<const Map>& map) {
  using LocalMatrixType = CrsMatrix::local_matrix_device_type;
  const std::size_t n = matrix.offsets.size() - 1;
  LocalMatrixType::row_map_type::non_const_type offsets("offsets", n + 1);
  LocalMatrixType::index_type::non_const_type columns("columns", matrix.entries());
  LocalMatrixType::values_type::non_const_type values("values", matrix.entries());
  std::copy(matrix.offsets.begin(), matrix.offsets.end(), offsets.data());
  std::copy(matrix.columns.begin(), matrix.columns.end(), columns.data());
  std::copy(matrix.values.begin(), matrix.values.end(), values.data());
  const Teuchos::RCP<CrsMatrix> result = Teuchos::rcp(new CrsMatrix(map, map, offsets, columns, values));
  result->expertStaticFillComplete(map, map);
  return result;
}

} // namespace

SparseSolve::SparseSolve(const LocalMatrix& matrix, const std::string& solver, Precision precision,
                         double blockLowRank)
    : patternHash_(patternHash(matrix)), precision_(precision), rows_(matrix.rows()) {
  // Teuchos::SerialComm makes Amesos2 crash; the rank's own MPI communicator does not.
  const auto self = Teuchos::rcp(new Teuchos::MpiComm<int>(MPI_COMM_SELF));
  map_ = Teuchos::rcp(new Map(static_cast<Tpetra::global_size_t>(rows_), 0, self, Tpetra::LocallyReplicated));
  b_ = Teuchos::rcp(new MultiVector(map_, 1));
  x_ = Teuchos::rcp(new MultiVector(map_, 1));
  const Teuchos::RCP<const CrsMatrix> tpetra = toTpetra(matrix, map_);
  if (solver == "MUMPS") {
    solver_ = makeMumpsSolver(tpetra, x_, b_);
    const auto list = Teuchos::parameterList("Amesos2");
    Teuchos::ParameterList& own = list->sublist(solver_->name());
    own.set("Symmetry", std::string("positive definite"));
    own.set("Precision", std::string(precision == Precision::Single ? "single" : "double"));
    own.set("Block low rank tolerance", blockLowRank);
    solver_->setParameters(list);
  } else {
    if (!isAvailable(solver))
      throw InputError("this Trilinos has no direct solver \"" + solver +
                       "\" in Amesos2; use \"MUMPS\" or \"KLU2\"");
    solver_ = Amesos2::create<CrsMatrix, MultiVector>(solver, tpetra, x_, b_);
    precision_ = Precision::Double;
  }
  solver_->symbolicFactorization();
  solver_->numericFactorization();
  if (precision_ == Precision::Single)
    refined_ = matrix;
}

SparseSolve::~SparseSolve() = default;

void requireGraph(std::size_t hash, const LocalMatrix& matrix) {
  if (patternHash(matrix) != hash)
    throw InputError("the graph of the matrix differs from the one analysed; repeat the analysis");
}

void SparseSolve::refactor(const LocalMatrix& matrix) {
  requireGraph(patternHash_, matrix);
  solver_->setA(toTpetra(matrix, map_), Amesos2::SYMBFACT);
  solver_->numericFactorization();
  ++factorizations_;
  if (precision_ == Precision::Single)
    refined_ = matrix;
}

FactorizationCounts SparseSolve::counts() const {
  // Amesos2 begins to count anew with each matrix.
  const auto mumps = Teuchos::rcp_dynamic_cast<const MumpsExtras>(solver_);
  return {mumps.is_null() ? solver_->getStatus().getNumSymbolicFact() : mumps->statistics().analyses,
          factorizations_};
}

bool SparseSolve::isAvailable(const std::string& solver) {
  // Tacho of Trilinos 13.2 ends with a segmentation fault in Tacho::Driver::factorize() on half a ball in 48
  // subdomains, and newer ones were not tried. Amesos2 ignores the case of names.
  std::string lower = solver;
  std::transform(lower.begin(), lower.end(), lower.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return solver == "MUMPS" || (lower != "tacho" && Amesos2::query(solver));
}

void SparseSolve::solveOnce(double* x, int count) const {
  if (b_->getNumVectors() != static_cast<std::size_t>(count)) {
    b_ = Teuchos::rcp(new MultiVector(map_, static_cast<std::size_t>(count)));
    x_ = Teuchos::rcp(new MultiVector(map_, static_cast<std::size_t>(count)));
    solver_->setX(x_);
    solver_->setB(b_);
  }
  const auto n = static_cast<std::size_t>(rows_);
  {
    const auto view = b_->getLocalViewHost(Tpetra::Access::OverwriteAll);
    for (std::size_t c = 0; c < static_cast<std::size_t>(count); ++c)
      std::copy(x + c * n, x + (c + 1) * n, &view(0, c));
  }
  solver_->solve();
  const auto view = x_->getLocalViewHost(Tpetra::Access::ReadOnly);
  for (std::size_t c = 0; c < static_cast<std::size_t>(count); ++c)
    std::copy(&view(0, c), &view(0, c) + n, x + c * n);
}

void SparseSolve::solve(double* x, int count) const {
  if (precision_ == Precision::Double)
    return solveOnce(x, count);
  const auto n = static_cast<std::size_t>(rows_);
  std::vector<double> b(x, x + n * static_cast<std::size_t>(count)), residual(b.size());
  solveOnce(x, count);
  for (std::size_t c = 0; c < static_cast<std::size_t>(count); ++c)
    refined_.multiply(x + c * n, residual.data() + c * n);
  for (std::size_t k = 0; k < b.size(); ++k)
    residual[k] = b[k] - residual[k];
  solveOnce(residual.data(), count);
  for (std::size_t k = 0; k < b.size(); ++k)
    x[k] += residual[k];
}

double SparseSolve::bytes() const {
  const double entries = static_cast<double>(solver_->getStatus().getNnzLU());
  const double kept = 12.0 * static_cast<double>(refined_.entries());
  return entries * (precision_ == Precision::Single ? 4.0 : 8.0) + kept;
}

double SparseSolve::flops() const {
  return 4.0 * static_cast<double>(solver_->getStatus().getNnzLU());
}

} // namespace Harmos::feti
