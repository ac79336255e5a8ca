// Frames of CANopen's SDO, both ways: what is understood is encoded to what means the same.
#include "drivers/protocols/canopen_sdo.h"

#include "tests/fuzz/support/fuzz_input.h"
#include "tests/fuzz/support/require.h"

using namespace limber;
using canopen::SdoMessage;

namespace {

using canopen::SdoKind;

/// In what a message of this kind carries; `bare`: the kind that has nothing but its object.
bool same(const SdoMessage& a, const SdoMessage& b, SdoKind bare) {
  if (a.kind != b.kind) return false;
  if (a.kind == SdoKind::kReadSegment || a.kind == SdoKind::kWriteSegment)
    return a.toggle == b.toggle && a.bytes == b.bytes && a.last == b.last && a.segment == b.segment;
  const bool same_object = a.object.index == b.object.index && a.object.sub == b.object.sub;
  return same_object && (a.kind == bare || (a.value == b.value && a.bytes == b.bytes));
}

template <typename Decode, typename Encode>
void there_and_back(const CanFrame& frame, std::uint8_t node, Decode decode, Encode encode,
                    SdoKind bare) {
  SdoMessage message;
  if (!decode(frame, node, &message) || message.kind == SdoKind::kUnknown) return;
  const CanFrame again = encode(message, node);
  SdoMessage twice;
  fuzz::require(is_possible(again), "an SDO frame can be carried");
  fuzz::require(decode(again, node, &twice) && same(message, twice, bare),
                "what is encoded is read");
  canopen::text_of(static_cast<canopen::SdoAbort>(message.value));
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  fuzz::FuzzInput input(data, size);
  while (!input.empty()) {
    const std::uint8_t node = 1 + input.take<std::uint8_t>() % 127;
    CanFrame frame = input.frame();
    canopen::is_sdo_write(frame);
    there_and_back(frame, node, canopen::decode_sdo_request, canopen::encode_sdo_request,
                   SdoKind::kRead);
    there_and_back(frame, node, canopen::decode_sdo_answer, canopen::encode_sdo_answer,
                   SdoKind::kWrite);
  }
  return 0;
}
