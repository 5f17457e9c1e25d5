// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_Errors.hpp"
#include "Harmos_LocalFactorization.hpp"
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

// A, with unit rows where some are absent.
LocalMatrix without(const LocalMatrix& matrix, const std::vector<int>& absent) {
  LocalMatrix result = matrix;
  std::vector<bool> isAbsent(static_cast<std::size_t>(result.rows()), false);
  for (int row : absent)
    isAbsent[static_cast<std::size_t>(row)] = true;
  for (std::size_t i = 0; i < isAbsent.size(); ++i)
    for (std::size_t k = result.offsets[i]; k < result.offsets[i + 1]; ++k) {
      const auto j = static_cast<std::size_t>(result.columns[k]);
      if (i != j && (isAbsent[i] || isAbsent[j]))
        result.values[k] = 0.0;
    }
  return result;
}

// Any solver of Amesos2, MUMPS by Harmos' own adapter, which alone has Schur complements and single
// precision. It solves for many right-hand sides at once, and always for all rows.
class AmesosFactorization : public LocalFactorization {
 public:
  AmesosFactorization(const LocalMatrix& matrix, const LocalFactorizationSettings& settings,
                      FactorizationContext& context)
      : patternHash_(patternHash(matrix)),
        absent_(settings.use == LocalFactorizationSettings::Boundary::Absent ? settings.boundary
                                                                             : std::vector<int>()),
        rows_(static_cast<std::size_t>(matrix.rows())) {
    // Teuchos::SerialComm makes Amesos2 crash; the rank's own MPI communicator does not.
    const auto self = Teuchos::rcp(new Teuchos::MpiComm<int>(MPI_COMM_SELF));
    map_ =
        Teuchos::rcp(new Map(static_cast<Tpetra::global_size_t>(rows_), 0, self, Tpetra::LocallyReplicated));
    b_ = Teuchos::rcp(new MultiVector(map_, 1));
    x_ = Teuchos::rcp(new MultiVector(map_, 1));
    if (settings.solver.blockLowRank > 0.0 || settings.solver.name == SparseSolverChoice::mumps)
      makeMumps(matrix, settings, context);
    else
      makeOther(matrix, settings);
    solver_->numericFactorization();
    take(matrix);
  }

  // In single precision with a step of refinement.
  void solve(double* x, int count) const override {
    if (!isSingle_)
      return solveOnce(x, count);
    const std::vector<double> b(x, x + rows_ * static_cast<std::size_t>(count));
    std::vector<double> residual(b.size());
    solveOnce(x, count);
    for (std::size_t c = 0; c < static_cast<std::size_t>(count); ++c)
      matrix_.multiply(x + c * rows_, residual.data() + c * rows_);
    for (std::size_t k = 0; k < b.size(); ++k)
      residual[k] = b[k] - residual[k];
    solveOnce(residual.data(), count);
    for (std::size_t k = 0; k < b.size(); ++k)
      x[k] += residual[k];
  }
  void solveAtEnds(double* x, int count) const override { solve(x, count); }

  std::vector<double> takeSchurComplement() override { return extras().schurComplement(); }
  void reduce(double* f, double* reduced, int count) const override { extras().condense(f, reduced, count); }
  void expand(double* f, double* boundary, int count) const override { extras().expand(f, boundary, count); }

  void refactor(const LocalMatrix& matrix) override {
    Details::requireGraph(patternHash_, matrix);
    solver_->setA(tpetraOf(matrix), Amesos2::SYMBFACT);
    solver_->numericFactorization();
    ++factorizations_;
    take(matrix);
  }

  double bytes() const override {
    const double entries = static_cast<double>(solver_->getStatus().getNnzLU());
    return entries * (isSingle_ ? 4.0 : 8.0) + 12.0 * static_cast<double>(matrix_.entries());
  }
  double bytesRead(int) const override { return 2.0 * bytes(); } // forward and backward
  double flops() const override { return 4.0 * static_cast<double>(solver_->getStatus().getNnzLU()); }
  FactorizationCounts counts() const override {
    // Amesos2 begins to count anew with each matrix.
    return {extras_.is_null() ? solver_->getStatus().getNumSymbolicFact() : extras_->statistics().analyses,
            factorizations_};
  }

