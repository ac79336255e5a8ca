#include "tools/can/error_text.h"

#include <linux/can/error.h>

namespace limber::bus_tools {
namespace {

struct Bit {
  std::uint32_t bit;
  const char* word;
};
constexpr Bit kClasses[] = {
    {CAN_ERR_TX_TIMEOUT, "transmit time-out"},
    {CAN_ERR_LOSTARB, "arbitration lost"},
    {CAN_ERR_CRTL, "controller"},
    {CAN_ERR_PROT, "protocol"},
    {CAN_ERR_TRX, "transceiver"},
    {CAN_ERR_ACK, "nobody acknowledges: is anything else on the bus?"},
    {CAN_ERR_BUSOFF, "bus-off"},
    {CAN_ERR_BUSERROR, "bus error"},
    {CAN_ERR_RESTARTED, "controller restarted"},
};
constexpr Bit kController[] = {
    {CAN_ERR_CRTL_RX_OVERFLOW, "receive buffer full"},
    {CAN_ERR_CRTL_TX_OVERFLOW, "transmit buffer full"},
    {CAN_ERR_CRTL_RX_WARNING, "many receive errors"},
    {CAN_ERR_CRTL_TX_WARNING, "many transmit errors"},
    {CAN_ERR_CRTL_RX_PASSIVE, "receiver passive"},
    {CAN_ERR_CRTL_TX_PASSIVE, "transmitter passive"},
    {CAN_ERR_CRTL_ACTIVE, "active again"},
};
constexpr Bit kProtocol[] = {
    {CAN_ERR_PROT_BIT, "single bit"},        {CAN_ERR_PROT_FORM, "format"},
    {CAN_ERR_PROT_STUFF, "stuff bit"},       {CAN_ERR_PROT_BIT0, "no dominant bit"},
    {CAN_ERR_PROT_BIT1, "no recessive bit"}, {CAN_ERR_PROT_OVERLOAD, "overload"},
    {CAN_ERR_PROT_ACTIVE, "active error"},   {CAN_ERR_PROT_TX, "while sending"},
};
constexpr std::uint32_t kCounters = 0x200;  // CAN_ERR_CNT, newer than some headers

template <std::size_t n>
std::string words(const Bit (&table)[n], std::uint32_t bits) {
  std::string text;
  for (const Bit& row : table) {
    if ((bits & row.bit) != 0) text += (text.empty() ? "" : " and ") + std::string(row.word);
  }
  return text;
}

}  // namespace

std::vector<Value> error_values(const CanFrame& frame) {
  std::vector<Value> values;
  for (const Bit& row : kClasses) {
    if ((frame.id & row.bit) == 0) continue;
    std::string detail;
    if (row.bit == CAN_ERR_CRTL) detail = words(kController, frame.data[1]);
    if (row.bit == CAN_ERR_PROT) detail = words(kProtocol, frame.data[2]);
    values.push_back({row.word + std::string(detail.empty() ? "" : ":"), detail, ""});
  }
  if ((frame.id & kCounters) != 0) {
    values.push_back({"transmit errors", std::to_string(frame.data[6]), ""});
    values.push_back({"receive errors", std::to_string(frame.data[7]), ""});
  }
  if (values.empty()) values.push_back({"unknown class", hex(frame.id, 8), ""});
  return values;
}

}  // namespace limber::bus_tools
