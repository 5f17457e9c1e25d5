// SPDX-License-Identifier: BSD-3-Clause
// For a quick look.
scale = 12;
Include "half_ball.geo";
