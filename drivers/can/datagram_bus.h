// What buses on kernel sockets have in common: batches of datagrams, one frame each, out and in.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "common/datagram_batch.h"
#include "common/file_descriptor.h"
#include "drivers/can/can_bus.h"

namespace limber {

/// A carrier opens the sockets, encodes and decodes frames, and interprets errors of its sockets.
/// After construction allowed in the cycle.
class DatagramBus : public CanBus {
 public:
  using CanBus::send;

  int send(std::span<const CanFrame> frames) noexcept final;
  int receive(std::span<CanFrame> frames) noexcept final;
  int descriptor() const noexcept final { return receiver_.get(); }
  const CanStatistics& statistics() const noexcept final { return statistics_; }

 protected:
  /// `fd`: FD frames may be sent.
  DatagramBus(bool fd, Stamps stamps, std::size_t longest_sent, std::size_t longest_received)
      : fd_(fd), stamps_(stamps), outgoing_(longest_sent), incoming_(longest_received) {}

  /// Writes a possible frame; returns the number of bytes.
  virtual std::size_t encode(const CanFrame& frame, std::span<std::uint8_t> out) const noexcept = 0;
  /// False if the datagram is no frame.
  virtual bool decode(std::span<const std::uint8_t> datagram, CanFrame* frame) const noexcept = 0;
  /// A frame was decoded; false: it is not for this end.
  virtual bool note_received(const CanFrame& frame) noexcept = 0;
  /// A batch is about to be sent.
  virtual void note_sending() noexcept {}
  /// `sent` of `wanted` frames left; if not all, errno is the reason.
  virtual void note_sent(int sent, int wanted) noexcept = 0;
  /// Receiving failed, errno is the reason. True: frames may wait behind the error, read on.
  virtual bool note_receive_error() noexcept = 0;

  bool fd_;
  Stamps stamps_;
  FileDescriptor receiver_;
  FileDescriptor sender_;  ///< the receiver's if not open
  SendBatch outgoing_;
  ReceiveBatch incoming_;
  CanStatistics statistics_;

 private:
  int flush() noexcept;
  bool accept(int i, CanFrame* frame) noexcept;
};

}  // namespace limber
