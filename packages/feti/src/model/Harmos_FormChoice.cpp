// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_FormChoice.hpp"

#include "Harmos_Agreement.hpp"
#include "Harmos_Exchange.hpp"

#include <Teuchos_DefaultMpiComm.hpp>

#include <algorithm>
#include <cmath>
#include <iomanip>
#include <sstream>
#include <unistd.h>

namespace Harmos::feti {
namespace {

constexpr double mebi = 1048576.0;
// Predictions are no better than that.
constexpr double nearTie = 1.1;

void countBlocks(const LocalMatrix& matrix, const std::vector<int>& boundary,
                 FactorizationEstimate& estimate) {
  std::vector<bool> isBoundary(static_cast<std::size_t>(matrix.rows()), false);
  for (int row : boundary)
    isBoundary[static_cast<std::size_t>(row)] = true;
  for (int row : boundary)
    for (std::size_t k = matrix.offsets[static_cast<std::size_t>(row)];
         k < matrix.offsets[static_cast<std::size_t>(row) + 1]; ++k)
      (isBoundary[static_cast<std::size_t>(matrix.columns[k])] ? estimate.blockEntries
                                                               : estimate.couplingEntries) += 1.0;
}

// All but the factor of K itself, of which is known that it has at least the entries of the lower triangle.
FactorizationEstimate lowerBound(const LocalMatrix& matrix, const std::vector<int>& boundary,
                                 FactorizationContext& context) {
  FactorizationEstimate estimate;
  estimate.rows = matrix.rows();
  estimate.boundary = static_cast<int>(boundary.size());
  countBlocks(matrix, boundary, estimate);
  estimate.entries = 0.5 * (static_cast<double>(matrix.entries()) + estimate.rows);
  estimate.flops = estimate.entries * estimate.entries / std::max(estimate.rows, 1);
  if (estimate.boundary == estimate.rows)
    return estimate; // nothing is to be eliminated
  bool isNew = false;
  const auto tree = context.tree(matrix, boundary, FrontTree::Rest::Stays, isNew);
  estimate.interiorEntries = static_cast<double>(tree->factorEntries);
  estimate.schurFlops = tree->flops;
  for (const FrontTree::Front& front : tree->fronts) {
    const double k = front.columns, r = front.inner;
    estimate.interiorFlops += k * k * k / 3.0 + k * k * r + k * r * r;
  }
  // Whatever the order, the rows inside fill in among themselves when the boundary is eliminated too.
  estimate.entries =
      std::max(estimate.entries, tree->entriesOf(tree->reachedFrom(couplingOf(matrix, boundary).columns)));
  estimate.flops = std::max(estimate.flops, estimate.interiorFlops);
  return estimate;
}

std::string describe(const DualForms& forms, const FormPrediction& p, int products) {
  std::ostringstream text;
  text << std::setprecision(2) << toString(forms.form) << " " << toString(forms.preconditioner) << " "
       << p.seconds(products) << " s and " << std::ceil(p.bytes / mebi) << " MiB";
  return text.str();
}

} // namespace

FormPrediction& FormPrediction::operator+=(const FormPrediction& other) {
  // Products that classes need differ; the largest counts for all.
  setupSeconds += other.setupSeconds;
  productSeconds += other.productSeconds;
  relativeProducts = std::max(relativeProducts, other.relativeProducts);
  bytes += other.bytes;
  factorBytes += other.factorBytes;
  return *this;
}

FactorizationEstimate FactorizationEstimate::scaledTo(int otherRows, int otherBoundary) const {
  FactorizationEstimate result = *this;
  const double factor = static_cast<double>(otherRows) / std::max(rows, 1);
  for (double* value : {&result.entries, &result.flops, &result.interiorEntries, &result.interiorFlops,
                        &result.schurFlops, &result.blockEntries, &result.couplingEntries})
    *value *= factor;
  result.rows = otherRows;
  result.boundary = otherBoundary;
  return result;
}

FactorizationEstimate analyseFactorization(const LocalMatrix& matrix, const std::vector<int>& boundary,
                                           FactorizationContext& context) {
  FactorizationEstimate estimate = lowerBound(matrix, boundary, context);
  bool isNew = false;
  const auto tree = context.tree(matrix, {}, FrontTree::Rest::Absent, isNew);
  estimate.entries = tree->entriesOf(tree->reachedFrom(boundary));
  estimate.flops = tree->flops;
  return estimate;
}

FormPrediction predict(const DualForms& forms, const FactorizationEstimate& estimate, int members,
                       Precision precision, const MachineRates& rates, bool isRounded) {
  const double b = estimate.boundary, m = members;
  const bool isSingle = precision == Precision::Single;
  const double word = isSingle ? 4.0 : 8.0;
  const double interior = estimate.rows - b;
  const auto setup = [&](double rows, double entries) {
    return rows / rates.setupRows + entries / rates.setupEntries;
  };
  FormPrediction p;
  if (forms.form == DualForm::Implicit) {
    const double solves = isSingle ? 2.0 : 1.0; // one for the refinement
    const double ofFactor = isRounded ? 4.0 : word;
    p.setupSeconds = estimate.flops / rates.sparseFlops + setup(estimate.rows, estimate.entries);
    p.productSeconds = m * solves * 2.0 * ofFactor * estimate.entries / rates.solveBytes;
    p.factorBytes = ofFactor * estimate.entries;
    if (forms.preconditioner == PreconditionerKind::Dirichlet) {
      p.setupSeconds +=
          estimate.interiorFlops / rates.sparseFlops + setup(interior, estimate.interiorEntries);
      p.productSeconds +=
          m * (16.0 * estimate.interiorEntries / rates.solveBytes +
               12.0 * (estimate.blockEntries + 2.0 * estimate.couplingEntries) / rates.sparseBytes);
      p.factorBytes +=
          8.0 * estimate.interiorEntries + 12.0 * (estimate.blockEntries + estimate.couplingEntries);
    }
    p.bytes = p.factorBytes;
  } else {
    const bool packed = members < 3;
    const double block = word * b * b * (packed ? 0.5 : 1.0);
    const double product =
        packed ? m * block / rates.streamBytes : m * 2.0 * b * b / rates.denseFlops * word / 8.0;
    const double blocks = forms.preconditioner == PreconditionerKind::Dirichlet ? 2.0 : 1.0;
    p.setupSeconds = estimate.schurFlops / rates.schurFlops + setup(interior, estimate.interiorEntries) +
                     b * b * b / rates.denseFlops;
    p.productSeconds = blocks * product;
    p.factorBytes = 8.0 * estimate.interiorEntries + 12.0 * estimate.couplingEntries;
    p.bytes = p.factorBytes + blocks * block;
  }
  if (forms.preconditioner == PreconditionerKind::Lumped) {
    p.productSeconds += m * 12.0 * estimate.blockEntries / rates.sparseBytes;
    const double thickness = std::log2(estimate.rows / std::max(b, 1.0));
    p.relativeProducts = std::clamp(1.0 + 0.35 * thickness, 1.0, 2.75);
    p.factorBytes += 12.0 * estimate.blockEntries;
    p.bytes += 12.0 * estimate.blockEntries;
  }
  return p;
}

bool FormLimits::allows(const DualForms& forms) const {
  if (form && *form != forms.form)
    return false;
  if (preconditioner)
    return *preconditioner == forms.preconditioner;
  return forms.preconditioner == PreconditionerKind::Dirichlet ||
         (forms.preconditioner == PreconditionerKind::Lumped && mayLump);
}

const std::vector<DualForms>& dualForms() {
  static const std::vector<DualForms> result = {
      {DualForm::Condensed, PreconditionerKind::Dirichlet}, {DualForm::Implicit, PreconditionerKind::Lumped},
      {DualForm::Implicit, PreconditionerKind::Dirichlet},  {DualForm::Condensed, PreconditionerKind::Lumped},
      {DualForm::Condensed, PreconditionerKind::None},      {DualForm::Implicit, PreconditionerKind::None}};
  return result;
}

std::optional<std::size_t> bestOf(const std::vector<FormPrediction>& predictions, const FormLimits& limits) {
  std::vector<std::size_t> allowed;
  for (std::size_t k = 0; k < predictions.size(); ++k)
    if (limits.allows(dualForms()[k]) &&
        (limits.budgetMiB == 0.0 || predictions[k].bytes <= limits.budgetMiB * mebi))
      allowed.push_back(k);
  if (allowed.empty())
    return std::nullopt;
  const auto leanest = *std::min_element(allowed.begin(), allowed.end(), [&](std::size_t a, std::size_t b) {
    return predictions[a].bytes < predictions[b].bytes;
  });
  if (limits.memoryMiB > 0.0) {
    const auto tooLarge = [&](std::size_t k) {
      return k != leanest && predictions[k].bytes > limits.memoryMiB * mebi;
    };
    allowed.erase(std::remove_if(allowed.begin(), allowed.end(), tooLarge), allowed.end());
  }
  if (limits.before)
    for (std::size_t k : allowed)
      if (toString(dualForms()[k]) == toString(*limits.before))
        return k;
  double fastest = std::numeric_limits<double>::infinity();
  for (std::size_t k : allowed)
    fastest = std::min(fastest, predictions[k].seconds(limits.products));
  return *std::find_if(allowed.begin(), allowed.end(), [&](std::size_t k) {
    return predictions[k].seconds(limits.products) <= nearTie * fastest;
  });
}

const FormPrediction& FormChoice::of(const DualForms& wanted) const {
  for (std::size_t k = 0; k < predictions.size(); ++k)
    if (dualForms()[k].form == wanted.form && dualForms()[k].preconditioner == wanted.preconditioner)
      return predictions[k];
  throw InternalError("there is no such form of the dual operator");
}

FormChoice chooseForm(const SubdomainSystem& system, const Constraints& constraints,
                      const LocalInverseOptions& options, const FormLimits& limits,
                      FactorizationContext& context, const MachineRates& rates) {
  const Teuchos::Comm<int>& comm = *system.comm();
  const std::size_t count = dualForms().size();
  std::vector<FormPrediction> found(count);
  long long wasAnalysed = 0;
  agree(comm, [&] {
    const std::vector<CongruenceClass> classes =
        congruenceClasses(system, constraints, options.share, options.fixingPlaces);
    if (classes.empty())
      return;
    const auto rowsOf = [&](const CongruenceClass& item) {
      return system.matrix(item.members.front()).rows();
    };
    const CongruenceClass& largest = *std::max_element(
        classes.begin(), classes.end(),
        [&](const CongruenceClass& a, const CongruenceClass& b) { return rowsOf(a) < rowsOf(b); });
    const LocalMatrix& matrix = system.matrix(largest.members.front());
    const auto predictWith = [&](const FactorizationEstimate& estimate) {
      found.assign(count, FormPrediction());
      for (const CongruenceClass& item : classes)
        for (std::size_t k = 0; k < count; ++k)
          found[k] +=
              predict(dualForms()[k], estimate.scaledTo(rowsOf(item), static_cast<int>(item.boundary.size())),
                      static_cast<int>(item.members.size()), options.precision, rates,
                      options.expectsRoundedProducts());
    };
    predictWith(lowerBound(matrix, largest.boundary, context));
    const auto best = bestOf(found, limits);
    const bool isClear = limits.budgetMiB == 0.0 && best && dualForms()[*best].form == DualForm::Condensed;
    if (!isClear)
      predictWith(analyseFactorization(matrix, largest.boundary, context));
    wasAnalysed = isClear ? 0 : 1;
  });
  FormChoice choice;
  // Ranks that looked closer decide for all: their numbers are larger.
  const bool closer = globalMax(comm, wasAnalysed) > 0;
  for (FormPrediction& p : found)
    for (double* value : {&p.setupSeconds, &p.productSeconds, &p.relativeProducts, &p.bytes, &p.factorBytes})
      *value = globalMax(comm, *value);
  choice.predictions = std::move(found);
  std::string all;
  for (std::size_t k = 0; k < count; ++k)
    if (limits.allows(dualForms()[k]))
      all += (all.empty() ? "" : ", ") + describe(dualForms()[k], choice.predictions[k], limits.products);
  const std::optional<std::size_t> best = bestOf(choice.predictions, limits);
  if (!best)
    throw InputError("the memory budget of " + std::to_string(static_cast<long long>(limits.budgetMiB)) +
                         " MiB per rank is too small; predicted need: " + all +
                         " per rank. Raise the budget, or use more ranks, smaller subdomains, single "
                         "precision or shared factorisations of identical subdomains",
                     {{"path", "Dual operator/Memory budget MiB"}});
  choice.forms = dualForms()[*best];
  choice.reason = "Dual operator: " + toString(choice.forms) +
                  (limits.before && toString(*limits.before) == toString(choice.forms) ? " as before" : "") +
                  "; cost model for " + std::to_string(limits.products) +
                  " applications of F: " + (closer ? "" : "at least ") + all + " per rank";
  return choice;
}

double machineMemoryMiB(const Teuchos::Comm<int>& comm) {
  const auto* mpi = dynamic_cast<const Teuchos::MpiComm<int>*>(&comm);
  int ranks = 1;
  if (mpi != nullptr) {
    MPI_Comm node = MPI_COMM_NULL;
    MPI_Comm_split_type(*mpi->getRawMpiComm(), MPI_COMM_TYPE_SHARED, 0, MPI_INFO_NULL, &node);
    MPI_Comm_size(node, &ranks);
    MPI_Comm_free(&node);
  }
  const double bytes =
      static_cast<double>(sysconf(_SC_PHYS_PAGES)) * static_cast<double>(sysconf(_SC_PAGESIZE));
  // The least of all nodes.
  return -globalMax(comm, -bytes / mebi / ranks);
}

const char* toString(DualForm form) {
  return form == DualForm::Implicit ? "implicit" : "condensed";
}

const char* toString(PreconditionerKind kind) {
  return kind == PreconditionerKind::None     ? "no preconditioner"
         : kind == PreconditionerKind::Lumped ? "lumped"
                                              : "Dirichlet";
}

std::string toString(const DualForms& forms) {
  return std::string(toString(forms.form)) + " " + toString(forms.preconditioner);
}

std::optional<DualForms> dualFormsFrom(const std::string& text) {
  for (const DualForms& forms : dualForms())
    if (toString(forms) == text)
      return forms;
  return std::nullopt;
}

} // namespace Harmos::feti
