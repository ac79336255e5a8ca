// Frames as lines of text, in the log format of can-utils (candump -l, canplayer):
//
//   (sec.usec) INTERFACE ID#DATA          classic; R for a remote frame, R4 with its length
//   (sec.usec) INTERFACE ID##FDATA        FD; F is a digit of flags: 1 bit-rate switch
//
// ID has three hexadecimal digits for 11 bits and eight for 29 bits and for error frames
// (20000000 | class). Set-up and files only.
#pragma once

#include <cstdint>
#include <fstream>
#include <string>
#include <string_view>

#include "drivers/can/can_frame.h"

namespace limber {

struct LoggedFrame {
  std::int64_t time_ns = 0;
  std::string interface;
  CanFrame frame;  ///< timestamp_ns is the time, too
};

/// One line without its end, cut to whole microseconds.
std::string to_candump(const LoggedFrame& logged);
/// False if the line is none of the format or the frame one that no bus could carry. Blanks and a
/// mark of direction (T, R) at the end are let pass.
[[nodiscard]] bool from_candump(std::string_view line, LoggedFrame* logged);

/// Name of a bus in such a file: what follows the colon of its address, can0 of socketcan:can0.
std::string candump_interface(const std::string& address);

class CandumpWriter {
 public:
  /// Throws ConfigError if the file cannot be written.
  explicit CandumpWriter(const std::string& path);
  /// Throws std::runtime_error when the disk refuses.
  void write(const LoggedFrame& logged);
  void flush();
  std::int64_t frames() const { return frames_; }

 private:
  void check() const;

  std::string path_;
  std::ofstream file_;
  std::int64_t frames_ = 0;
};

class CandumpReader {
 public:
  /// Throws ConfigError if the file cannot be read.
  explicit CandumpReader(const std::string& path);
  /// False at the end; empty lines are skipped. Throws ConfigError with the line's number.
  bool next(LoggedFrame* logged);
  int line() const { return line_; }

 private:
  std::string path_;
  std::ifstream file_;
  int line_ = 0;
};

}  // namespace limber
