// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_MumpsSolver.hpp"

#include "Harmos_Errors.hpp"
#include "Harmos_Mumps.hpp"

#include <Amesos2_SolverCore_decl.hpp>
#include <Amesos2_SolverCore_def.hpp>
#include <Amesos2_Util.hpp>
#include <Teuchos_DefaultMpiComm.hpp>
#include <Teuchos_StandardParameterEntryValidators.hpp>
#include <Tpetra_CrsMatrix.hpp>

#include <memory>

namespace Harmos::feti {
namespace {

template<class Matrix, class Vector>
class MumpsSolver : public Amesos2::SolverCore<MumpsSolver, Matrix, Vector>, public MumpsExtras {
  friend class Amesos2::SolverCore<MumpsSolver, Matrix, Vector>;

 public:
  static const char* name; // its parameter sublist's name, as Amesos2 wants it

  using Core = Amesos2::SolverCore<MumpsSolver, Matrix, Vector>;
  using SizeType = typename Core::global_size_type;

  MumpsSolver(Teuchos::RCP<const Matrix> matrix, Teuchos::RCP<Vector> x, Teuchos::RCP<const Vector> b)
      : Core(matrix, x, b) {}

  void setSchurRows(std::vector<int> rows) override { schurRows_ = std::move(rows); }
  void setOrdering(std::vector<int> position) override { position_ = std::move(position); }
  std::vector<int> ordering() const override { return factored().ordering(); }
  std::vector<double> schurComplement() override { return factored().schurComplement(); }
  void condense(double* rightHandSides, double* reduced, int count) override {
    factored().condense(rightHandSides, reduced, count);
  }
  void expand(double* rightHandSides, double* reduced, int count) override {
    factored().expand(rightHandSides, reduced, count);
  }
  std::vector<int> nullPivots() const override { return factored().nullPivots(); }
  Mumps::Statistics statistics() const override { return factored().statistics(); }
  std::vector<std::string> warnings() const override { return factored().warnings(); }

 private:
  Mumps& factored() const {
    if (!mumps_)
      throw InputError("the MUMPS solver has no factorisation; call numericFactorization() first");
    return *mumps_;
  }

  int preOrdering_impl() { return 0; }

  int symbolicFactorization_impl() {
    const auto mpi = Teuchos::rcp_dynamic_cast<const Teuchos::MpiComm<int>>(this->getComm());
    HARMOS_REQUIRE(!mpi.is_null(), "the MUMPS solver needs a matrix on an MPI communicator");
    MumpsOptions options = options_;
    if (!position_.empty())
      options.ordering = MumpsOptions::Ordering::Given;
    mumps_ = std::make_unique<Mumps>(*mpi->getRawMpiComm(), options);
    std::vector<int> rows, columns;
    if (this->root_)
      forEachEntry([&](int i, int j, double) {
        rows.push_back(i + 1);
        columns.push_back(j + 1);
      });
    mumps_->analyse(static_cast<int>(this->globalNumRows_), std::move(rows), std::move(columns), schurRows_,
                    position_);
    return 0;
  }

  int numericFactorization_impl() {
    std::vector<double> values;
    if (this->root_)
      forEachEntry([&](int, int, double value) { values.push_back(value); });
    if (mumps_->statistics().factorizations == 0) {
      mumps_->factorize(std::move(values));
    } else {
      std::vector<int> rows, columns;
      if (this->root_)
        forEachEntry([&](int i, int j, double) {
          rows.push_back(i + 1);
          columns.push_back(j + 1);
        });
      mumps_->refactorize(std::move(rows), std::move(columns), std::move(values));
    }
    this->setNnzLU(static_cast<std::size_t>(mumps_->statistics().factorEntries));
    values_ = {};
    columns_ = {};
    offsets_ = {};
    return 0;
  }

  int solve_impl(const Teuchos::Ptr<Amesos2::MultiVecAdapter<Vector>> X,
                 const Teuchos::Ptr<const Amesos2::MultiVecAdapter<Vector>> B) const {
    const auto n = static_cast<std::size_t>(this->globalNumRows_);
    const std::size_t count = X->getGlobalNumVectors();
    Teuchos::Array<double> data(static_cast<Teuchos::Array<double>::size_type>(this->root_ ? n * count : 0));
    Amesos2::Util::get_1d_copy_helper<Amesos2::MultiVecAdapter<Vector>, double>::do_get(
        B, data(), n, Amesos2::ROOTED, static_cast<GlobalOrdinal>(this->rowIndexBase_));
    mumps_->solve(data.getRawPtr(), static_cast<int>(count));
    Amesos2::Util::put_1d_data_helper<Amesos2::MultiVecAdapter<Vector>, double>::do_put(X, data(), n,
                                                                                        Amesos2::ROOTED);
    return 0;
  }

  bool matrixShapeOK_impl() const { return this->globalNumRows_ == this->globalNumCols_; }

