/// A CAN interface of Linux, as a recorder sees it: one CAN_RAW socket that takes CAN FD frames too and knows
/// which frames this machine has sent. Up to 64 frames a system call.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <linux/can.h>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <sys/socket.h>
#include <sys/uio.h>
#include <time.h>

#include "ocm/host/descriptor.hpp"
#include "ocm/log/entry.hpp"
#include "ocm/transport/socketcan.hpp"

#include "cli/record/capture.hpp"

namespace ocm::cli::record {

class CanCapture final : public Capture {
 public:
  [[nodiscard]] static transport::Outcome<std::unique_ptr<Capture>> open(std::string_view name,
                                                                         const Filters& filters);
  /// Of a raw socket that is bound to the interface of this index.
  [[nodiscard]] static std::unique_ptr<CanCapture> of(host::Descriptor socket, std::string_view name,
                                                      int index);

  [[nodiscard]] std::size_t read(std::span<log::Entry> into, std::uint16_t interface) override;
  void look() override;

  [[nodiscard]] std::string_view name() const override { return name_; }
  [[nodiscard]] int descriptor() const override { return socket_.get(); }
  [[nodiscard]] transport::BusState state() const override { return state_; }
  [[nodiscard]] const transport::Failure& failure() const override { return failure_; }
  [[nodiscard]] std::uint64_t lost() const override { return lost_; }
  [[nodiscard]] std::uint32_t bit_rate() const override { return bit_rate_; }
  [[nodiscard]] bool keeps_times() const override { return true; }
  [[nodiscard]] bool may_return() const override { return true; }

 private:
  /// Where recvmmsg puts one frame and what comes with it.
  struct Slot {
    canfd_frame frame{};
    iovec place{};
    alignas(cmsghdr)
        std::array<std::byte, CMSG_SPACE(sizeof(timespec)) + CMSG_SPACE(sizeof(std::uint32_t))> control{};
  };

  /// Errors of the socket in a row: down, and gone, each reported once, and one more.
  static constexpr int most_errors = 4;

  explicit CanCapture(std::string_view name);
  void read_control(msghdr& message, log::Entry& entry);
  [[nodiscard]] int receive(std::size_t room);
  void count_drops();
  [[nodiscard]] bool frames_wait() const;
  void close();

  host::Descriptor socket_;
  std::string name_;
  int index_ = 0;
  std::uint32_t bit_rate_ = 0;
  transport::BusState state_ = transport::BusState::up;
  int leaving_ = 0;  ///< the error after which it is closed, once no frame waits any more
  transport::Failure failure_;
  std::uint64_t lost_ = 0;
  transport::detail::DropCounter drops_;
  std::array<Slot, batch> slots_{};
  std::array<mmsghdr, batch> messages_{};
};

}  // namespace ocm::cli::record
