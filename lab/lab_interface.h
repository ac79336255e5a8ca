// A lab in a program of any language: C functions in liblimber.so, of which Python's limber.lab is
// the first user. No exception leaves a function; what failed is a code, and text.
//
// A lab shares nothing with another one: each may be used by a thread of its own, one thread at a
// time. Lock step: equal scenarios, and equal messages between equal steps, give equal bytes.
#pragma once

#include <stddef.h>
#include <stdint.h>

#include "common/public.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef struct limber_lab limber_lab;

enum limber_lab_code {
  LIMBER_LAB_DONE = 0,
  LIMBER_LAB_REFUSED = -1,    ///< controller or simulator did not take the message; nothing changed
  LIMBER_LAB_MALFORMED = -2,  ///< no message of the channel's type and version
  LIMBER_LAB_CHANNEL = -3,    ///< none that is taken, or given, here
  LIMBER_LAB_NONE = -4,       ///< no message of it yet
  LIMBER_LAB_ROOM = -5,       ///< the message is longer than the room for it
};

/// `scenario`: YAML (scenarios/README.md), without law_file. `name`: stands for the file in errors;
/// relative paths start in its folder. Null: why not is in `problem`, as far as it fits.
LIMBER_PUBLIC limber_lab* limber_lab_open(const char* scenario, const char* name, char* problem,
                                          size_t room);
/// Null is nothing to close.
LIMBER_PUBLIC void limber_lab_close(limber_lab* lab);

/// So many control cycles; see Lab::step(). Free of allocation, locks and logs.
LIMBER_PUBLIC void limber_lab_step(limber_lab* lab, int64_t cycles);

/// An encoded request of channels.yaml to controller or simulator; it acts from the next cycle on.
/// Who sends with the timeline's `client` has its lease. Returns a code.
LIMBER_PUBLIC int limber_lab_send(limber_lab* lab, const char* channel, const uint8_t* data,
                                  size_t size);
/// Newest message of a channel, encoded, as the processes publish it. Of controller and driver
/// status and of robot info it is that of the last cycle, whether or not they would have been
/// published then. Returns its size, or a code.
LIMBER_PUBLIC int limber_lab_message(limber_lab* lab, const char* channel, uint8_t* out,
                                     size_t room);

/// Arm time of the next cycle, ns.
LIMBER_PUBLIC int64_t limber_lab_time_ns(const limber_lab* lab);
/// The control period, ns.
LIMBER_PUBLIC int64_t limber_lab_period_ns(const limber_lab* lab);
/// Why the last call of `lab` that returned a code did so; valid until the next call.
LIMBER_PUBLIC const char* limber_lab_error(const limber_lab* lab);

#ifdef __cplusplus
}
#endif
