// A CAN bus for programs in C99 (and C++11): an interface of SocketCAN, or the simulator of amiroctl. For models
// that a tool such as Simulink has made code of, and for programs in C. Beside the header that
// `amiroctl generate c` makes this is all that a program needs.
//
//     ocm_client bus;
//     if (ocm_client_open(&bus, "can0", 2000) < 0) { fputs(bus.why, stderr); return 1; }
//     amiro_frame frame = amiro_publish_every(AMIRO_GYROSCOPE_ID, 50, AMIRO_MILLISECONDS, AMIRO_MEDIUM);
//     ocm_client_send(&bus, frame.id, frame.dlc, frame.data, 100);
//     while (ocm_client_receive_base(&bus, &frame.id, &frame.dlc, frame.data, 100) >= 0) ...
//     ocm_client_close(&bus);
//
// Linux. No heap, no thread, no global variable; a client is some 12 KB and of one thread. Nothing waits longer
// than its time-out, but a signal handler may make a wait shorter. docs/c-client.md has a whole model.
#ifndef OCM_C_CLIENT_H
#define OCM_C_CLIENT_H

#ifndef _GNU_SOURCE
#error "define _GNU_SOURCE before the first include: this is for Linux"
#endif

#include <errno.h>
#include <fcntl.h>
#include <linux/can.h>
#include <linux/can/raw.h>
#include <net/if.h>
#include <poll.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/types.h>
#include <sys/un.h>
#include <time.h>
#include <unistd.h>

