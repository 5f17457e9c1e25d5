// SPDX-License-Identifier: BSD-3-Clause
// A source for the precompiled header to belong to.
