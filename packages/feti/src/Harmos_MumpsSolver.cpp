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
class MumpsSolver : public Amesos2::SolverCore<MumpsSolver, Matrix, Vector> {
  friend class Amesos2::SolverCore<MumpsSolver, Matrix, Vector>;

 public:
  static const char* name; // its parameter sublist's name, as Amesos2 wants it

  using Core = Amesos2::SolverCore<MumpsSolver, Matrix, Vector>;
  using SizeType = typename Core::global_size_type;

  MumpsSolver(Teuchos::RCP<const Matrix> matrix, Teuchos::RCP<Vector> x, Teuchos::RCP<const Vector> b)
      : Core(matrix, x, b) {}

 private:
  int preOrdering_impl() { return 0; }

  int symbolicFactorization_impl() {
    const auto mpi = Teuchos::rcp_dynamic_cast<const Teuchos::MpiComm<int>>(this->getComm());
    HARMOS_REQUIRE(!mpi.is_null(), "the MUMPS solver needs a matrix on an MPI communicator");
    mumps_ = std::make_unique<Mumps>(*mpi->getRawMpiComm(), symmetry_);
    std::vector<int> rows, columns;
    if (this->root_)
      forEachEntry([&](int i, int j, double) {
        rows.push_back(i + 1);
        columns.push_back(j + 1);
      });
    mumps_->analyse(static_cast<int>(this->globalNumRows_), std::move(rows), std::move(columns));
    return 0;
  }

  int numericFactorization_impl() {
    std::vector<double> values;
    if (this->root_)
      forEachEntry([&](int, int, double value) { values.push_back(value); });
    mumps_->factorize(std::move(values));
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
        B, data(), n, Amesos2::ROOTED, this->rowIndexBase_);
    mumps_->solve(data.getRawPtr(), static_cast<int>(count));
    Amesos2::Util::put_1d_data_helper<Amesos2::MultiVecAdapter<Vector>, double>::do_put(X, data(), n,
                                                                                        Amesos2::ROOTED);
    return 0;
  }

  bool matrixShapeOK_impl() const { return this->globalNumRows_ == this->globalNumCols_; }

  void setParameters_impl(const Teuchos::RCP<Teuchos::ParameterList>& list) {
    const std::string symmetry = list->get<std::string>("Symmetry", "positive definite");
    symmetry_ = symmetry == "general"     ? Mumps::Symmetry::General
                : symmetry == "symmetric" ? Mumps::Symmetry::Symmetric
                                          : Mumps::Symmetry::PositiveDefinite;
  }

  Teuchos::RCP<const Teuchos::ParameterList> getValidParameters_impl() const {
    static const Teuchos::RCP<const Teuchos::ParameterList> valid = [] {
      Teuchos::RCP<Teuchos::ParameterList> list = Teuchos::parameterList();
      const auto allowed = Teuchos::rcp(new Teuchos::StringValidator(
          Teuchos::tuple<std::string>("general", "positive definite", "symmetric")));
      list->set("Symmetry", "positive definite", "Kind of the factorisation.", allowed);
      return list;
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
        if (symmetry_ == Mumps::Symmetry::General || j <= static_cast<int>(i))
          visit(static_cast<int>(i), j, values_(k));
      }
  }

  using Host = Kokkos::DefaultHostExecutionSpace;
  using Values = Kokkos::View<double*, Host>;
  using Columns = Kokkos::View<int*, Host>;
  using Offsets = Kokkos::View<SizeType*, Host>;

  Mumps::Symmetry symmetry_ = Mumps::Symmetry::PositiveDefinite;
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
