// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_MprgpIteration.hpp"

namespace Harmos::qp {

ParameterSpec MprgpOptions::parameterSpec() {
  const MprgpOptions defaults;
  ParameterSpec spec("MPRGP", "Modified proportioning with reduced gradient projections: the solver of "
                              "bound-constrained problems.");
  spec.real("Gamma", defaults.gamma, Range::above(0.0),
            "Γ of the proportioning test ‖β‖² ≤ Γ² φ̃ᵀφ. Larger values keep the iteration longer on a face.");
  spec.choice("Expansion", "projected conjugate gradient",
              {{"projected conjugate gradient",
                "projection of the conjugate gradient step; falls back to the fixed step if the cost rises"},
               {"fixed step", "step to the boundary, then a projected gradient step of length ᾱ"}},
              "Step off a face if the conjugate gradient step is not feasible.");
  spec.real("Step factor", defaults.stepFactor, Range{0.0, 2.0, true, false},
            "ᾱ‖H‖: length of the fixed step relative to 1/‖H‖. The theory covers values up to 2.");
  spec.integer("Norm applications", defaults.normApplications, 1, 1000,
               "Largest number of applications of the Hessian for the estimate of its norm.");
  spec.real("Norm safety", defaults.normSafety, Range::atLeast(1.0),
            "Factor of the estimated norm. Steps that are too long are also detected and corrected during "
            "the solve.");
  return spec;
}

MprgpOptions MprgpOptions::fromList(const Teuchos::ParameterList& list) {
  MprgpOptions options;
  options.gamma = list.get<double>("Gamma");
  options.stepFactor = list.get<double>("Step factor");
  options.expansion = list.get<std::string>("Expansion") == "fixed step"
                          ? Expansion::FixedStep
                          : Expansion::ProjectedConjugateGradient;
  options.normApplications = list.get<int>("Norm applications");
  options.normSafety = list.get<double>("Norm safety");
  return options;
}

} // namespace Harmos::qp
