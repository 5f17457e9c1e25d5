// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_Assembly.hpp"
#include "Harmos_Errors.hpp"
#include "Harmos_FixingDofs.hpp"
#include "Harmos_LocalInverse.hpp"
#include "Harmos_StructuredRectangle.hpp"
#include "Harmos_TestModel.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <set>

using namespace Harmos;
using namespace Harmos::feti;

namespace {

LocalMatrix chain(int n) {
  std::vector<MatrixEntry> entries;
  for (int i = 0; i + 1 < n; ++i)
    for (const auto& [a, b, v] :
         {std::tuple{i, i, 1.0}, {i + 1, i + 1, 1.0}, {i, i + 1, -1.0}, {i + 1, i, -1.0}})
      entries.push_back({a, b, v});
  return makeLocalMatrix(n, entries);
}

Dense toDense(const LocalMatrix& matrix) {
  const int n = matrix.rows();
  Dense result(n, n);
  for (int j = 0; j < n; ++j) {
    std::vector<double> unit(static_cast<std::size_t>(n), 0.0), column(static_cast<std::size_t>(n));
    unit[static_cast<std::size_t>(j)] = 1.0;
    matrix.multiply(unit.data(), column.data());
    for (int i = 0; i < n; ++i)
      result(i, j) = column[static_cast<std::size_t>(i)];
  }
  return result;
}

} // namespace

TEST(FixingDofs, are_spread_and_distinct) {
  const std::vector<int> two = fixingDofs(chain(11), 2);
  EXPECT_EQ(two, (std::vector<int>{0, 10}));
  EXPECT_EQ(fixingDofs(chain(11), 3), (std::vector<int>{0, 5, 10}));
  EXPECT_EQ(fixingDofs(chain(3), 8).size(), 3u);
  const std::vector<int> many = fixingDofs(chain(40), 10);
  EXPECT_EQ(std::set<int>(many.begin(), many.end()).size(), 10u);
}

// A disconnected part is infinitely far: it gets a fixing dof before any part gets its second one.
TEST(FixingDofs, reach_every_connected_part) {
  LocalMatrix two = makeLocalMatrix(6, {{0, 0, 1},
                                        {0, 1, -1},
                                        {1, 0, -1},
                                        {1, 1, 1},
                                        {2, 2, 1},
                                        {2, 3, -1},
                                        {3, 2, -1},
                                        {3, 3, 1},
                                        {4, 4, 1},
                                        {5, 5, 1}});
  const std::vector<int> fixing = fixingDofs(two, 4);
  EXPECT_TRUE(std::count(fixing.begin(), fixing.end(), 4) == 1 &&
              std::count(fixing.begin(), fixing.end(), 5) == 1);
}

// K_ρ is positive definite, and its smallest eigenvalue is not below that of K on the complement by more than
// the number of dofs.
TEST(FixingDofs, regularized_matrix_is_positive_definite) {
  const LocalMatrix k = chain(12);
  const Kernel kernel = heldKernel(constantKernel(12), {});
  for (int count : {1, 2, 4, 12}) {
    const std::vector<double> spectrum = eigenvalues(toDense(regularized(k, kernel, fixingDofs(k, count))));
    EXPECT_GT(spectrum.front(), 1e-3) << count;
    EXPECT_LT(spectrum.back(), 8.0) << count; // ‖K‖ ≤ 4, ρ = 2
  }
}

