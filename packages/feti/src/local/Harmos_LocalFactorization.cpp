// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_LocalFactorization.hpp"

#include "Harmos_Errors.hpp"

namespace Harmos::feti {

bool SparseSolverChoice::isAvailable(const std::string& name) {
  return name == multifrontal || name == mumps || Details::isInAmesos(name);
}

std::vector<std::string> SparseSolverChoice::available() {
  std::vector<std::string> result = {multifrontal, mumps};
  for (const char* name : {"KLU2", "Basker", "CHOLMOD", "SuperLU", "UMFPACK", "PardisoMKL", "LAPACK"})
    if (Details::isInAmesos(name))
      result.push_back(name);
  return result;
}

std::shared_ptr<const FrontTree> FactorizationContext::tree(const LocalMatrix& pattern,
                                                            const std::vector<int>& rest, FrontTree::Rest use,
                                                            bool& isNew) {
  const std::size_t entries = pattern.entries(), hash = patternHash(pattern);
  std::shared_ptr<const FrontTree>& known = trees_[{entries, hash, rest, use == FrontTree::Rest::Absent}];
  isNew = known == nullptr;
  if (isNew) {
    std::shared_ptr<const FrontTree>& model = models_[{entries, hash}];
    known = std::make_shared<FrontTree>(pattern, rest, use, model.get());
    if (model == nullptr || likeness_ == Likeness::Last)
      model = known;
  }
  return known;
}

std::vector<int>& FactorizationContext::position(const LocalMatrix& pattern, const std::vector<int>& rest) {
  return positions_[{pattern.entries(), patternHash(pattern), rest, false}];
}

void Details::requireGraph(std::size_t hash, const LocalMatrix& matrix) {
  if (patternHash(matrix) != hash)
    throw InputError("the graph of the matrix differs from the one analysed; repeat the analysis");
}

std::unique_ptr<LocalFactorization> makeLocalFactorization(const LocalMatrix& matrix,
                                                           const LocalFactorizationSettings& settings,
                                                           std::shared_ptr<FactorizationContext> context) {
  return settings.solver.isMultifrontal()
             ? Details::makeMultifrontalFactorization(matrix, settings, std::move(context))
             : Details::makeAmesosFactorization(matrix, settings, std::move(context));
}

} // namespace Harmos::feti
