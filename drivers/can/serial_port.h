// A serial line, raw and without waiting.
#pragma once

#include <string>

#include "common/file_descriptor.h"

namespace limber {

/// Opens it for this process alone. `address` is for messages, `baud` one of the usual rates, which
/// USB devices of class CDC ignore. Throws ConfigError: no such device, no permission, no serial
/// line, in use, another rate. Set-up only.
FileDescriptor open_serial_port(const std::string& address, const std::string& path, int baud);

}  // namespace limber
