// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_DualOptions.hpp"

#include "Harmos_Errors.hpp"
#include "Harmos_NearestName.hpp"

#include <algorithm>
#include <cmath>

namespace Harmos::feti {

namespace {

void addExpertTo(ParameterSpec& expert) {
  const DualOptions defaults;
  expert.boolean("Share identical subdomains", defaults.inverses.share,
                 "Subdomains with equal matrices share one factorisation. F is applied to all of them at "
                 "once.");
  expert.choice(
      "Scaling", "auto",
      {{"auto", "stiffness if the scene has more than one material, else multiplicity"},
       {"multiplicity", "all copies of a dof take an equal share of a jump; if rows have weights, a "
                        "share in proportion to these"},
       {"stiffness", "the softer copy takes a larger share: for materials that differ across "
                     "interfaces"}},
      "Scaling of the preconditioner.");
  expert.choice("Weights", "auto",
                {{"auto", "stiffness if the stiffness of materials differs by a factor above 30, else none"},
                 {"none", "the coarse projector is orthogonal"},
                 {"stiffness", "the stiffness at the dofs of a constraint weights the constraint, the coarse "
                               "projector and the norms of residuals: the number of applications of F does "
                               "not depend on the contrast between the materials of subdomains"}},
                "Inner product of the multipliers.");
  expert.choice("Adaptive coarse vectors", "auto",
                {{"auto", "of all subdomains, if the convergence of the solver is slow"},
                 {"none", "the coarse space has the rigid-body modes alone"},
                 {"all", "of all subdomains, from the first iteration on"}},
                "Coarse vectors for modes with little energy in a subdomain and much energy in its "
                "neighbours. They help if materials differ within subdomains, if parts are ragged or slender "
                "and near incompressibility. They need a preconditioner.");
  expert.real("Adaptive threshold", defaults.adaptive.threshold, Range::atLeast(1.0),
              "Least ratio of energies of a mode that becomes an adaptive coarse vector: of its jump in the "
              "norm of the preconditioner, and of the mode in the subdomain.");
  expert.real("Block low rank tolerance", defaults.inverses.solver.blockLowRank, Range::within(0.0, 1e-2),
              "Relative accuracy of the compressed factors of MUMPS; 0: exact factors. A value above 0 "
              "selects MUMPS.");
  expert.integer("Fixing places", defaults.inverses.fixingPlaces, 1, 1000,
                 "Places at which the generalised inverse fixes a floating subdomain. More are added if they "
                 "do not fix all rigid-body modes.");
  expert.boolean("Check null pivots", defaults.inverses.checkNullPivots,
                 "Compares each kernel with the null pivots of MUMPS, at one more factorisation.");
  expert.integer("Expected products", defaults.expectedProducts, 0, 1000000,
                 "Number of applications of F with the Dirichlet preconditioner that the cost model assumes. "
                 "0: for each power of ten of the tolerance 8 for membranes, 10 for elastic bodies.");
  expert.text("Rates", "",
              "File with the rates of this machine for the cost model, as for --plan-rates; relative to the "
              "working directory. Empty: built-in rates, equal on all machines.");
}

// Amesos2's interface has neither Schur complements nor factors in single precision.
void checkLocalSolver(DualOptions& options) {
  const SparseSolverChoice& solver = options.inverses.solver;
  const std::string path = "Dual operator/Local solver", given = "\"" + path + "\" = \"" + solver.name + "\"";
  const std::string others = "; use \"multifrontal\" or \"MUMPS\"";
  if (!SparseSolverChoice::isAvailable(solver.name))
    throw InputError(given + " is not available in this Trilinos" +
                         offer(solver.name, SparseSolverChoice::available()),
                     {{"path", path}});
  if (solver.hasSchurComplements())
    return;
  if (options.form == DualForm::Condensed)
    throw InputError(given + " has no Schur complements, which \"Dual operator/Form\" = \"condensed\" needs" +
                         others + ", or the form \"implicit\"",
                     {{"path", path}});
  if (options.inverses.precision == Precision::Single)
    throw InputError(given + " has no factors in single precision" + others + ", or double precision",
                     {{"path", path}});
  if (solver.blockLowRank > 0.0)
    throw InputError(given + " has no block low rank factors; use \"MUMPS\"", {{"path", path}});
  options.form = DualForm::Implicit;
}

} // namespace

void DualOptions::addTo(ParameterSpec& deck) {
  const DualOptions defaults;
  ParameterSpec dual("Dual operator", "Dual operator F = BK⁺Bᵀ and its preconditioner.");
  dual.choice("Form", "auto",
              {{"implicit", "each application of F solves with sparse factors: least memory"},
               {"condensed", "a dense matrix for the boundary of each subdomain: fastest applications"},
               {"auto", "the fastest form by the cost model that fits into memory, chosen together with the "
                        "preconditioner"}},
              "Form of F.");
  dual.choice("Preconditioner", "auto",
              {{"auto", "the fastest one by the cost model, chosen together with the form; Dirichlet if "
                        "materials differ"},
               {"none", "no preconditioner"},
               {"lumped", "boundary block of the stiffness matrix: cheap, weaker"},
               {"Dirichlet", "Schur complement of the stiffness matrix; the condensed form already has it"}},
              "Approximation of the inverse of F.");
  dual.choice(
      "Precision", "auto",
      {{"auto", "double; but the implicit form uses factors in 32 bits for each subdomain where a "
                "test shows that they change its result by less than a tenth of the tolerance"},
       {"double", "64 bits"},
       {"single", "dense blocks (condensed form) or factors (implicit form) in 32 bits, sums in 64: half the "
                  "memory; tolerances below 1e-6 need the implicit form"}},
      "Precision of dense blocks and factors.");
  dual.text("Local solver", defaults.inverses.solver.name,
            "Sparse direct solver of the subdomains: \"multifrontal\" (Harmos' own), \"MUMPS\", or one of "
            "Amesos2, such as \"KLU2\", with the implicit form and double precision.")
      .formerly("Implicit solver");
  dual.integer("Memory budget MiB", defaults.memoryBudgetMiB, 0, 2000000000,
               "Memory limit of factors and dense blocks on a rank, by the cost model; 0: none.");
  addExpertTo(dual.expert());
  deck.list(std::move(dual));
}

DualOptions DualOptions::fromList(const Teuchos::ParameterList& list) {
  DualOptions options;
  const Teuchos::ParameterList& expert = list.sublist("Expert");
  const std::string form = list.get<std::string>("Form");
  if (form != "auto")
    options.form = form == "implicit" ? DualForm::Implicit : DualForm::Condensed;
  const std::string kind = list.get<std::string>("Preconditioner");
  if (kind != "auto")
    options.preconditioner = kind == "none"     ? PreconditionerKind::None
                             : kind == "lumped" ? PreconditionerKind::Lumped
                                                : PreconditionerKind::Dirichlet;
  const std::string scaling = expert.get<std::string>("Scaling");
  if (scaling != "auto")
    options.scaling =
        scaling == "stiffness" ? PreconditionerScaling::Stiffness : PreconditionerScaling::Multiplicity;
  const std::string weights = expert.get<std::string>("Weights");
  if (weights != "auto")
    options.weights = weights == "stiffness" ? RowWeights::Stiffness : RowWeights::None;
  const std::string vectors = expert.get<std::string>("Adaptive coarse vectors");
  options.adaptive.vectors = vectors == "auto"   ? AdaptiveVectors::OnDemand
                             : vectors == "none" ? AdaptiveVectors::None
                                                 : AdaptiveVectors::All;
  options.adaptive.threshold = expert.get<double>("Adaptive threshold");
  options.expectedProducts = expert.get<int>("Expected products");
  options.memoryBudgetMiB = list.get<int>("Memory budget MiB");
  if (const std::string path = expert.get<std::string>("Rates"); !path.empty())
    options.rates = ratesFromFile(path);
  LocalInverseOptions& inverses = options.inverses;
  inverses.share = expert.get<bool>("Share identical subdomains");
  const std::string precision = list.get<std::string>("Precision");
  inverses.precision = precision == "single" ? Precision::Single : Precision::Double;
  options.mayRound = precision == "auto";
  inverses.solver.name = list.get<std::string>("Local solver");
  inverses.solver.blockLowRank = expert.get<double>("Block low rank tolerance");
  checkLocalSolver(options);
  inverses.fixingPlaces = expert.get<int>("Fixing places");
  inverses.keepSchur = options.preconditioner.value_or(PreconditionerKind::Dirichlet) ==
                       PreconditionerKind::Dirichlet; // until it is decided
  inverses.checkNullPivots = expert.get<bool>("Check null pivots");
  return options;
}

void DualOptions::addDecompositionTo(ParameterSpec& deck) {
  ParameterSpec decomposition("Decomposition", "Decomposition into subdomains.");
  decomposition.choice("Dirichlet", "auto",
                       {{"auto", "dual if a body of one material comes from a mesh file, because a few nodes "
                                 "may hold its subdomains; else, and for the method \"MPRGP\", primal"},
                        {"primal", "FETI: prescribed displacements stay in the subdomain matrices"},
                        {"dual", "Total FETI: they become Lagrange multipliers; every subdomain floats"}},
                       "Form of prescribed displacements.");
  decomposition.choice("Coarse problem", "auto",
                       {{"auto", "by the cost model: distributed on many ranks"},
                        {"replicated", "every rank factors and solves all of it"},
                        {"distributed", "groups of ranks factor it together; each rank keeps its rows of the "
                                        "inverse"}},
                       "Distribution of the coarse problem. It has the rigid-body modes of all subdomains.");
  decomposition.choiceOrInteger(
      "Clusters", "auto",
      {{"auto", "by the cost model: if the coarse problem of many ranks takes most of the time"},
       {"none", "each subdomain has its own rigid-body modes in the coarse problem"},
       {"rank", "the subdomains of a rank are joined to one cluster, as far as they are connected"}},
      1, 1000000,
      "Number of subdomains per cluster. Averages join subdomains of a rank to a cluster, which has one set "
      "of rigid-body modes: a smaller coarse problem and more applications of F.");
  decomposition.expert().choice("Cluster joins", "faces",
                                {{"faces", "between two subdomains; edges and corners too, if faces have few "
                                           "nodes"},
                                 {"corners", "between more than two subdomains: corners in the plane, edges "
                                             "and corners in space"},
                                 {"all", "both"}},
                                "Location of the averages that join the subdomains of a cluster.");
  deck.list(std::move(decomposition));
}

std::optional<DirichletForm> DualOptions::decompositionFrom(const Teuchos::ParameterList& list) {
  const std::string form = list.get<std::string>("Dirichlet");
  if (form == "auto")
    return std::nullopt;
  return form == "dual" ? DirichletForm::Dual : DirichletForm::Primal;
}

CoarseOptions DualOptions::coarseFrom(const Teuchos::ParameterList& decomposition) const {
  using Form = CoarseOptions::Form;
  CoarseOptions options = coarse;
  const std::string asked = decomposition.get<std::string>("Coarse problem");
  options.form = asked == "auto" ? Form::Auto : asked == "replicated" ? Form::Replicated : Form::Distributed;
  options.rates = rates.step;
  return options;
}

ClusterOptions DualOptions::clustersFrom(const Teuchos::ParameterList& decomposition) {
  using Kind = ClusterOptions::Kind;
  using Joins = ClusterOptions::Joins;
  ClusterOptions options;
  const std::string asked = decomposition.get<std::string>("Clusters");
  options.kind = asked == "auto"   ? Kind::Auto
                 : asked == "none" ? Kind::None
                 : asked == "rank" ? Kind::Rank
                                   : Kind::Size;
  if (options.kind == Kind::Size)
    options.size = std::stoi(asked);
  const std::string joins = decomposition.sublist("Expert").get<std::string>("Cluster joins");
  options.joins = joins == "faces" ? Joins::Faces : joins == "corners" ? Joins::Corners : Joins::All;
  return options;
}

LocalInverseOptions DualOptions::inversesFor(double tolerance) const {
  LocalInverseOptions result = inverses;
  // What is accepted is an error of 30 tolerances in the energy norm; a tenth of one is not seen.
  constexpr double roundedShare = 0.1;
  constexpr double unitRoundoff = 0x1p-24; // of single precision: less is not to be had
  if (mayRound && inverses.solver.isMultifrontal() && roundedShare * tolerance > unitRoundoff)
    result.productError = roundedShare * tolerance;
  return result;
}

DualOptions::Decided DualOptions::decided(const SubdomainSystem& system, const Constraints& constraints,
                                          int usualProducts, bool mayLump, const Log& log,
                                          double tolerance) const {
  Decided result = {inversesFor(tolerance), PreconditionerKind::Dirichlet};
  if (form && preconditioner && memoryBudgetMiB == 0) {
    result.inverses.form = *form;
    result.preconditioner = *preconditioner;
  } else {
    // Half of what there is: vectors, meshes and the coarse problem need some too.
    constexpr double share = 0.5;
    FormLimits limits;
    limits.form = form;
    limits.preconditioner = preconditioner;
    limits.mayLump = mayLump;
    limits.products = expectedProducts > 0 ? expectedProducts : usualProducts;
    limits.budgetMiB = memoryBudgetMiB;
    limits.memoryMiB = share * machineMemoryMiB(*system.comm());
    if (!result.inverses.context)
      result.inverses.context = std::make_shared<FactorizationContext>();
    limits.before = before;
    const FormChoice choice =
        chooseForm(system, constraints, result.inverses, limits, *result.inverses.context, rates.local);
    result.inverses.form = choice.forms.form;
    result.preconditioner = choice.forms.preconditioner;
    log.info(choice.reason);
  }
  // Not where blocks may be shared: how many members share one depends on the ranks, and on that whether it
  // is packed; iterations are to be the same on any.
  result.inverses.roundSchur = result.inverses.form == DualForm::Implicit || !inverses.share;
  result.inverses.keepSchur = result.preconditioner == PreconditionerKind::Dirichlet;
  return result;
}

ClusterOptions DualOptions::clustersFor(const SubdomainSystem& system, const Constraints& constraints,
                                        const Decided& decided, int usualProducts, const Log& log) const {
  return decideClusters(system, constraints, clusters, decided.inverses, decided.preconditioner, coarse,
                        rates, expectedProducts > 0 ? expectedProducts : usualProducts, log);
}

int DualOptions::usualProducts(bool isElastic, double tolerance) {
  const double digits = std::clamp(-std::log10(tolerance), 2.0, 12.0);
  return static_cast<int>(std::ceil((isElastic ? 10.0 : 8.0) * digits));
}

std::string DualOptions::Decided::describe() const {
  return std::string(toString(inverses.form)) +
         (inverses.precision == Precision::Single                              ? ", single, "
          : inverses.form == DualForm::Implicit && inverses.productError > 0.0 ? ", mixed, "
                                                                               : ", double, ") +
         toString(preconditioner) + (preconditioner == PreconditionerKind::None ? "" : " preconditioner");
}

PreconditionerScaling DualOptions::scalingFor(bool hasSeveralMaterials, double contrast) const {
  // Rows that are weighted jump by the mean of the weights.
  if (weightsFor(contrast) == RowWeights::Stiffness)
    return PreconditionerScaling::Stiffness;
  return scaling.value_or(hasSeveralMaterials ? PreconditionerScaling::Stiffness
                                              : PreconditionerScaling::Multiplicity);
}

RowWeights DualOptions::weightsFor(double contrast) const {
  return weights.value_or(contrast > muchContrast ? RowWeights::Stiffness : RowWeights::None);
}

} // namespace Harmos::feti
