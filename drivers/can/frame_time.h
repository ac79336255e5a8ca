// How long a frame keeps a CAN bus busy.
//
// Classic frame with n data bytes, worst case (ISO 11898-1; all stuff bits and the 3-bit gap):
//   11-bit id: 47 + 8 n + floor((33 + 8 n) / 4) bits
//   29-bit id: 67 + 8 n + floor((53 + 8 n) / 4) bits
// FD frame, A = 17 (11-bit id) or 36 (29-bit id) bits from start of frame to bit-rate switch; CRC
// and its fixed stuff bits C + F = 17 + 6 up to 16 bytes, 21 + 7 above:
//   at the nominal rate: A + floor((A - 1) / 4) + 13
//   at the data rate:    5 + 8 n + S + 4 + C + F,  S = floor((A + 4 + 8 n) / 4) - floor((A - 1) /
//   4)
#pragma once

#include "drivers/can/can_frame.h"

namespace limber {

/// Longest time that a data frame of this size can take, s. `bytes` of an FD frame are rounded up
/// to a length it can have. data_bitrate_bps counts for FD frames only, which are taken to switch
/// their bit rate.
double worst_frame_time_s(int bytes, bool extended, bool fd, double bitrate_bps,
                          double data_bitrate_bps) noexcept;

/// Bits of a classic data or remote frame, stuff bits and the 3-bit gap included, exactly as sent.
int classic_frame_bits(const CanFrame& frame) noexcept;

/// Time that this very frame takes, s, its own stuff bits counted. 0 for error frames, which are
/// messages of the adapter and no frames on the bus. Allowed inside the cycle.
double frame_time_s(const CanFrame& frame, double bitrate_bps, double data_bitrate_bps) noexcept;

}  // namespace limber
