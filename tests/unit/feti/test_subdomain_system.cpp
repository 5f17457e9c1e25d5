// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_Errors.hpp"
#include "Harmos_TestModel.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace test_subdomain_system {

using namespace Harmos;
using feti::DirichletForm;
using feti::SubdomainSystem;

namespace {

// Changes the lowest-numbered subdomain and expects the error on all ranks.
template<class ErrorType, class Change>
std::string failure(Change&& change) {
  TestModel model = testModel(2, 2);
  for (feti::Subdomain& subdomain : model.subdomains)
    if (subdomain.number == 0)
      change(subdomain);
  try {
    const SubdomainSystem system(testComm(), model.subdomains, DirichletForm::Primal);
  } catch (const ErrorType& error) {
    return error.what();
  }
  return "";
}

bool contains(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

} // namespace

TEST(SubdomainSystem, dimensions_and_kernels_of_both_forms) {
  const SubdomainSystem primal(testComm(), testModel(3, 2).subdomains, DirichletForm::Primal);
  EXPECT_EQ(primal.globalSubdomains(), 18);
  EXPECT_EQ(primal.primalDimension(), 18 * 9);
  EXPECT_EQ(primal.kernelDimension(), 15); // three subdomains are held
  const SubdomainSystem dual(testComm(), testModel(3, 2).subdomains, DirichletForm::Dual);
  EXPECT_EQ(dual.kernelDimension(), 18);
  for (int i = 0; i < dual.size(); ++i) {
    EXPECT_EQ(dual.kernelOffset(i), dual.subdomain(i).number);
    EXPECT_NEAR(dual.kernel(i).column(0)[0], dual.kernel(i).values.back(), 1e-15);
    EXPECT_NEAR(std::abs(dual.kernel(i).column(0)[0]), 1.0 / 3.0, 1e-15); // nine dofs, length one
  }
}

// k u = k g with the mean diagonal k; other rows of fixed columns move to the right-hand side.
TEST(SubdomainSystem, trivial_equations) {
  TestModel model = testModel(1, 2);
  for (feti::Subdomain& subdomain : model.subdomains)
    for (feti::FixedDof& fixed : subdomain.fixed)
      fixed.value = 2.5;
  const SubdomainSystem system(testComm(), model.subdomains, DirichletForm::Primal);
  for (int i = 0; i < system.size(); ++i) {
    if (system.subdomain(i).number != 0)
      continue;
    const LocalMatrix& k = system.matrix(i);
    double mean = 0.0;
    for (double entry : system.subdomain(i).stiffness->diagonal())
      mean += entry / 9.0;
    for (int dof : {0, 3, 6}) { // the side x = 0
      EXPECT_NEAR(k.diagonal()[static_cast<std::size_t>(dof)], mean, 1e-14);
      EXPECT_NEAR(system.rhs(i)[static_cast<std::size_t>(dof)], mean * 2.5, 1e-14);
    }
    // The constant 2.5 satisfies the homogeneous equations: K·2.5 = rhs where there is no load.
    std::vector<double> u(9, 2.5), image(9);
    k.multiply(u.data(), image.data());
    for (std::size_t dof : {0u, 1u, 3u, 6u})
      if ((*system.subdomain(i).load)[dof] == 0.0)
        EXPECT_NEAR(image[dof], system.rhs(i)[dof], 1e-14);
    // Symmetry survives.
    for (int row = 0; row < 9; ++row) {
      std::vector<double> unit(9, 0.0), column(9);
      unit[static_cast<std::size_t>(row)] = 1.0;
      k.multiply(unit.data(), column.data());
      for (int other : {0, 3, 6})
        if (other != row)
          EXPECT_EQ(column[static_cast<std::size_t>(other)], 0.0);
    }
  }
}

TEST(SubdomainSystem, a_kernel_that_is_none_is_named_on_all_ranks) {
  const std::string text = failure<NumericalError>([](feti::Subdomain& s) {
    auto wrong = std::make_shared<feti::Kernel>(*s.motions);
    wrong->values[4] = 0.5;
    s.motions = wrong;
  });
  EXPECT_TRUE(contains(text, "the kernel given for subdomain 0 is not a kernel")) << text;
}

TEST(SubdomainSystem, bad_numbers_are_refused_before_they_spread) {
  EXPECT_TRUE(contains(failure<InputError>([](feti::Subdomain& s) {
                         changeLoad(s, [](std::vector<double>& load) { load[3] = std::nan(""); });
                       }),
                       "the load of subdomain 0 is not finite (entry 3)"));
  EXPECT_TRUE(contains(failure<InputError>([](feti::Subdomain& s) {
                         auto k = std::make_shared<LocalMatrix>(*s.stiffness);
                         k->values[0] = INFINITY;
                         s.stiffness = k;
                       }),
                       "the stiffness matrix of subdomain 0 is not finite"));
  EXPECT_TRUE(contains(failure<InputError>([](feti::Subdomain& s) {
                         auto k = std::make_shared<LocalMatrix>(*s.stiffness);
                         for (std::size_t e = k->offsets[2]; e < k->offsets[3]; ++e)
                           k->values[e] = 0.0;
                         s.stiffness = k;
                       }),
                       "row 2 of the stiffness matrix of subdomain 0 is zero"));
  EXPECT_TRUE(contains(failure<InputError>([](feti::Subdomain& s) {
                         changeLoad(s, [](std::vector<double>& load) { load.pop_back(); });
                       }),
                       "differ in length"));
  EXPECT_TRUE(contains(failure<InputError>([](feti::Subdomain& s) {
                         s.fixed.push_back({99, 0.0});
                       }),
                       "dof 99"));
  EXPECT_TRUE(contains(failure<InputError>([](feti::Subdomain& s) {
                         auto k = std::make_shared<LocalMatrix>(*s.stiffness);
                         for (double& value : k->values)
                           value = -value;
                         s.stiffness = k;
                       }),
                       "not positive semidefinite"));
  EXPECT_TRUE(contains(failure<InputError>([](feti::Subdomain& s) { s.number = 100; }), "without gaps"));
}

} // namespace test_subdomain_system
