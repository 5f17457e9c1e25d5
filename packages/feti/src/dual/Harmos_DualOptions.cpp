// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_DualOptions.hpp"

#include <algorithm>
#include <cmath>

namespace Harmos::feti {

void DualOptions::addTo(ParameterSpec& deck) {
  const DualOptions defaults;
  ParameterSpec dual("Dual operator", "The product with F = BK⁺Bᵀ, and its preconditioner.");
  dual.choice("Form", "auto",
              {{"implicit", "a solve with each sparse factorisation a product: least memory"},
               {"condensed", "a dense matrix for the boundary of each subdomain: fastest products"},
               {"auto", "with the preconditioner, what is fastest by the cost model and fits into memory"}},
              "How products with F are made.");
  dual.boolean(
      "Share identical subdomains", defaults.inverses.share,
      "Subdomains with equal matrices share one factorisation, and products with all of them are made "
      "at once.");
  dual.choice(
      "Preconditioner", "auto",
      {{"auto", "with the form, what is fastest by the cost model; Dirichlet where materials differ"},
       {"none", "no preconditioner"},
       {"lumped", "the boundary block of the stiffness matrix: cheap, weaker"},
       {"Dirichlet", "the Schur complement of the stiffness matrix; free to set up in the condensed form"}},
      "Approximation of the inverse of F.");
  dual.choice("Scaling", "auto",
              {{"auto", "stiffness if the scene has more than one material, else multiplicity"},
               {"multiplicity",
                "copies of a dof share a jump equally; where rows have weights, in proportion to these"},
               {"stiffness", "the softer copy takes more of it: for materials that jump across interfaces"}},
              "Scaling of the preconditioner.");
  dual.choice(
      "Weights", "auto",
      {{"auto",
        "stiffness if the scene has materials whose stiffness differs by more than 30 times, else none"},
       {"none", "the coarse projector is the orthogonal one"},
       {"stiffness", "constraints, and with them the coarse projector and the norms of residuals, are "
                     "weighted by the stiffness at their dofs: products do not depend on how much "
                     "materials jump between subdomains"}},
      "Inner product of the multipliers.");
  dual.choice("Adaptive coarse vectors", "auto",
              {{"auto", "once the solver gets on slowly, of all subdomains"},
               {"none", "the coarse space is that of the rigid motions alone"},
               {"all", "from the first iteration on, of all subdomains"}},
              "Coarse vectors for modes of a subdomain that cost it little and its neighbours much, as where "
              "materials jump within subdomains, parts are ragged or slender, or nearly incompressible. They "
              "need a preconditioner.");
  dual.real("Adaptive threshold", defaults.adaptive.threshold, Range::atLeast(1.0),
            "Adaptive coarse vectors are made of modes whose energy as a jump, in the norm of the "
            "preconditioner, is more than so many times that in the subdomain.");
  dual.choice(
      "Precision", "auto",
      {{"auto",
        "double; but products of the implicit form by factors in 32 bits, one subdomain after the other, "
        "where that changes its answer by less than a tenth of the tolerance, which is tried"},
       {"double", "64 bits"},
       {"single", "dense blocks (condensed) or factors (implicit) in 32 bits, sums in 64: half the memory; "
                  "tolerances below 1e-6 need the implicit form"}},
      "In which precision blocks and factors are kept.");
  dual.text("Implicit solver", defaults.inverses.solver.name,
            "Sparse direct solver of the subdomains: multifrontal (Harmos' own, made for single right-hand "
            "sides), MUMPS, or for the implicit form alone a name that Amesos2 knows, such as KLU2.");
  dual.real(
      "Block low rank tolerance", defaults.inverses.solver.blockLowRank, Range::within(0.0, 1e-2),
      "Relative accuracy to which MUMPS, which is taken then, compresses factors; 0 for exact factors.");
  dual.integer(
      "Fixing places", defaults.inverses.fixingPlaces, 1, 1000,
      "Places at which a floating subdomain is held in its generalised inverse; more are added where they "
      "do not hold all rigid motions.");
  dual.boolean("Check null pivots", defaults.inverses.checkNullPivots,
               "Compare each kernel with the null pivots that MUMPS finds; costs a factorisation more.");
  dual.integer("Expected products", defaults.expectedProducts, 0, 1000000,
               "Products with F, with the Dirichlet preconditioner, that the cost model of Form = auto "
               "reckons with; 0: "
               "for each power of ten of the tolerance 8 for membranes, 10 for elastic bodies.");
  dual.integer("Memory budget MiB", defaults.memoryBudgetMiB, 0, 2000000000,
               "Limit of what factors and dense blocks may take on a rank, by the cost model; 0 for none.");
  dual.text("Rates", "",
            "A file of this machine's rates for the cost model, as --plan-rates takes them; the path is that "
            "from where the program runs. Empty: rates that were measured once, the same everywhere.");
  deck.list(std::move(dual));
}

DualOptions DualOptions::fromList(const Teuchos::ParameterList& list) {
  DualOptions options;
  const std::string form = list.get<std::string>("Form");
  if (form != "auto")
    options.form = form == "implicit" ? DualForm::Implicit : DualForm::Condensed;
  const std::string kind = list.get<std::string>("Preconditioner");
  if (kind != "auto")
    options.preconditioner = kind == "none"     ? PreconditionerKind::None
                             : kind == "lumped" ? PreconditionerKind::Lumped
                                                : PreconditionerKind::Dirichlet;
  const std::string scaling = list.get<std::string>("Scaling");
  if (scaling != "auto")
    options.scaling =
        scaling == "stiffness" ? PreconditionerScaling::Stiffness : PreconditionerScaling::Multiplicity;
  const std::string weights = list.get<std::string>("Weights");
  if (weights != "auto")
    options.weights = weights == "stiffness" ? RowWeights::Stiffness : RowWeights::None;
  const std::string vectors = list.get<std::string>("Adaptive coarse vectors");
  options.adaptive.vectors = vectors == "auto"   ? AdaptiveVectors::OnDemand
                             : vectors == "none" ? AdaptiveVectors::None
                                                 : AdaptiveVectors::All;
  options.adaptive.threshold = list.get<double>("Adaptive threshold");
  options.expectedProducts = list.get<int>("Expected products");
  options.memoryBudgetMiB = list.get<int>("Memory budget MiB");
  if (const std::string path = list.get<std::string>("Rates"); !path.empty())
    options.rates = ratesFromFile(path);
  LocalInverseOptions& inverses = options.inverses;
  inverses.share = list.get<bool>("Share identical subdomains");
  const std::string precision = list.get<std::string>("Precision");
  inverses.precision = precision == "single" ? Precision::Single : Precision::Double;
  options.mayRound = precision == "auto";
  inverses.solver.name = list.get<std::string>("Implicit solver");
  inverses.solver.blockLowRank = list.get<double>("Block low rank tolerance");
  inverses.fixingPlaces = list.get<int>("Fixing places");
  inverses.keepSchur = options.preconditioner.value_or(PreconditionerKind::Dirichlet) ==
                       PreconditionerKind::Dirichlet; // until it is decided
  inverses.checkNullPivots = list.get<bool>("Check null pivots");
  return options;
}

void DualOptions::addDecompositionTo(ParameterSpec& deck) {
  ParameterSpec decomposition("Decomposition", "How the bodies are torn.");
  decomposition.choice("Dirichlet", "auto",
                       {{"auto", "dual where a body of one material comes from a mesh file, whose subdomains "
                                 "may be held by a few nodes only; else, and for \"MPRGP\", primal"},
                        {"primal", "FETI: prescribed displacements stay in the subdomain matrices"},
                        {"dual", "Total FETI: they become Lagrange multipliers; every subdomain floats"}},
                       "How prescribed displacements are enforced.");
  decomposition.choice("Coarse problem", "auto",
                       {{"auto", "by the cost model: distributed where there are many ranks"},
                        {"replicated", "every rank factors and solves all of it"},
                        {"distributed", "groups of ranks factor it together, each rank keeps its rows of the "
                                        "inverse"}},
                       "Who solves the coarse problem, of the rigid motions of all subdomains.");
  decomposition.choiceOrInteger(
      "Clusters", "auto",
      {{"auto", "by the cost model: where the coarse problem of many ranks takes most of the time"},
       {"none", "each subdomain has rigid motions of its own in the coarse problem"},
       {"rank", "the subdomains of a rank are joined to one cluster, as far as they hang together"}},
      1, 1000000,
      "Subdomains of a rank that averages join to clusters of about so many, each of which has one set of "
      "rigid motions: a smaller coarse problem, and more products.");
  decomposition.choice(
      "Cluster joins", "faces",
      {{"faces", "where two subdomains meet; edges and corners too where faces are of few nodes"},
       {"corners", "where more than two do: corners in the plane, edges and corners in space"},
       {"all", "both"}},
      "Where averages join the subdomains of a cluster.");
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
  const std::string joins = decomposition.get<std::string>("Cluster joins");
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
