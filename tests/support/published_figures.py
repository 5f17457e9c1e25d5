# SPDX-License-Identifier: BSD-3-Clause
"""Figures that others published or that were measured with their programs, on the model problem.

By N = H/h, then for S = 1/H = 1, 2, 4, 8, at the tolerance 1e-4. The paper is Dostal, Horak, Vlach,
"Toward scalable FETI algorithm for variational inequalities with applications to composites".
"""

SIDES = (1, 2, 4, 8)

# The paper's conjugate gradient iterations.
PAPER_CG = {8: (10, 20, 23, 27), 32: (17, 33, 30, 37), 128: (28, 59, 36, 47)}

# All Hessian applications of PERMON 3.18 with tuned options on two ranks.
PERMON = {8: (17, 22, 28, 40), 32: (20, 29, 38, 54), 128: (24, 45, 56, 84)}

# The largest problem of the paper, S = 8 and N = 256: seconds of the paper on 64 processors of its
# time; products, seconds and GB of PERMON 3.18 with CHOLMOD on a machine of two cores.
PAPER_LARGEST_SECONDS = 1281
PERMON_LARGEST_PRODUCTS, PERMON_LARGEST_SECONDS, PERMON_LARGEST_GB = 98, 107, 11.5
