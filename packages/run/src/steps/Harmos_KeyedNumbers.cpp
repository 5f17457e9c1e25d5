// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_KeyedNumbers.hpp"

#include "Harmos_Errors.hpp"
#include "Harmos_Exchange.hpp"

#include <algorithm>

namespace Harmos::run {

KeyedNumbers::KeyedNumbers(const Teuchos::Comm<int>& comm, std::vector<long long> keys) : comm_(comm) {
  std::vector<long long> all = gatherAll(comm, keys);
  std::sort(all.begin(), all.end());
  count_ = all.size();
  for (const long long key : keys)
    places_.push_back(static_cast<std::size_t>(std::lower_bound(all.begin(), all.end(), key) - all.begin()));
}

void KeyedNumbers::sum(std::vector<double>& values) const {
  globalSum(comm_, values);
}

double KeyedNumbers::largest(double value) const {
  return globalMax(comm_, value);
}

void KeyedNumbers::exchange(qp::StateArchive<MultiVector>& archive, const std::string& name,
                            const std::string& label, std::vector<double>& own) const {
  const std::size_t each = static_cast<std::size_t>(
      globalMax(comm_, static_cast<long long>(size() == 0 ? 0 : own.size() / size())));
  std::vector<double> all(archive.isReading() ? 0 : each * count_, 0.0);
  if (!archive.isReading()) {
    for (std::size_t k = 0; k < size(); ++k)
      std::copy_n(own.data() + each * k, each, all.data() + each * places_[k]);
    globalSum(comm_, all); // each has one owner
  }
  archive.numbers(name, all);
  if (all.size() != each * count_)
    throw InputError("the checkpoint holds " + std::to_string(all.size()) + " numbers of " + label +
                     ", but there are " + std::to_string(each * count_) +
                     "; restart with the deck and the meshes of the run that wrote it");
  own.resize(each * size());
  for (std::size_t k = 0; k < size(); ++k)
    std::copy_n(all.data() + each * places_[k], each, own.data() + each * k);
}

} // namespace Harmos::run
