// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_FormChoice.hpp"

#include "Harmos_Agreement.hpp"
#include "Harmos_Exchange.hpp"
#include "Harmos_FrontTree.hpp"

#include <algorithm>
#include <cmath>
#include <iomanip>
#include <sstream>

namespace Harmos::feti {
namespace {

// What is known without an analysis: L has at least the entries of the lower triangle of K.
FactorizationEstimate lowerBound(const LocalMatrix& matrix, const std::vector<int>& boundary) {
  FactorizationEstimate estimate;
  estimate.rows = matrix.rows();
  estimate.boundary = static_cast<int>(boundary.size());
  estimate.entries = 0.5 * (static_cast<double>(matrix.entries()) + estimate.rows);
  return estimate;
}

FormPrediction sumOverClasses(DualForm form, const SubdomainSystem& system,
                              const std::vector<CongruenceClass>& classes, std::size_t analysed,
                              const FactorizationEstimate& estimate, const LocalInverseOptions& options) {
  FormPrediction sum;
  for (const CongruenceClass& item : classes) {
    // Factors grow somewhat more than in proportion; classes of a rank are mostly of one size.
    FactorizationEstimate scaled = estimate;
    scaled.rows = system.matrix(item.members.front()).rows();
    scaled.boundary = static_cast<int>(item.boundary.size());
    const double factor =
        static_cast<double>(scaled.rows) / system.matrix(classes[analysed].members.front()).rows();
    scaled.entries *= factor;
    scaled.flops *= factor;
    const FormPrediction one = predict(form, scaled, static_cast<int>(item.members.size()), options);
    sum.setupSeconds += one.setupSeconds;
    sum.productSeconds += one.productSeconds;
    sum.bytes += one.bytes;
  }
  return sum;
}

std::string describe(const char* name, const FormPrediction& p, int products) {
  std::ostringstream text;
  text << std::setprecision(2) << name << " " << p.seconds(products) << " s and "
       << std::ceil(p.bytes / 1048576.0) << " MiB a rank";
  return text.str();
}

} // namespace

const char* toString(DualForm form) {
  return form == DualForm::Implicit ? "implicit" : "condensed";
}

FactorizationEstimate analyseFactorization(const LocalMatrix& matrix, const std::vector<int>& boundary) {
  if (static_cast<int>(boundary.size()) == matrix.rows())
    return lowerBound(matrix, boundary); // nothing is to be eliminated
  const FrontTree tree(matrix, boundary);
  FactorizationEstimate estimate;
  estimate.rows = matrix.rows();
  estimate.boundary = static_cast<int>(boundary.size());
  estimate.entries = static_cast<double>(tree.factorEntries);
  estimate.flops = tree.flops;
  return estimate;
}

FormPrediction predict(DualForm form, const FactorizationEstimate& estimate, int members,
                       const LocalInverseOptions& options, const MachineRates& rates) {
  const double e = estimate.entries, b = estimate.boundary, m = members;
  constexpr double atOnce = 32.0;
  constexpr double overhead = 1.5; // MUMPS' integers and what it cannot give back
  FormPrediction p;
  p.setupSeconds = estimate.flops / rates.sparseFlops + e / rates.setupEntries;
  p.bytes = overhead * 8.0 * e;
  if (form == DualForm::Implicit) {
    const double word = options.precision == Precision::Single ? 0.5 : 1.0;
    const double solves = options.precision == Precision::Single ? 2.0 : 1.0; // one for the refinement
    p.bytes *= word;
    p.productSeconds = solves * (std::ceil(m / atOnce) * 16.0 * word * e / rates.solveBytes +
                                 m * 4.0 * e / rates.solveFlops);
    p.setupSeconds += e / rates.orderingEntries;
    if (options.keepSchur) {
      p.setupSeconds *= 2.0;
      p.productSeconds *= 2.0;
      p.bytes *= 2.0;
    }
    return p;
  }
  const double word = options.precision == Precision::Single ? 4.0 : 8.0;
  const bool packed = members < 3;
  const double block = word * b * b * (packed ? 0.5 : 1.0);
  const double product =
      packed ? m * block / rates.streamBytes : m * 2.0 * b * b / rates.denseFlops * word / 8.0;
  const double blocks = options.keepSchur ? 2.0 : 1.0;
  p.setupSeconds += b * b * b / rates.denseFlops;
  p.productSeconds = blocks * product;
  p.bytes += blocks * block + 8.0 * b * b; // MUMPS keeps a copy of S
  return p;
}

FormChoice chooseForm(const SubdomainSystem& system, const Constraints& constraints,
                      const LocalInverseOptions& options, const DualForm* wanted, int expectedProducts,
                      double budgetMiB) {
  const Teuchos::Comm<int>& comm = *system.comm();
  FormChoice choice;
  long long wasAnalysed = 0;
  agree(comm, [&] {
    const std::vector<CongruenceClass> classes =
        congruenceClasses(system, constraints, options.share, options.fixingPlaces);
    if (classes.empty())
      return;
    std::size_t largest = 0;
    for (std::size_t c = 0; c < classes.size(); ++c)
      if (system.matrix(classes[c].members.front()).rows() >
          system.matrix(classes[largest].members.front()).rows())
        largest = c;
    const LocalMatrix& matrix = system.matrix(classes[largest].members.front());
    const auto predictWith = [&](const FactorizationEstimate& estimate) {
      choice.implicit = sumOverClasses(DualForm::Implicit, system, classes, largest, estimate, options);
      choice.condensed = sumOverClasses(DualForm::Condensed, system, classes, largest, estimate, options);
    };
    predictWith(lowerBound(matrix, classes[largest].boundary));
    const bool isClear = budgetMiB == 0.0 && choice.condensed.seconds(expectedProducts) <
                                                 choice.implicit.seconds(expectedProducts);
    if (!isClear)
      predictWith(analyseFactorization(matrix, classes[largest].boundary));
    wasAnalysed = isClear ? 0 : 1;
  });
  // Ranks that looked closer decide for all: their numbers are larger.
  const bool closer = globalMax(comm, wasAnalysed) > 0;
  for (FormPrediction* p : {&choice.implicit, &choice.condensed})
    for (double* value : {&p->setupSeconds, &p->productSeconds, &p->bytes})
      *value = globalMax(comm, *value);

  const auto fits = [&](const FormPrediction& p) {
    return budgetMiB == 0.0 || p.bytes <= budgetMiB * 1048576.0;
  };
  const bool implicitAllowed = (wanted == nullptr || *wanted == DualForm::Implicit) && fits(choice.implicit);
  const bool condensedAllowed =
      (wanted == nullptr || *wanted == DualForm::Condensed) && fits(choice.condensed);
  const std::string both = describe("implicit", choice.implicit, expectedProducts) + ", " +
                           describe("condensed", choice.condensed, expectedProducts);
  if (!implicitAllowed && !condensedAllowed)
    throw InputError(
        "the memory budget of " + std::to_string(static_cast<long long>(budgetMiB)) +
            " MiB a rank does not suffice; expected: " + both +
            ". Raise it, use more ranks, smaller subdomains, single precision, or share identical "
            "subdomains",
        {{"path", "Dual operator/Memory budget MiB"}});
  const bool faster = choice.condensed.seconds(expectedProducts) <= choice.implicit.seconds(expectedProducts);
  choice.form = condensedAllowed && (faster || !implicitAllowed) ? DualForm::Condensed : DualForm::Implicit;
  choice.reason = std::string("Dual operator: ") + toString(choice.form) + ", expected for " +
                  std::to_string(expectedProducts) + " products: " + (closer ? "" : "at least ") + both;
  return choice;
}

} // namespace Harmos::feti