// K K⁺ K = K and K⁺ symmetric, entry by entry, for both forms.
TEST(LocalInverse, is_a_symmetric_generalised_inverse) {
  for (DirichletForm form : {DirichletForm::Primal, DirichletForm::Dual}) {
    const SubdomainSystem system(testComm(), testModel(2, 3).subdomains, form);
    const LocalInverses inverses = makeImplicitInverses(system);
    for (int i = 0; i < system.size(); ++i) {
      const int n = system.matrix(i).rows();
      const Dense k = toDense(system.matrix(i));
      Dense plus(n, n);
      for (int j = 0; j < n; ++j) {
        std::vector<double> unit(static_cast<std::size_t>(n), 0.0), column(static_cast<std::size_t>(n));
        unit[static_cast<std::size_t>(j)] = 1.0;
        inverses[i].apply(unit.data(), column.data());
        for (int r = 0; r < n; ++r)
          plus(r, j) = column[static_cast<std::size_t>(r)];
      }
      for (int r = 0; r < n; ++r)
        for (int c = 0; c < n; ++c) {
          EXPECT_NEAR(plus(r, c), plus(c, r), 1e-13);
          double product = 0.0;
          for (int a = 0; a < n; ++a)
            for (int b = 0; b < n; ++b)
              product += k(r, a) * plus(a, b) * k(b, c);
          EXPECT_NEAR(product, k(r, c), 1e-12);
        }
    }
  }
}

// Two parts that are not connected, with the kernel of one: the subdomain is named on all ranks.
TEST(LocalInverse, disconnected_subdomain_is_named) {
  std::vector<Subdomain> subdomains;
  if (testComm()->getRank() == 0) {
    Subdomain s;
    s.number = 0;
    std::vector<MatrixEntry> entries;
    for (int part : {0, 2})
      for (const auto& [a, b, v] : {std::tuple{0, 0, 1.0}, {1, 1, 1.0}, {0, 1, -1.0}, {1, 0, -1.0}})
        entries.push_back({part + a, part + b, v});
    s.stiffness = std::make_shared<LocalMatrix>(makeLocalMatrix(4, entries));
    s.motions = std::make_shared<Kernel>(constantKernel(4));
    s.load = {0, 0, 0, 0};
    s.dofs = {0, 1, 2, 3};
    subdomains.push_back(s);
  }
  const SubdomainSystem system(testComm(), subdomains, DirichletForm::Dual);
  try {
    makeImplicitInverses(system);
    FAIL() << "nothing was thrown";
  } catch (const NumericalError& error) {
    EXPECT_NE(std::string(error.what()).find("subdomain 0"), std::string::npos) << error.what();
    EXPECT_NE(std::string(error.what()).find("not connected"), std::string::npos) << error.what();
  }
}

// Two separate blocks of Q1 elements with the kernel of one body. Their singular K_ρ mostly factorises with a
// tiny positive pivot, and KK⁺Kx = Kx holds to rounding: only a probe outside of the range of K shows the
// second constant.
TEST(LocalInverse, disconnected_blocks_are_found_at_every_size) {
  for (int n : {3, 4, 5, 7, 9, 12}) {
    const LocalMatrix block = fem::assembleLaplace(
        *fem::StructuredRectangle({0, 0, 0}, {1, 1}, {1, 1}, {n, n}, 0).subdomain(0).mesh);
    const int size = block.rows();
    std::vector<Subdomain> subdomains;
    if (testComm()->getRank() == 0) {
      std::vector<MatrixEntry> entries;
      for (int part : {0, size})
        for (int i = 0; i < size; ++i)
          for (std::size_t k = block.offsets[static_cast<std::size_t>(i)];
               k < block.offsets[static_cast<std::size_t>(i) + 1]; ++k)
            entries.push_back({part + i, part + block.columns[k], block.values[k]});
      Subdomain s;
      s.stiffness = std::make_shared<LocalMatrix>(makeLocalMatrix(2 * size, entries));
      s.motions = std::make_shared<Kernel>(constantKernel(2 * size));
      s.load.assign(static_cast<std::size_t>(2 * size), 0.0);
      for (int i = 0; i < 2 * size; ++i)
        s.dofs.push_back(i);
      subdomains.push_back(s);
    }
    const SubdomainSystem system(testComm(), subdomains, DirichletForm::Dual);
    EXPECT_THROW(makeImplicitInverses(system), NumericalError) << n;
  }
}
