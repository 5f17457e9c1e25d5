// SPDX-License-Identifier: BSD-3-Clause
/// (c) FETI as a linear solver of Stratimikos, chosen by a parameter list.
#include "halves.hpp"
#include "torn_membrane.hpp"

#include <Harmos_Thyra.hpp>
#include <Teuchos_XMLParameterListHelpers.hpp>
#include <Thyra_LinearOpWithSolveFactoryHelpers.hpp>
#include <Thyra_TpetraThyraWrappers.hpp>
#include <Tpetra_MultiVector.hpp>

#include <cmath>
#include <sstream>

int main(int argc, char** argv) {
  using namespace Harmos;
  return runOnHalves(argc, argv, [](const Teuchos::RCP<const Teuchos::Comm<int>>& comm, int half) {
    Stratimikos::DefaultLinearSolverBuilder builder;
    enableHarmos(builder);
    builder.setParameterList(Teuchos::getParametersFromXmlString(R"(
      <ParameterList>
        <Parameter name="Linear Solver Type" type="string" value="Harmos FETI"/>
        <Parameter name="Preconditioner Type" type="string" value="None"/>
        <ParameterList name="Linear Solver Types">
          <ParameterList name="Harmos FETI">
            <ParameterList name="Dual operator">
              <Parameter name="Preconditioner" type="string" value="lumped"/>
            </ParameterList>
          </ParameterList>
        </ParameterList>
      </ParameterList>)"));
    const auto factory = Thyra::createLinearSolveStrategy(builder);

    const TornMembrane membrane;
    const auto torn = Teuchos::rcp(new feti::TornOperator(comm, membrane.subdomains(*comm, 1.0 + half, 0.0)));
    const Teuchos::RCP<const Thyra::LinearOpBase<double>> a =
        Thyra::createConstLinearOp<Scalar, LocalOrdinal, GlobalOrdinal, Node>(torn);
    const auto solver = Thyra::linearOpWithSolve(*factory, a);

    const auto b = Teuchos::rcp(new MultiVector(torn->getRangeMap(), 1));
    const auto x = Teuchos::rcp(new MultiVector(torn->getDomainMap(), 1));
    b->putScalar(0.0);
    for (int j = 0; j <= membrane.s * membrane.n; ++j) // forces at the right side: u = x/k
      if (torn->getRangeMap()->isNodeGlobalElement(membrane.dof(membrane.s * membrane.n, j)))
        b->replaceGlobalValue(membrane.dof(membrane.s * membrane.n, j), 0,
                              membrane.size() * (j == 0 || j == membrane.s * membrane.n ? 0.5 : 1.0));
    const Thyra::SolveCriteria<double> criteria(
        Thyra::SolveMeasureType(Thyra::SOLVE_MEASURE_NORM_RESIDUAL, Thyra::SOLVE_MEASURE_NORM_RHS), 1e-8);
    const auto status = Thyra::solve(
        *solver, Thyra::NOTRANS,
        *Thyra::createConstMultiVector<Scalar, LocalOrdinal, GlobalOrdinal, Node>(b, a->range()),
        Thyra::createMultiVector<Scalar, LocalOrdinal, GlobalOrdinal, Node>(x, a->domain()).ptr(),
        Teuchos::constPtr(criteria));

    std::vector<double> largest(1);
    x->normInf(Teuchos::arrayViewFromVector(largest));
    std::ostringstream text;
    text << "half " << half << ": " << Thyra::toString(status.solveStatus)
         << ", residual below 1e-8: " << (status.achievedTol <= 1e-8 ? "yes" : "no")
         << ", u = " << std::round(1e6 * largest[0]) / 1e6 << " at the right side";
    return text.str();
  });
}
