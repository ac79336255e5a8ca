#include "sim/nodes/moteus_telemetry.h"

#include <bit>
#include <span>

namespace limber::sim {
namespace {

// Types of the schema, by their numbers.
enum TelemetryType : std::uint8_t {
  kFinal = 0,
  kBoolean = 2,
  kUnsigned = 4,
  kFloat32 = 7,
  kObject = 16,
  kFixedArray = 19,
};

struct TelemetryField {
  std::string_view name;
  TelemetryType type;
  std::uint8_t bytes;    ///< of a number
  std::uint8_t numbers;  ///< 0: no array
  double (*value)(const MoteusStats&);
};

double nothing(const MoteusStats&) { return 0.0; }

constexpr std::array kFirmwareFields = {
    TelemetryField{"version", kUnsigned, 4, 0, [](const MoteusStats& s) { return s.firmware; }},
    TelemetryField{"serial_number", kUnsigned, 4, 3, [](const MoteusStats& s) { return s.id; }},
    TelemetryField{"model", kUnsigned, 4, 0, [](const MoteusStats& s) { return s.model; }},
};
constexpr std::array kGitFields = {
    TelemetryField{"hash", kUnsigned, 1, 20, nothing},
    TelemetryField{"dirty", kBoolean, 1, 0, nothing},
    TelemetryField{"timestamp", kUnsigned, 8, 0, nothing},
};
constexpr std::array kServoFields = {
    TelemetryField{"mode", kUnsigned, 1, 0, [](const MoteusStats& s) { return s.mode; }},
    TelemetryField{"fault", kUnsigned, 4, 0, [](const MoteusStats& s) { return s.fault; }},
    TelemetryField{"bus_V", kFloat32, 4, 0, [](const MoteusStats& s) { return s.voltage_V; }},
    TelemetryField{"fet_temp_C", kFloat32, 4, 0,
                   [](const MoteusStats& s) { return s.temperature_degC; }},
    TelemetryField{"q_A", kFloat32, 4, 0, [](const MoteusStats& s) { return s.q_A; }},
    TelemetryField{"position", kFloat32, 4, 0, [](const MoteusStats& s) { return s.position; }},
    TelemetryField{"velocity", kFloat32, 4, 0, [](const MoteusStats& s) { return s.velocity; }},
    TelemetryField{"torque_Nm", kFloat32, 4, 0, [](const MoteusStats& s) { return s.torque_Nm; }},
    TelemetryField{"trajectory_done", kBoolean, 1, 0,
                   [](const MoteusStats& s) { return s.trajectory_done ? 1.0 : 0.0; }},
};

struct TelemetryChannel {
  std::string_view name;
  std::span<const TelemetryField> fields;
};
constexpr std::array<TelemetryChannel, MoteusTelemetry::kChannels> kTelemetryChannels = {{
    {"firmware", kFirmwareFields},
    {"git", kGitFields},
    {"servo_stats", kServoFields},
}};

/// Bytes on their way into the text.
class Blob {
 public:
  void put(std::uint64_t value, int bytes) noexcept {
    for (int i = 0; i < bytes && size_ < bytes_.size(); ++i, value >>= 8U)
      bytes_[size_++] = static_cast<char>(value & 0xFFU);
  }
  void put(std::string_view text) noexcept {
    put(text.size(), 1);
    for (const char letter : text) put(static_cast<std::uint8_t>(letter), 1);
  }
  std::string_view bytes() const noexcept { return {bytes_.data(), size_}; }

 private:
  std::array<char, 512> bytes_{};
  std::size_t size_ = 0;
};

void put_type(const TelemetryField& field, Blob* blob) noexcept {
  if (field.numbers > 0) {
    blob->put(kFixedArray, 1);
    blob->put(field.numbers, 1);
  }
  blob->put(field.type, 1);
  if (field.type == kUnsigned) blob->put(field.bytes, 1);
}

/// A field: flags, name, no aliases, type, no default.
void put_schema(std::span<const TelemetryField> fields, Blob* blob) noexcept {
  blob->put(kObject, 1);
  blob->put(0, 1);
  for (const TelemetryField& field : fields) {
    blob->put(0, 1);
    blob->put(field.name);
    blob->put(0, 1);
    put_type(field, blob);
    blob->put(0, 1);
  }
  constexpr int kNoField = 3;  // flags, name, aliases
  blob->put(0, kNoField);
  blob->put(kFinal, 1);
  blob->put(0, 1);
}

void put_data(std::span<const TelemetryField> fields, const MoteusStats& stats,
              Blob* blob) noexcept {
  for (const TelemetryField& field : fields) {
    const double value = field.value(stats);
    const std::uint64_t raw = field.type == kFloat32
                                  ? std::bit_cast<std::uint32_t>(static_cast<float>(value))
                                  : static_cast<std::uint64_t>(value);
    for (int i = 0; i < (field.numbers > 0 ? field.numbers : 1); ++i) blob->put(raw, field.bytes);
  }
}

void say_blob(std::string_view word, std::string_view name, const Blob& blob,
              MoteusText* text) noexcept {
  Blob size;
  size.put(blob.bytes().size(), 4);
  text->write(word);
  text->write(" ");
  text->write(name);
  text->write("\r\n");
  text->write(size.bytes());
  text->write(blob.bytes());
}

void say_text(const TelemetryChannel& channel, const MoteusStats& stats,
              MoteusText* text) noexcept {
  for (const TelemetryField& field : channel.fields) {
    text->write(channel.name);
    text->write(".");
    text->write(field.name);
    text->write_value(" ", field.value(stats), field.type != kFloat32, "\r\n");
  }
  text->ok();
}

}  // namespace

void MoteusTelemetry::command(std::string_view words, const MoteusStats& stats,
                              MoteusText* text) noexcept {
  const std::string_view verb = next_word(&words);
  if (verb == "stop") return text->ok();
  if (verb == "text") {
    as_text_.fill(true);
    return text->ok();
  }
  if (verb == "list") {
    for (const TelemetryChannel& channel : kTelemetryChannels) {
      text->write(channel.name);
      text->write("\r\n");
    }
    return text->ok();
  }
  if (verb != "schema" && verb != "get" && verb != "fmt") return text->error("unknown subcommand");

  const std::string_view name = next_word(&words);
  std::size_t i = 0;
  while (i < kChannels && kTelemetryChannels[i].name != name) ++i;
  if (i == kChannels) return text->error("unknown name");
  Blob blob;
  if (verb == "fmt") {
    double format = 0.0;
    if (!parse_number(words, &format)) return text->error("no format");
    as_text_[i] = format != 0.0;
    text->ok();
  } else if (verb == "schema") {
    put_schema(kTelemetryChannels[i].fields, &blob);
    say_blob("schema", name, blob, text);
  } else if (as_text_[i]) {
    say_text(kTelemetryChannels[i], stats, text);
  } else {
    put_data(kTelemetryChannels[i].fields, stats, &blob);
    say_blob("emit", name, blob, text);
  }
}

}  // namespace limber::sim
