// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_TestModel.hpp"

#include "Harmos_ContactSetup.hpp"
#include "Harmos_Decomposition.hpp"
#include "Harmos_Membranes.hpp"

#include <Teuchos_LAPACK.hpp>
#include <Tpetra_Core.hpp>

#include <algorithm>
#include <cmath>

namespace Harmos {

Teuchos::RCP<const Teuchos::Comm<int>> testComm() {
  return Tpetra::getDefaultComm();
}

TestModel testModel(int s, int n, bool tied) {
  Teuchos::ParameterList list;
  list.set("Subdomains per side", s);
  list.set("Elements per subdomain side", n);
  list.set("Interface", std::string(tied ? "tie" : "contact"));
  const scene::Scene scene = signorini::membranes(list);
  const auto comm = testComm();
  const auto owned = scene::decompose(*comm, scene);
  TestModel model;
  model.subdomains = scene::assemble(scene, owned);
  model.rows = scene::setUpContact(*comm, scene, owned).rows;
  return model;
}

std::vector<double> eigenvalues(Dense matrix) {
  std::vector<double> result(static_cast<std::size_t>(matrix.rows)),
      work(static_cast<std::size_t>(std::max(1, 34 * matrix.rows)));
  int info = 0;
  Teuchos::LAPACK<int, double>().SYEV('N', 'L', matrix.rows, matrix.values.data(), matrix.rows, result.data(),
                                      work.data(), static_cast<int>(work.size()), &info);
  return result;
}

std::vector<double> solveDense(Dense a, std::vector<double> b) {
  const int n = a.rows;
  for (int k = 0; k < n; ++k) {
    int pivot = k;
    for (int i = k + 1; i < n; ++i)
      if (std::abs(a(i, k)) > std::abs(a(pivot, k)))
        pivot = i;
    if (std::abs(a(pivot, k)) < 1e-13)
      return {};
    for (int j = 0; j < n; ++j)
      std::swap(a(k, j), a(pivot, j));
    std::swap(b[static_cast<std::size_t>(k)], b[static_cast<std::size_t>(pivot)]);
    for (int i = k + 1; i < n; ++i) {
      const double factor = a(i, k) / a(k, k);
      for (int j = k; j < n; ++j)
        a(i, j) -= factor * a(k, j);
      b[static_cast<std::size_t>(i)] -= factor * b[static_cast<std::size_t>(k)];
    }
  }
  for (int k = n - 1; k >= 0; --k) {
    for (int j = k + 1; j < n; ++j)
      b[static_cast<std::size_t>(k)] -= a(k, j) * b[static_cast<std::size_t>(j)];
    b[static_cast<std::size_t>(k)] /= a(k, k);
  }
  return b;
}

} // namespace Harmos
