#include "robots/loader/protocols/drive_protocol.h"
#include "tools/check/json.h"
#include "tools/check/print.h"

namespace limber {
namespace {

std::string text_of(std::string_view text) { return json::text(std::string(text)); }

std::string key_json(const ProtocolKey& key) {
  std::string_view rest(key.key);
  const std::string_view usual = rest.substr(0, rest.find('|'));
  std::vector<std::string> others;
  while (rest.find('|') != std::string_view::npos) {
    rest.remove_prefix(rest.find('|') + 1);
    others.push_back(text_of(rest.substr(0, rest.find('|'))));
  }
  return json::object({{"section", json::text(key.section)},
                       {"key", text_of(usual)},
                       {"others", json::list(others)},
                       {"what", json::text(key.what)},
                       {"found", json::text(key.found)},
                       {"least", json::number(key.first.least)},
                       {"figure", text_of(name_of(key.first.of))},
                       {"factor", json::number(key.first.factor)},
                       {"word", json::text(key.first.word)}});
}

std::string protocol_json(const DriveProtocol& protocol) {
  std::vector<std::string> keys;
  for (const ProtocolKey& key : protocol.required) keys.push_back(key_json(key));
  return json::object({{"word", text_of(protocol.word)},
                       {"title", text_of(protocol.title)},
                       {"needs_fd", json::flag(protocol.needs_fd)},
                       {"usually_fd", json::flag(protocol.usually_fd)},
                       {"reports_link", json::flag(protocol.reports_link)},
                       {"rotary_only", json::flag(protocol.rotary_only)},
                       {"hex_ids", json::flag(protocol.hex_ids)},
                       {"id_found", json::text(protocol.id_found)},
                       {"sample_point", json::number(protocol.sample_point)},
                       {"usual_gear_ratio", json::number(protocol.usual_gear_ratio)},
                       {"joints_a_bus", json::number(protocol.joints_a_bus)},
                       {"limit_temperature_degC", json::number(protocol.limit_temperature_degC)},
                       {"required", json::list(keys)}});
}

}  // namespace

std::string protocols_json() {
  std::vector<std::string> protocols;
  for (const DriveProtocol* protocol : drive_protocols())
    protocols.push_back(protocol_json(*protocol));
  return json::object({{"protocols", json::list(protocols)}}) + "\n";
}

}  // namespace limber
