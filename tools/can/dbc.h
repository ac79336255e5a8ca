// DBC files: the frames of a bus as other people's tools read them. As far as DBC goes: a frame
// whose layout depends on its content is described by its usual one, and a comment says so.
#pragma once

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

namespace limber::bus_tools::dbc {

struct Signal {
  std::string name;
  int start_bit = 0;  ///< as in DBC: of the lowest bit, or with `motorola` of the highest
  int bits = 0;
  bool motorola = false;  ///< upper byte first
  bool is_signed = false;
  bool is_float = false;  ///< float32
  double scale = 1.0;     ///< value = raw * scale + offset
  double offset = 0.0;
  double low = 0.0;  ///< both 0: not given
  double high = 0.0;
  std::string unit = {};
  std::vector<std::pair<int, std::string>> words = {};  ///< of raw values
};

struct Message {
  std::uint32_t id = 0;
  bool extended = false;
  bool fd = false;
  std::string name;
  int bytes = 0;
  bool from_host = false;
  std::string node;  ///< the drive or sensor at the other end
  std::string comment;
  std::vector<Signal> signals;
};

/// Bit of Signal::start_bit for the highest bit of a Motorola field: byte from 0, bit 7 the
/// highest.
constexpr int motorola_bit(int byte, int bit) { return 8 * byte + bit; }

/// A name that DBC allows: letters, digits, '_', no digit in front.
std::string identifier(const std::string& name);

/// The file. Node names come from the messages; the host is `limber`.
std::string file_text(const std::string& comment, const std::vector<Message>& messages);

}  // namespace limber::bus_tools::dbc
