// Everything that runs over rows of joints stands in headers that are compiled once for each kind
// of processor, a level; each has a namespace of its own. All levels give the same bits: nothing is
// fused (-ffp-contract=off), and each joint's numbers are added in one order.
#pragma once

// Set by the source file of a level, level_*.cc.
#ifndef LIMBER_LEVEL
#define LIMBER_LEVEL plain
#define LIMBER_LANES 2  // doubles in a register
#define LIMBER_TARGET
#endif
