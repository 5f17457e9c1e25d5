// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_JumpEnergy.hpp"

#include "Harmos_SubdomainSum.hpp"

#include "Harmos_Agreement.hpp"
#include "Harmos_Exchange.hpp"
#include "Harmos_TrilinosVersion.hpp"

#include <Tpetra_Import.hpp>
#include <Tpetra_MultiVector.hpp>

#include <algorithm>
#include <cmath>
#include <map>
#include <tuple>
#include <utility>

namespace Harmos::feti {
namespace {

// An entry of B_s or B_{D,t} in a row, on its way to the rank of the row.
struct RowItem {
  long long row;
  double value;
  int isScaled; // of B_D
  int rank, subdomain, place;
};

// An entry of T_ts, on its way to the rank of t.
struct Share {
  double value;
  int subdomain, place;             // of t
  int rankOf, subdomainOf, placeOf; // of s
};

// T_ts by columns.
struct Transfer {
  int rank, subdomain;                          // of s
  std::map<int, std::map<int, double>> columns; // place of s: places of t
};

// Entries of a sum over subdomains in the rows of the mask.
void addItems(const std::vector<CongruenceClass>& classes, const SubdomainSum& sum, const MultiVector& mask,
              bool isScaled, int rank, std::vector<RowItem>& items) {
  MultiVector there(sum.importer()->getTargetMap(), 1);
  there.doImport(mask, *sum.importer(), Tpetra::INSERT);
  const auto isMasked = there.getLocalViewHost(Tpetra::Access::ReadOnly);
  const Map& map = *there.getMap();
  for (std::size_t c = 0; c < classes.size(); ++c) {
    const SubdomainSum::Group& group = sum.groups()[c];
    const int size = group.op->size();
    for (const SubdomainSum::Entry& entry : group.entries)
      if (isMasked(static_cast<std::size_t>(entry.row), 0) != 0.0)
        items.push_back({static_cast<long long>(map.getGlobalElement(entry.row)), entry.value, isScaled, rank,
                         classes[c].members[static_cast<std::size_t>(entry.place / size)],
                         entry.place % size});
  }
}

// T, at the ranks of t.
std::vector<std::vector<Share>> sharesOf(const std::vector<CongruenceClass>& classes,
                                         const SubdomainSum& dual, const SubdomainSum& preconditioner,
                                         const MultiVector& mask) {
  const Map& rows = *mask.getMap();
  const Teuchos::Comm<int>& comm = *rows.getComm();
  std::vector<RowItem> mine;
  addItems(classes, dual, mask, false, comm.getRank(), mine);
  addItems(classes, preconditioner, mask, true, comm.getRank(), mine);
  std::vector<long long> distinct;
  for (const RowItem& item : mine)
    distinct.push_back(item.row);
  std::sort(distinct.begin(), distinct.end());
  distinct.erase(std::unique(distinct.begin(), distinct.end()), distinct.end());
  const Teuchos::Array<GlobalOrdinal> asked(distinct.begin(), distinct.end());
  Teuchos::Array<int> owners(asked.size());
  rows.getRemoteIndexList(asked(), owners());
  std::vector<std::vector<RowItem>> sends(static_cast<std::size_t>(comm.getSize()));
  for (const RowItem& item : mine)
    sends[static_cast<std::size_t>(
              owners[std::lower_bound(distinct.begin(), distinct.end(), item.row) - distinct.begin()])]
        .push_back(item);
  std::vector<RowItem> arrived;
  for (const std::vector<RowItem>& part : exchangeItems(comm, sends))
    arrived.insert(arrived.end(), part.begin(), part.end());
  std::sort(arrived.begin(), arrived.end(), [](const RowItem& a, const RowItem& b) {
    return std::tie(a.row, a.isScaled, a.rank, a.subdomain, a.place) <
           std::tie(b.row, b.isScaled, b.rank, b.subdomain, b.place);
  });
  std::vector<std::vector<Share>> shares(sends.size());
  for (auto begin = arrived.begin(); begin != arrived.end();) {
    const auto end =
        std::find_if(begin, arrived.end(), [&](const RowItem& item) { return item.row != begin->row; });
    const auto scaled = std::find_if(begin, end, [](const RowItem& item) { return item.isScaled != 0; });
    for (auto t = scaled; t != end; ++t)
      for (auto s = begin; s != scaled; ++s)
        shares[static_cast<std::size_t>(t->rank)].push_back(
            {t->value * s->value, t->subdomain, t->place, s->rank, s->subdomain, s->place});
    begin = end;
  }
  return exchangeItems(comm, shares);
}

// TᵀST, T given by columns; S dense with n rows.
std::vector<double> congruent(const Transfer& transfer, const std::vector<double>& s, std::size_t n) {
  const std::size_t m = transfer.columns.size();
  std::vector<double> result(m * m, 0.0), image(n);
  std::size_t j = 0;
  for (const auto& [place, column] : transfer.columns) {
    std::fill(image.begin(), image.end(), 0.0);
    for (const auto& [row, value] : column)
      for (std::size_t k = 0; k < n; ++k)
        image[k] += value * s[static_cast<std::size_t>(row) * n + k];
    std::size_t i = 0;
    for (const auto& [other, entries] : transfer.columns) {
      for (const auto& [row, value] : entries)
        result[j * m + i] += value * image[static_cast<std::size_t>(row)];
      ++i;
    }
    ++j;
  }
  return result;
}

} // namespace

std::vector<std::vector<double>> jumpEnergies(const std::vector<CongruenceClass>& classes,
                                              const SubdomainSum& dual, const SubdomainSum& preconditioner,
                                              const MultiVector& mask) {
  const Teuchos::Comm<int>& comm = *mask.getMap()->getComm();
  std::map<int, std::map<std::pair<int, int>, Transfer>> transfers; // by t, then s
  for (const std::vector<Share>& part : sharesOf(classes, dual, preconditioner, mask))
    for (const Share& share : part) {
      Transfer& transfer = transfers[share.subdomain][{share.rankOf, share.subdomainOf}];
      transfer.rank = share.rankOf;
      transfer.subdomain = share.subdomainOf;
      transfer.columns[share.placeOf][share.place] += share.value;
    }
  std::size_t subdomains = 0;
  for (const CongruenceClass& item : classes)
    subdomains += item.members.size();
  std::vector<std::vector<double>> energies(subdomains);
  std::vector<std::size_t> sizes(subdomains);
  for (std::size_t c = 0; c < classes.size(); ++c)
    for (int member : classes[c].members) {
      const auto n = static_cast<std::size_t>(dual.groups()[c].op->size());
      sizes[static_cast<std::size_t>(member)] = n;
      energies[static_cast<std::size_t>(member)].assign(n * n, 0.0);
    }
  const auto add = [&](int subdomain, const std::vector<std::size_t>& places, const double* block) {
    const auto s = static_cast<std::size_t>(subdomain);
    for (std::size_t j = 0; j < places.size(); ++j)
      for (std::size_t i = 0; i < places.size(); ++i)
        energies[s][places[j] * sizes[s] + places[i]] += block[j * places.size() + i];
  };
  // A block for another rank: subdomain, number of places, these, and the entries.
  std::vector<std::vector<double>> sends(static_cast<std::size_t>(comm.getSize()));
  agree(comm, [&] {
    for (std::size_t c = 0; c < classes.size(); ++c) {
      const BoundaryOperator& op = *preconditioner.groups()[c].op;
      const auto n = static_cast<std::size_t>(op.size());
      std::vector<double> dense;
      for (int member : classes[c].members)
        for (const auto& [of, transfer] : transfers[member]) {
          if (dense.empty())
            dense = op.matrix();
          const std::vector<double> block = congruent(transfer, dense, n);
          std::vector<std::size_t> places;
          for (const auto& column : transfer.columns)
            places.push_back(static_cast<std::size_t>(column.first));
          if (transfer.rank == comm.getRank()) {
            add(transfer.subdomain, places, block.data());
            continue;
          }
          std::vector<double>& message = sends[static_cast<std::size_t>(transfer.rank)];
          message.push_back(transfer.subdomain);
          message.push_back(static_cast<double>(places.size()));
          message.insert(message.end(), places.begin(), places.end());
          message.insert(message.end(), block.begin(), block.end());
        }
    }
  });
  for (const std::vector<double>& message : exchangeItems(comm, sends))
    for (std::size_t k = 0; k < message.size();) {
      const int subdomain = static_cast<int>(message[k]);
      const auto count = static_cast<std::size_t>(message[k + 1]);
      std::vector<std::size_t> places;
      for (std::size_t p = 0; p < count; ++p)
        places.push_back(static_cast<std::size_t>(message[k + 2 + p]));
      add(subdomain, places, message.data() + k + 2 + count);
      k += 2 + count + count * count;
    }
  return energies;
}

} // namespace Harmos::feti
