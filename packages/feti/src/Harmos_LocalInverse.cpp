// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_LocalInverse.hpp"

#include "Harmos_Agreement.hpp"
#include "Harmos_FixingDofs.hpp"
#include "Harmos_Log.hpp"
#include "Harmos_MumpsSolver.hpp"

#include <Amesos2_Solver_decl.hpp>
#include <Teuchos_DefaultMpiComm.hpp>
#include <Tpetra_CrsMatrix.hpp>
#include <Tpetra_MultiVector.hpp>

#include <algorithm>
#include <cmath>

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

class ImplicitInverse : public LocalInverse {
 public:
  explicit ImplicitInverse(const LocalMatrix& regularizedMatrix) {
    // Teuchos::SerialComm makes Amesos2 crash; the rank's own MPI communicator does not.
    const auto self = Teuchos::rcp(new Teuchos::MpiComm<int>(MPI_COMM_SELF));
    const auto n = static_cast<std::size_t>(regularizedMatrix.rows());
    const auto map = Teuchos::rcp(new Map(n, 0, self, Tpetra::LocallyReplicated));
    b_ = Teuchos::rcp(new MultiVector(map, 1));
    x_ = Teuchos::rcp(new MultiVector(map, 1));
    solver_ = makeMumpsSolver(toTpetra(regularizedMatrix, map), x_, b_);
    solver_->symbolicFactorization();
    solver_->numericFactorization();
  }

  void apply(const double* b, double* x) const override {
    {
      auto view = b_->getLocalViewHost(Tpetra::Access::OverwriteAll);
      std::copy(b, b + view.extent(0), view.data());
    }
    solver_->solve();
    const auto view = x_->getLocalViewHost(Tpetra::Access::ReadOnly);
    std::copy(view.data(), view.data() + view.extent(0), x);
  }

 private:
  Teuchos::RCP<MultiVector> b_;
  Teuchos::RCP<MultiVector> x_;
  Teuchos::RCP<DirectSolver> solver_;
};

// ‖K K⁺ K x − K x‖ / ‖Kx‖ for a fixed x with entries in (−1, 1).
double inverseDefect(const LocalMatrix& matrix, const LocalInverse& inverse) {
  const auto n = static_cast<std::size_t>(matrix.rows());
  std::vector<double> x(n), image(n), y(n), again(n);
  for (std::size_t i = 0; i < n; ++i)
    x[i] = std::sin(1.0 + 1.7 * static_cast<double>(i) + 0.3 * static_cast<double>(i % 7));
  matrix.multiply(x.data(), image.data());
  inverse.apply(image.data(), y.data());
  matrix.multiply(y.data(), again.data());
  double difference = 0.0, norm = 0.0;
  for (std::size_t i = 0; i < n; ++i) {
    difference += (again[i] - image[i]) * (again[i] - image[i]);
    norm += image[i] * image[i];
  }
  return norm > 0.0 ? std::sqrt(difference / norm) : std::sqrt(difference);
}

// A motion that K does not resist and R does not contain, if there is one: ‖Kv‖/(‖K‖‖v‖) of v = (I − RRᵀ)K⁺b.
//
// K⁺ of a right-hand side in the range of K cannot show it: K wipes the spurious part out again. That of any
// other b is dominated by it, because K_ρ then has an eigenvalue at the level of rounding errors. Otherwise v
// is an ordinary vector, of which K leaves a part of the size of 1/κ(K_ρ) at least.
double hiddenMotion(const LocalMatrix& matrix, const Kernel& kernel, const LocalInverse& inverse) {
  const auto n = static_cast<std::size_t>(matrix.rows());
  std::vector<double> b(n), v(n), image(n);
  for (std::size_t i = 0; i < n; ++i)
    b[i] = std::cos(0.5 + 2.3 * static_cast<double>(i) + 0.1 * static_cast<double>(i % 5));
  removeKernel(kernel, b); // the known motions answer b with their own part, which is not looked for
  inverse.apply(b.data(), v.data());
  removeKernel(kernel, v);
  matrix.multiply(v.data(), image.data());
  double largest = 0.0, largestImage = 0.0;
  for (std::size_t i = 0; i < n; ++i) {
    largest = std::max(largest, std::abs(v[i]));
    largestImage = std::max(largestImage, std::abs(image[i]));
  }
  const double scale = matrix.infinityNorm() * largest;
  return scale > 0.0 ? largestImage / scale : 1.0;
}

// Rounding of a row of K, some thousand times ε, as for the kernel itself.
constexpr double hiddenTolerance = 1e-12;

// ‖KK⁺Kx − Kx‖/‖Kx‖ is about κ(K_ρ)ε at worst; beyond 1e-8 nothing can be trusted.
constexpr double inverseTolerance = 1e-8;

} // namespace

TornVector LocalInverses::apply(const TornVector& b) const {
  TornVector x(b.size());
  for (std::size_t i = 0; i < b.size(); ++i) {
    x[i].resize(b[i].size());
    inverses_[i]->apply(b[i].data(), x[i].data());
  }
  return x;
}

LocalInverses makeImplicitInverses(const SubdomainSystem& system, const ImplicitInverseOptions& options) {
  std::vector<std::unique_ptr<LocalInverse>> inverses;
  agree(*system.comm(), [&] {
    for (int i = 0; i < system.size(); ++i) {
      const LocalMatrix& matrix = system.matrix(i);
      const Kernel& kernel = system.kernel(i);
      const std::string number = std::to_string(system.subdomain(i).number);
      try {
        if (kernel.columns == 0)
          inverses.push_back(std::make_unique<ImplicitInverse>(matrix));
        else
          inverses.push_back(std::make_unique<ImplicitInverse>(regularized(
              matrix, kernel, fixingDofs(matrix, options.fixingDofsPerKernelColumn * kernel.columns))));
      } catch (const NumericalError& error) {
        throw NumericalError("subdomain " + number + ": " + error.what(), {{"subdomain", number}});
      }
      const double resistance = hiddenMotion(matrix, kernel, *inverses.back());
      if (!(resistance > hiddenTolerance))
        throw NumericalError("subdomain " + number +
                                 " has a motion that its matrix does not resist and its kernel "
                                 "of dimension " +
                                 std::to_string(kernel.columns) +
                                 " does not contain: ‖Kv‖/(‖K‖‖v‖) = " + scientific(resistance) +
                                 "; look for a mechanism, a hinge, or parts that are not connected",
                             {{"subdomain", number}, {"resistance", scientific(resistance)}});
      const double defect = inverseDefect(matrix, *inverses.back());
      if (!(defect <= inverseTolerance))
        throw NumericalError("subdomain " + number + ": ‖KK⁺Kx − Kx‖/‖Kx‖ = " + scientific(defect) +
                                 ", at most " + scientific(inverseTolerance, 0) +
                                 " was expected; its kernel of dimension " + std::to_string(kernel.columns) +
                                 " is too small (a mechanism, a hinge, parts that are not connected), or its "
                                 "material varies too much",
                             {{"subdomain", number}, {"defect", scientific(defect)}});
    }
  });
  return LocalInverses(std::move(inverses));
}

} // namespace Harmos::feti