  void setParameters_impl(const Teuchos::RCP<Teuchos::ParameterList>& list) {
    const Teuchos::ParameterList& valid = *getValidParameters_impl();
    list->validateParametersAndSetDefaults(valid);
    const auto choice = [&](const char* parameter) {
      return Teuchos::getIntegralValue<int>(*list, parameter);
    };
    options_.symmetry = static_cast<MumpsOptions::Symmetry>(choice("Symmetry"));
    options_.ordering = static_cast<MumpsOptions::Ordering>(choice("Ordering"));
    options_.precision = static_cast<MumpsOptions::Precision>(choice("Precision"));
    options_.nullPivotThreshold = list->get<double>("Null pivot threshold");
    options_.blockLowRank = list->get<double>("Block low rank tolerance");
    options_.memoryMiB = list->get<int>("Memory limit MiB");
  }

  Teuchos::RCP<const Teuchos::ParameterList> getValidParameters_impl() const {
    static const Teuchos::RCP<const Teuchos::ParameterList> valid = [] {
      const MumpsOptions defaults;
      const auto list = Teuchos::parameterList();
      Teuchos::setStringToIntegralParameter<int>(
          "Symmetry", "positive definite", "Kind of the factorisation.",
          Teuchos::tuple<std::string>("general", "positive definite", "symmetric"),
          Teuchos::tuple<int>(0, 1, 2), list.get());
      Teuchos::setStringToIntegralParameter<int>(
          "Ordering", "METIS", "Order of elimination.",
          Teuchos::tuple<std::string>("AMD", "AMF", "SCOTCH", "PORD", "METIS", "QAMD", "automatic"),
          Teuchos::tuple<int>(0, 2, 3, 4, 5, 6, 7), list.get());
      Teuchos::setStringToIntegralParameter<int>("Precision", "double", "Of the factors.",
                                                 Teuchos::tuple<std::string>("double", "single"),
                                                 Teuchos::tuple<int>(0, 1), list.get());
      list->set("Null pivot threshold", defaults.nullPivotThreshold,
                "Pivots below this part of the norm are null; 0 looks for none.");
      list->set("Block low rank tolerance", defaults.blockLowRank,
                "Relative accuracy of compressed factors; 0 for none.");
      list->set("Memory limit MiB", defaults.memoryMiB, "Working memory of each rank; 0 for no limit.");
      return Teuchos::rcp_const_cast<const Teuchos::ParameterList>(list);
    }();
    return valid;
  }

  // Brings the matrix to the root as compressed rows; the order of its entries is the same at every load.
  bool loadA_impl(Amesos2::EPhase phase) {
    if (phase == Amesos2::SOLVE)
      return false;
    const std::size_t entriesHere = this->root_ ? this->globalNumNonZeros_ : 0;
    const std::size_t rowsHere = this->root_ ? this->globalNumRows_ : 0;
    values_ = Values("values", entriesHere);
    columns_ = Columns("columns", entriesHere);
    offsets_ = Offsets("offsets", rowsHere + 1); // Amesos2 writes the end of the last row on every rank
    SizeType entries = 0;
    Amesos2::Util::get_crs_helper_kokkos_view<Amesos2::MatrixAdapter<Matrix>, Values, Columns,
                                              Offsets>::do_get(this->matrixA_.ptr(), values_, columns_,
                                                               offsets_, entries, Amesos2::ROOTED,
                                                               Amesos2::SORTED_INDICES,
                                                               static_cast<int>(this->rowIndexBase_));
    return true;
  }

  // Entries of the lower triangle, or all of a general matrix, zero-based.
  template<class Visit>
  void forEachEntry(Visit&& visit) const {
    for (std::size_t i = 0; i + 1 < offsets_.extent(0); ++i)
      for (auto k = offsets_(i); k < offsets_(i + 1); ++k) {
        const int j = static_cast<int>(columns_(k));
        if (options_.symmetry == MumpsOptions::Symmetry::General || j <= static_cast<int>(i))
          visit(static_cast<int>(i), j, values_(k));
      }
  }

  using Host = Kokkos::DefaultHostExecutionSpace;
  using Values = Kokkos::View<double*, Host>;
  using Columns = Kokkos::View<int*, Host>;
  using Offsets = Kokkos::View<SizeType*, Host>;

  MumpsOptions options_;
  std::vector<int> schurRows_, position_;
  std::unique_ptr<Mumps> mumps_;
  Values values_;
  Columns columns_;
  Offsets offsets_;
};

template<class Matrix, class Vector>
const char* MumpsSolver<Matrix, Vector>::name = "Harmos MUMPS";

} // namespace

Teuchos::RCP<DirectSolver> makeMumpsSolver(const Teuchos::RCP<const CrsMatrix>& matrix,
                                           const Teuchos::RCP<MultiVector>& x,
                                           const Teuchos::RCP<const MultiVector>& b) {
  return Teuchos::rcp(new MumpsSolver<CrsMatrix, MultiVector>(matrix, x, b));
}

} // namespace Harmos::feti