#ifdef __cplusplus
extern "C" {
#endif

// Frames that are kept for a program that sends and does not receive. What comes beyond is counted.
#ifndef OCM_CLIENT_INBOX
#define OCM_CLIENT_INBOX 256
#endif

// In the identifier of a frame, as in linux/can.h: it has 29 bits; it is a remote frame.
#define OCM_CLIENT_EXTENDED 0x80000000u
#define OCM_CLIENT_REMOTE 0x40000000u

// What functions return in place of 0 (time is up) and 1 (done). `why` says it in words.
#define OCM_CLIENT_GONE (-1)       // the bus is closed, or could not be opened
#define OCM_CLIENT_BAD_FRAME (-2)  // no such frame can exist

typedef struct ocm_client_frame {
  uint32_t id;  // with the bits above
  uint8_t dlc;
  uint8_t data[8];
  int64_t time_ns;  // Unix time of its end, by the bus
} ocm_client_frame;

typedef struct ocm_client {
  int socket;     // to poll for input, after a receive with a time of 0 has returned 0
  int simulated;  // 1: the simulator
  char why[200];  // after a failure, what is wrong
  uint64_t sent, received;
  uint64_t lost;        // frames that were on the bus, and did not reach this program in time
  uint64_t left_out;    // frames of 29 bits, and remote ones, while _base() was asked
  uint32_t bit_rate;    // of the simulated bus; 0: not known
  // Its own:
  uint64_t credit_, granted_;
  uint32_t overflow_;
  uint32_t first_, count_;
  ocm_client_frame inbox_[OCM_CLIENT_INBOX];
} ocm_client;

// --- the simulator's protocol: docs/virtual-bus.md ---

enum {
  OCM_CLIENT_RECORD = 32,
  OCM_CLIENT_MESSAGE = 32 * 128,
  OCM_CLIENT_VERSION = 1,
  OCM_CLIENT_HELLO = 1,
  OCM_CLIENT_FRAME = 2,
  OCM_CLIENT_CREDIT = 3,
  OCM_CLIENT_OVERRUN = 4,
  OCM_CLIENT_GOODBYE = 7
};
#define OCM_CLIENT_MAGIC 0x6D636F62u

static inline void ocm_client_put32_(uint8_t* at, uint32_t number) { memcpy(at, &number, sizeof number); }
static inline uint32_t ocm_client_get32_(const uint8_t* at) {
  uint32_t number;
  memcpy(&number, at, sizeof number);
  return number;
}
static inline uint64_t ocm_client_get64_(const uint8_t* at) {
  uint64_t number;
  memcpy(&number, at, sizeof number);
  return number;
}

// --- time ---

static inline int64_t ocm_client_now_ms_(void) {
  struct timespec now;
  clock_gettime(CLOCK_MONOTONIC, &now);
  return (int64_t)now.tv_sec * 1000 + now.tv_nsec / 1000000;
}
// Until the socket is ready or time is up; 0: it is up, or a signal came.
static inline int ocm_client_wait_(const ocm_client* client, short what, int64_t until_ms) {
  struct pollfd entry;
  const int64_t left = until_ms - ocm_client_now_ms_();
  entry.fd = client->socket;
  entry.events = what;
  entry.revents = 0;
  return poll(&entry, 1, left > 0 ? (int)left : 0) > 0;
}

// --- what comes ---

static inline int ocm_client_fail_(ocm_client* client, const char* what, const char* detail) {
  snprintf(client->why, sizeof client->why, "%s%s%s", what, detail[0] != '\0' ? ": " : "", detail);
  if (client->socket >= 0) close(client->socket);
  client->socket = -1;
  return OCM_CLIENT_GONE;
}

static inline void ocm_client_keep_(ocm_client* client, const ocm_client_frame* frame) {
  if (client->count_ == OCM_CLIENT_INBOX) {
    ++client->lost;
    return;
  }
  client->inbox_[(client->first_ + client->count_++) % OCM_CLIENT_INBOX] = *frame;
}

// One record from the simulator. 0, or OCM_CLIENT_GONE.
static inline int ocm_client_take_record_(ocm_client* client, const uint8_t* record) {
  ocm_client_frame frame;
  char detail[40];
  const int greeted = client->bit_rate != 0;
  if (record[0] != OCM_CLIENT_GOODBYE && greeted == (record[0] == OCM_CLIENT_HELLO))
    return ocm_client_fail_(client, "the simulator speaks another protocol", "");
  switch (record[0]) {
    case OCM_CLIENT_HELLO:
      if (ocm_client_get32_(record + 4) != OCM_CLIENT_MAGIC || ocm_client_get32_(record + 8) != OCM_CLIENT_VERSION ||
          ocm_client_get32_(record + 12) == 0)
        return ocm_client_fail_(client, "the simulator speaks another protocol", "");
      client->bit_rate = ocm_client_get32_(record + 12);
      client->credit_ = client->granted_ = ocm_client_get32_(record + 16);
      return 0;
    case OCM_CLIENT_FRAME:
      if (record[1] > 4 || record[2] > 8) return ocm_client_fail_(client, "the simulator sent no frame", "");
      if (record[1] == 4) return 0;  // an error frame
      memset(&frame, 0, sizeof frame);
      frame.id = ocm_client_get32_(record + 4);
      if ((record[1] & 1) != 0) frame.id |= OCM_CLIENT_EXTENDED;
      if ((record[1] & 2) != 0) frame.id |= OCM_CLIENT_REMOTE;
      frame.dlc = record[2];
      frame.time_ns = (int64_t)ocm_client_get64_(record + 8);
      if ((record[1] & 2) == 0) memcpy(frame.data, record + 16, frame.dlc);
      ocm_client_keep_(client, &frame);
      return 0;
    case OCM_CLIENT_CREDIT:
      client->credit_ += ocm_client_get64_(record + 8);
      return 0;
    case OCM_CLIENT_OVERRUN:
      client->lost += ocm_client_get64_(record + 8);
      return 0;
    case OCM_CLIENT_GOODBYE:
      snprintf(detail, sizeof detail, "reason %d", record[1]);
      return ocm_client_fail_(client, "the simulator has ended or disconnected this program", detail);
    default:
      return ocm_client_fail_(client, "the simulator speaks another protocol", "");
  }
}

// Reads one message that waits. 1: there was one, 0: none, or OCM_CLIENT_GONE.
static inline int ocm_client_fill_simulated_(ocm_client* client) {
  uint8_t message[OCM_CLIENT_MESSAGE];
  ssize_t size, at;
  do
    size = recv(client->socket, message, sizeof message, MSG_DONTWAIT);
  while (size < 0 && (errno == EINTR || errno == ECONNRESET));
  if (size < 0 && (errno == EAGAIN || errno == EWOULDBLOCK)) return 0;
  if (size <= 0) return ocm_client_fail_(client, "the simulator is gone", "");
  for (at = 0; at + OCM_CLIENT_RECORD <= size; at += OCM_CLIENT_RECORD)
    if (ocm_client_take_record_(client, message + at) < 0) return OCM_CLIENT_GONE;
  return 1;
}

static inline int ocm_client_fill_interface_(ocm_client* client) {
  struct can_frame raw;
  ocm_client_frame frame;
  struct iovec place;
  struct msghdr header;
  struct cmsghdr* extra;
  union {
    struct cmsghdr align;
    char bytes[256];
  } control;
  ssize_t size;
  memset(&header, 0, sizeof header);
  memset(&frame, 0, sizeof frame);
  place.iov_base = &raw;
  place.iov_len = sizeof raw;
  header.msg_iov = &place;
  header.msg_iovlen = 1;
  header.msg_control = control.bytes;
  header.msg_controllen = sizeof control.bytes;
  do
    size = recvmsg(client->socket, &header, MSG_DONTWAIT);
  while (size < 0 && errno == EINTR);
  if (size < 0 && (errno == EAGAIN || errno == EWOULDBLOCK || errno == ENETDOWN)) return 0;
  if (size < 0) return ocm_client_fail_(client, "the CAN interface is gone", strerror(errno));
  if (size != (ssize_t)sizeof raw || raw.can_dlc > 8) return 1;
  for (extra = CMSG_FIRSTHDR(&header); extra != NULL; extra = CMSG_NXTHDR(&header, extra)) {
    if (extra->cmsg_level != SOL_SOCKET) continue;
    if (extra->cmsg_type == SO_RXQ_OVFL) {
      uint32_t dropped;  // since the socket was opened; it wraps
      memcpy(&dropped, CMSG_DATA(extra), sizeof dropped);
      client->lost += dropped - client->overflow_;
      client->overflow_ = dropped;
    } else if (extra->cmsg_type == SO_TIMESTAMPNS) {
      struct timespec time;
      memcpy(&time, CMSG_DATA(extra), sizeof time);
      frame.time_ns = (int64_t)time.tv_sec * 1000000000 + time.tv_nsec;
    }
  }
  frame.id = raw.can_id;
  frame.dlc = raw.can_dlc;
  if ((raw.can_id & CAN_RTR_FLAG) == 0) memcpy(frame.data, raw.data, raw.can_dlc);
  ocm_client_keep_(client, &frame);
  return 1;
}

static inline int ocm_client_fill_(ocm_client* client) {
  return client->simulated ? ocm_client_fill_simulated_(client) : ocm_client_fill_interface_(client);
}

// --- open and close ---

static inline int ocm_client_open_simulated_(ocm_client* client, const char* path, int64_t until_ms) {
  struct sockaddr_un address;
  struct stat status;
  struct ucred peer;
  socklen_t peer_size = sizeof peer;
  uint8_t hello[OCM_CLIENT_RECORD];
  const char* const runtime = getenv("XDG_RUNTIME_DIR");
  int length;
  memset(&address, 0, sizeof address);
  address.sun_family = AF_UNIX;
  if (path[0] != '\0')
    length = snprintf(address.sun_path, sizeof address.sun_path, "%s", path);
  else if (runtime != NULL && runtime[0] == '/' && stat(runtime, &status) == 0 && S_ISDIR(status.st_mode) &&
           status.st_uid == geteuid())
    length = snprintf(address.sun_path, sizeof address.sun_path, "%s/ocm/sim.sock", runtime);
  else
    length = snprintf(address.sun_path, sizeof address.sun_path, "/tmp/ocm-%lu/sim.sock", (unsigned long)geteuid());
  if (length < 0 || (size_t)length >= sizeof address.sun_path)
    return ocm_client_fail_(client, "no socket can have this path", path);
  client->simulated = 1;
  client->socket = socket(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);
  if (client->socket < 0) return ocm_client_fail_(client, "no socket", strerror(errno));
  if (connect(client->socket, (const struct sockaddr*)&address, sizeof address) < 0)
    return ocm_client_fail_(client, errno == EAGAIN ? "the simulator takes no program now: try again" : "no simulator is running",
                            strerror(errno));
  if (getsockopt(client->socket, SOL_SOCKET, SO_PEERCRED, &peer, &peer_size) < 0 || peer.uid != geteuid())
    return ocm_client_fail_(client, "the simulator belongs to another user", "");
  memset(hello, 0, sizeof hello);
  hello[0] = OCM_CLIENT_HELLO;
  ocm_client_put32_(hello + 4, OCM_CLIENT_MAGIC);
  ocm_client_put32_(hello + 8, OCM_CLIENT_VERSION);
  if (send(client->socket, hello, sizeof hello, MSG_NOSIGNAL) < 0)
    return ocm_client_fail_(client, "the simulator is gone", strerror(errno));
  while (client->bit_rate == 0) {
    const int filled = ocm_client_fill_simulated_(client);
    if (filled < 0) return filled;
    if (filled == 0 && !ocm_client_wait_(client, POLLIN, until_ms) && ocm_client_now_ms_() >= until_ms)
      return ocm_client_fail_(client, "the simulator does not answer", "is it stopped?");
  }
  return 1;
}

static inline int ocm_client_open_interface_(ocm_client* client, const char* name) {
  struct sockaddr_can address;
  const int on = 1;
  memset(&address, 0, sizeof address);
  address.can_family = AF_CAN;
  address.can_ifindex = (int)if_nametoindex(name);
  if (address.can_ifindex == 0) return ocm_client_fail_(client, "no such interface", name);
  client->socket = socket(PF_CAN, SOCK_RAW | SOCK_CLOEXEC | SOCK_NONBLOCK, CAN_RAW);
  if (client->socket < 0) return ocm_client_fail_(client, "no CAN in this kernel", strerror(errno));
  setsockopt(client->socket, SOL_SOCKET, SO_RXQ_OVFL, &on, sizeof on);
  setsockopt(client->socket, SOL_SOCKET, SO_TIMESTAMPNS, &on, sizeof on);
  if (bind(client->socket, (const struct sockaddr*)&address, sizeof address) < 0)
    return ocm_client_fail_(client, "no CAN interface", name);
  return 1;
}

// "can0"; "sim", the simulator of this user; "sim:PATH". 1, or OCM_CLIENT_GONE.
static inline int ocm_client_open(ocm_client* client, const char* bus, int timeout_ms) {
  memset(client, 0, sizeof *client);
  client->socket = -1;
  if (strcmp(bus, "sim") == 0)
    return ocm_client_open_simulated_(client, "", ocm_client_now_ms_() + timeout_ms);
  if (strncmp(bus, "sim:", 4) == 0)
    return ocm_client_open_simulated_(client, bus + 4, ocm_client_now_ms_() + timeout_ms);
  return ocm_client_open_interface_(client, bus);
}

// What was sent still leaves.
static inline void ocm_client_close(ocm_client* client) {
  uint8_t goodbye[OCM_CLIENT_RECORD];
  if (client->socket >= 0 && client->simulated) {
    memset(goodbye, 0, sizeof goodbye);
    goodbye[0] = OCM_CLIENT_GOODBYE;
    ocm_client_put32_(goodbye + 4, OCM_CLIENT_VERSION);
    if (send(client->socket, goodbye, sizeof goodbye, MSG_NOSIGNAL) < 0 &&
        ocm_client_wait_(client, POLLOUT, ocm_client_now_ms_() + 100))
      (void)!send(client->socket, goodbye, sizeof goodbye, MSG_NOSIGNAL);
  }
  if (client->socket >= 0) close(client->socket);
  client->socket = -1;
}

// --- frames ---

// 1: the bus has taken it. 0: it had no room for so long. Or OCM_CLIENT_GONE, OCM_CLIENT_BAD_FRAME.
static inline int ocm_client_send(ocm_client* client, uint32_t id, uint8_t dlc, const uint8_t data[8], int timeout_ms) {
  const int64_t until_ms = ocm_client_now_ms_() + timeout_ms;
  const uint32_t number = id & ~(OCM_CLIENT_EXTENDED | OCM_CLIENT_REMOTE);
  const int extended = (id & OCM_CLIENT_EXTENDED) != 0, remote = (id & OCM_CLIENT_REMOTE) != 0;
  uint8_t record[OCM_CLIENT_RECORD];
  struct can_frame raw;
  if (client->socket < 0) return OCM_CLIENT_GONE;
  if (dlc > 8 || number > (extended ? CAN_EFF_MASK : CAN_SFF_MASK)) {
    snprintf(client->why, sizeof client->why, "no frame has identifier %lX and %d bytes", (unsigned long)number, dlc);
    return OCM_CLIENT_BAD_FRAME;
  }
  memset(record, 0, sizeof record);
  record[0] = OCM_CLIENT_FRAME;
  record[1] = (uint8_t)((extended ? 1 : 0) | (remote ? 2 : 0));
  record[2] = dlc;
  ocm_client_put32_(record + 4, number);
  memset(&raw, 0, sizeof raw);
  raw.can_id = id;
  raw.can_dlc = dlc;
  if (!remote) {
    memcpy(record + 16, data, dlc);
    memcpy(raw.data, data, dlc);
  }
  for (;;) {
    if (client->simulated) {
      while (client->credit_ == 0) {
        const int filled = ocm_client_fill_simulated_(client);
        if (filled < 0) return filled;
        if (filled == 0) break;
      }
      if (client->credit_ != 0) {
        if (send(client->socket, record, sizeof record, MSG_NOSIGNAL) >= 0) {
          --client->credit_;
          ++client->sent;
          return 1;
        }
        if (errno != EAGAIN && errno != ENOBUFS && errno != ENOMEM && errno != EINTR)
          return ocm_client_fail_(client, "the simulator is gone", strerror(errno));
      }
      if (ocm_client_now_ms_() >= until_ms) return 0;
      ocm_client_wait_(client, client->credit_ == 0 ? POLLIN : POLLOUT, until_ms);
      continue;
    }
    if (write(client->socket, &raw, sizeof raw) == (ssize_t)sizeof raw) {
      ++client->sent;
      return 1;
    }
    if (errno != EAGAIN && errno != ENOBUFS && errno != ENOMEM && errno != ENETDOWN && errno != EINTR)
      return ocm_client_fail_(client, "the CAN interface is gone", strerror(errno));
    if (ocm_client_now_ms_() >= until_ms) return 0;
    poll(NULL, 0, 1);  // nothing tells when a transmit queue has room
  }
}

// 1: a frame. 0: none came for so long, or a signal came. Or OCM_CLIENT_GONE, once all that waited was received.
static inline int ocm_client_receive(ocm_client* client, ocm_client_frame* frame, int timeout_ms) {
  const int64_t until_ms = ocm_client_now_ms_() + timeout_ms;
  for (;;) {
    if (client->count_ != 0) {
      *frame = client->inbox_[client->first_];
      client->first_ = (client->first_ + 1) % OCM_CLIENT_INBOX;
      --client->count_;
      ++client->received;
      return 1;
    }
    if (client->socket < 0) return OCM_CLIENT_GONE;
    const int filled = ocm_client_fill_(client);
    if (filled < 0 && client->count_ == 0) return filled;
    if (filled == 0 && !ocm_client_wait_(client, POLLIN, until_ms)) return 0;
  }
}

// The same of data frames with identifiers of 11 bits, into the members of a generated frame.
static inline int ocm_client_receive_base(ocm_client* client, uint16_t* id, uint8_t* dlc, uint8_t data[8],
                                          int timeout_ms) {
  const int64_t until_ms = ocm_client_now_ms_() + timeout_ms;
  ocm_client_frame frame;
  for (;;) {
    const int64_t left = until_ms - ocm_client_now_ms_();
    const int received = ocm_client_receive(client, &frame, left > 0 ? (int)left : 0);
    if (received <= 0) return received;
    if (frame.id <= CAN_SFF_MASK) {
      *id = (uint16_t)frame.id;
      *dlc = frame.dlc;
      memcpy(data, frame.data, sizeof frame.data);
      return 1;
    }
    ++client->left_out;
  }
}

#ifdef __cplusplus
}
#endif

#endif  // OCM_C_CLIENT_H
