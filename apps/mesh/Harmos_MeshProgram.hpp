// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace Harmos::app {

/// harmos-mesh: reads a mesh or a geometry, reports what it holds, cuts its bodies and writes one file of
/// which every rank of a run reads its own parts. One process.
///
/// Exit status: 0 done; 2 bad input, also where Gmsh, which reads it in a process of its own, does not
/// survive it; 3 internal error. Guarded by tests/regression/files/test_mesh_program.py.
int meshMain(int argc, char** argv);

} // namespace Harmos::app