 private:
  void makeMumps(const LocalMatrix& matrix, const LocalFactorizationSettings& settings,
                 FactorizationContext& context) {
    isSingle_ = settings.precision == Precision::Single;
    solver_ = makeMumpsSolver(tpetraOf(matrix), x_, b_);
    extras_ = Teuchos::rcp_dynamic_cast<MumpsExtras>(solver_);
    const auto list = Teuchos::parameterList("Amesos2");
    Teuchos::ParameterList& own = list->sublist(solver_->name());
    own.set("Symmetry", std::string("positive definite"));
    own.set("Precision", std::string(isSingle_ ? "single" : "double"));
    own.set("Block low rank tolerance", settings.solver.blockLowRank);
    solver_->setParameters(list);
    if (settings.use == LocalFactorizationSettings::Boundary::Absent)
      return analyse();
    std::vector<int>& position = context.position(matrix, settings.boundary);
    extras_->setSchurRows(settings.boundary);
    extras_->setOrdering(position);
    analyse();
    if (position.empty())
      position = extras_->ordering();
  }
  void take(const LocalMatrix& matrix) {
    if (isSingle_)
      matrix_ = absent_.empty() ? matrix : without(matrix, absent_);
  }
  void analyse() { solver_->symbolicFactorization(); }

  void makeOther(const LocalMatrix& matrix, const LocalFactorizationSettings& settings) {
    const std::string& name = settings.solver.name;
    if (!Details::isInAmesos(name))
      throw InputError("this Trilinos has no direct solver \"" + name +
                       "\" in Amesos2; use \"MUMPS\" or \"KLU2\"");
    HARMOS_REQUIRE(settings.use == LocalFactorizationSettings::Boundary::Absent,
                   "solvers of Amesos2 have no Schur complements");
    solver_ = Amesos2::create<CrsMatrix, MultiVector>(name, tpetraOf(matrix), x_, b_);
    analyse();
  }

  Teuchos::RCP<const CrsMatrix> tpetraOf(const LocalMatrix& matrix) const {
    return absent_.empty() ? toTpetra(matrix, map_) : toTpetra(without(matrix, absent_), map_);
  }

  MumpsExtras& extras() const {
    HARMOS_REQUIRE(!extras_.is_null(), "solvers of Amesos2 have no Schur complements");
    return *extras_;
  }

  void solveOnce(double* x, int count) const {
    const auto columns = static_cast<std::size_t>(count);
    if (b_->getNumVectors() != columns) {
      b_ = Teuchos::rcp(new MultiVector(map_, columns));
      x_ = Teuchos::rcp(new MultiVector(map_, columns));
      solver_->setX(x_);
      solver_->setB(b_);
    }
    {
      const auto view = b_->getLocalViewHost(Tpetra::Access::OverwriteAll);
      for (std::size_t c = 0; c < columns; ++c)
        std::copy(x + c * rows_, x + (c + 1) * rows_, &view(0, c));
    }
    solver_->solve();
    const auto view = x_->getLocalViewHost(Tpetra::Access::ReadOnly);
    for (std::size_t c = 0; c < columns; ++c)
      std::copy(&view(0, c), &view(0, c) + rows_, x + c * rows_);
  }

  std::size_t patternHash_;
  std::vector<int> absent_;
  std::size_t rows_;
  bool isSingle_ = false;
  LocalMatrix matrix_; // where residuals are to be computed
  int factorizations_ = 1;
  Teuchos::RCP<const Map> map_;
  Teuchos::RCP<DirectSolver> solver_;
  Teuchos::RCP<MumpsExtras> extras_; // of MUMPS
  mutable Teuchos::RCP<MultiVector> b_, x_;
};

} // namespace

bool Details::isInAmesos(const std::string& solver) {
  // Tacho of Trilinos 13.2 ends with a segmentation fault in Tacho::Driver::factorize() on half a ball in 48
  // subdomains, and newer ones were not tried. Amesos2 ignores the case of names.
  std::string lower = solver;
  std::transform(lower.begin(), lower.end(), lower.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return lower != "tacho" && Amesos2::query(solver);
}

std::unique_ptr<LocalFactorization>
Details::makeAmesosFactorization(const LocalMatrix& matrix, const LocalFactorizationSettings& settings,
                                 std::shared_ptr<FactorizationContext> context) {
  return std::make_unique<AmesosFactorization>(matrix, settings, *context);
}

} // namespace Harmos::feti
