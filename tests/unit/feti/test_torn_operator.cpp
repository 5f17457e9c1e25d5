// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_Errors.hpp"
#include "Harmos_Exchange.hpp"
#include "Harmos_SubdomainInput.hpp"
#include "Harmos_TestComm.hpp"
#include "Harmos_TornOperator.hpp"

#include <Tpetra_MultiVector.hpp>
#include <Tpetra_Vector.hpp>
#include <gtest/gtest.h>

#include <cmath>
#include <map>

namespace test_torn_operator {

using namespace Harmos;

namespace {

// A chain of springs in pieces, dofs numbered with gaps, held at its first end.
std::vector<feti::Subdomain> chain(int pieces, int cells) {
  const auto comm = testComm();
  std::vector<MatrixEntry> entries;
  for (int c = 0; c < cells; ++c)
    for (int i : {c, c + 1})
      for (int j : {c, c + 1})
        entries.push_back({i, j, i == j ? 1.0 : -1.0});
  const auto matrix = std::make_shared<const LocalMatrix>(makeLocalMatrix(cells + 1, entries));
  std::vector<feti::Subdomain> result;
  for (int p = comm->getRank(); p < pieces; p += comm->getSize()) {
    std::vector<long long> dofs;
    for (int i = 0; i <= cells; ++i)
      dofs.push_back(7LL * (p * cells + i));
    result.push_back(
        feti::makeSubdomain(p, matrix, std::vector<double>(static_cast<std::size_t>(cells + 1), 0.0), dofs,
                            feti::constantKernel(cells + 1),
                            p == 0 ? std::vector<feti::FixedDof>{{0, 0.0}} : std::vector<feti::FixedDof>()));
  }
  return result;
}

} // namespace

// Against the second difference, worked out by hand.
TEST(TornOperator, is_the_assembled_operator) {
  constexpr int pieces = 6, cells = 3, last = pieces * cells;
  const feti::TornOperator op(testComm(), chain(pieces, cells));
  const auto map = op.getDomainMap();
  ASSERT_EQ(map->getGlobalNumElements(), static_cast<std::size_t>(last + 1));
  const auto f = [](long long k) { return std::sin(0.3 * static_cast<double>(k)); };
  MultiVector x(map, 2), y(map, 2);
  const auto nodeOf = [&](std::size_t k) { return map->getGlobalElement(static_cast<LocalOrdinal>(k)) / 7; };
  {
    const auto view = x.getLocalViewHost(Tpetra::Access::OverwriteAll);
    for (std::size_t k = 0; k < view.extent(0); ++k) {
      view(k, 0) = f(nodeOf(k));
      view(k, 1) = 1.0;
    }
  }
  y.putScalar(1.0);
  op.apply(x, y, Teuchos::NO_TRANS, 2.0, 3.0);
  const auto view = y.getLocalViewHost(Tpetra::Access::ReadOnly);
  for (std::size_t k = 0; k < view.extent(0); ++k) {
    const long long node = nodeOf(k);
    const double exact = node == 0      ? f(0)
                         : node == last ? f(last) - f(last - 1)
                                        : 2.0 * f(node) - f(node - 1) - f(node + 1);
    EXPECT_NEAR(view(k, 0), 2.0 * exact + 3.0, 1e-14) << node;
    EXPECT_NEAR(view(k, 1), (node == 0 ? 2.0 : 0.0) + 3.0, 1e-14) << node;
  }
}

// Loads of the copies sum up to the right-hand side, values of fixed dofs are no loads; joined copies are the
// vector again.
TEST(TornOperator, tears_and_joins) {
  const feti::TornOperator op(testComm(), chain(5, 4));
  MultiVector b(op.getDomainMap(), 2);
  b.randomize();
  const feti::TornOperator::TornRhs rhs = op.torn(b, 1);
  MultiVector joined(op.getDomainMap(), 1);
  feti::TornVector values;
  double sum = 0.0, prescribed = 0.0;
  for (const auto& load : rhs.loads)
    for (double value : *load)
      sum += value;
  for (const auto& part : rhs.prescribed)
    for (double value : part)
      prescribed += value;
  const double all = globalSum(*testComm(), sum) + globalSum(*testComm(), prescribed);
  std::vector<double> ones(1);
  MultiVector one(op.getDomainMap(), 1);
  one.putScalar(1.0);
  const double exact = b.getVector(1)->dot(*one.getVector(0));
  EXPECT_NEAR(all, exact, 1e-13);

  for (const feti::Subdomain& subdomain : op.subdomains()) {
    values.emplace_back();
    for (long long number : subdomain.numbers)
      values.back().push_back(static_cast<double>(number));
  }
  op.join(values, joined, 0);
  const auto view = joined.getLocalViewHost(Tpetra::Access::ReadOnly);
  for (std::size_t k = 0; k < view.extent(0); ++k)
    EXPECT_EQ(view(k, 0),
              static_cast<double>(op.getDomainMap()->getGlobalElement(static_cast<LocalOrdinal>(k))));
}

TEST(TornOperator, refuses_subdomains_that_hide_their_interior) {
  std::vector<feti::Subdomain> subdomains = chain(4, 3);
  for (feti::Subdomain& subdomain : subdomains)
    if (subdomain.number == 2) {
      subdomain.interface = std::make_shared<const std::vector<int>>(std::vector<int>{0, 3});
      subdomain.numbers = {subdomain.numbers.front(), subdomain.numbers.back()};
    }
  EXPECT_THROW(feti::TornOperator(testComm(), subdomains), InputError);
}

} // namespace test_torn_operator
