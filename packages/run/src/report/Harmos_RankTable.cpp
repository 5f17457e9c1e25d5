// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_RankTable.hpp"

#include "Harmos_Agreement.hpp"
#include "Harmos_AtomicFile.hpp"
#include "Harmos_Exchange.hpp"

#include <array>
#include <iomanip>
#include <sstream>
#include <unistd.h>

namespace Harmos::run {

void writeRankTable(const Teuchos::Comm<int>& comm, const std::string& path,
                    const std::vector<std::string>& stages, const RankShare& share) {
  std::array<char, 64> host{};
  if (::gethostname(host.data(), host.size() - 1) != 0)
    host[0] = '\0';
  const std::vector<std::array<char, 64>> hosts = gatherAll(comm, std::vector<std::array<char, 64>>{host});
  std::vector<double> mine = {static_cast<double>(share.subdomains),
                              static_cast<double>(share.primalDimension), share.dualOperatorMiB,
                              share.peakMemoryMiB};
  mine.insert(mine.end(), share.seconds.begin(), share.seconds.end());
  const std::vector<double> all = gatherAll(comm, mine);
  agree(comm, [&] {
    if (comm.getRank() != 0)
      return;
    std::ostringstream text;
    text << "rank,host,subdomains,primal_dimension,dual_operator_mib,peak_memory_mib";
    for (const std::string& stage : stages)
      text << ',' << stage;
    text << '\n' << std::setprecision(9);
    for (std::size_t rank = 0; rank < hosts.size(); ++rank) {
      text << rank << ',' << hosts[rank].data();
      for (std::size_t k = 0; k < mine.size(); ++k)
        text << ',' << all[rank * mine.size() + k];
      text << '\n';
    }
    io::writeAtomically(path, text.str());
  });
}

} // namespace Harmos::run
