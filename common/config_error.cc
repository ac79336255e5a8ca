#include "common/config_error.h"

namespace limber {

ConfigError ConfigError::at(const std::string& file, int line, const std::string& key,
                            const std::string& problem) {
  std::string text = file;
  if (line > 0) text += ":" + std::to_string(line);
  if (!text.empty()) text += ": ";
  if (!key.empty()) text += key + ": ";
  return ConfigError(text + problem);
}

}  // namespace limber
