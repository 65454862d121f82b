// What is written to a file as a log, and what becomes of it where the file takes no more.
#include "cli/logs/log_file.hpp"

#include <array>
#include <cerrno>
#include <chrono>
#include <climits>
#include <csignal>
#include <cstddef>
#include <cstdio>
#include <cstdlib>
#include <fcntl.h>
#include <filesystem>
#include <fstream>
#include <functional>
#include <memory>
#include <new>
#include <span>
#include <sstream>
#include <string>
#include <string_view>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <sys/time.h>
#include <unistd.h>
#include <utility>
#include <vector>

#include <catch2/catch.hpp>

#include "ocm/topics/amiro.hpp"

#include "cli/shared/interrupt.hpp"
#include "cli/shared/messages.hpp"
#include "tool/written_pieces.hpp"
#include "unit/host/host_testing.hpp"

namespace tool_output_log_file_test {

using namespace ocm;
using cli::logs::Existing;
using cli::logs::LogFile;
namespace fs = std::filesystem;

constexpr const char* nothing_kept = "nothing of it was kept";
constexpr const char* can_be_read = "what was written before can be read";
/// What `write` makes.
constexpr std::string_view one_line = "(1000000000.000000) can0 123#00\n";

using Folder = test::TemporaryDirectory;

/// How large files may become while it lives; a write beyond that fails.
class Limited {
 public:
  explicit Limited(std::size_t bytes) : handler_(std::signal(SIGXFSZ, SIG_IGN)) {
    ::getrlimit(RLIMIT_FSIZE, &before_);
    rlimit limit = before_;
    limit.rlim_cur = bytes;
    ::setrlimit(RLIMIT_FSIZE, &limit);
  }
  ~Limited() {
    ::setrlimit(RLIMIT_FSIZE, &before_);
    std::signal(SIGXFSZ, handler_);
  }
  Limited(const Limited&) = delete;
  Limited& operator=(const Limited&) = delete;

 private:
  void (*handler_)(int);
  rlimit before_{};
};

/// A disk that gives none of the room that it is asked for while it lives, and why. It takes what is written
/// all the same.
class WithoutRoom {
 public:
  static inline int error = 0;
  explicit WithoutRoom(int why) { error = why; }
  ~WithoutRoom() { error = 0; }
  WithoutRoom(const WithoutRoom&) = delete;
  WithoutRoom& operator=(const WithoutRoom&) = delete;
};

std::unique_ptr<LogFile> created(const std::string& path, Existing existing = Existing::refuse) {
  auto made = LogFile::create(path, *cli::logs::find_format("candump"), amiro::catalogue, existing);
  INFO(made.error.what);
  REQUIRE(made);
  return std::move(*made);
}

bool write(LogFile& file) {
  log::Interfaces interfaces;
  interfaces.number("can0");
  const std::array entries{
      log::Entry{base::Time{std::chrono::seconds{1'000'000'000}}, can::Frame{0x123, 1, {}}}};
  return file.write(entries, interfaces);
}

std::string content(const std::string& path) {
  std::ostringstream text;
  text << std::ifstream{path, std::ios::binary}.rdbuf();
  return text.str();
}

/// Which descriptor the next file gets.
int next_descriptor() {
  const int free = ::open("/dev/null", O_RDONLY | O_CLOEXEC);
  ::close(free);
  return free;
}

TEST_CASE("log file: what was there goes where the new log may be as large, and stays where it may not") {
  const Folder folder;
  const std::string path = folder.file("a.log");
  const auto overwrite = [&](std::size_t most) {
    std::ofstream{path} << "old";
    const auto file = created(path, Existing::overwrite);
    const Limited limited{most};
    return write(*file) && file->finish();
  };
  CHECK(overwrite(one_line.size()));
  CHECK(content(path) == one_line);
  CHECK(overwrite(one_line.size() + 1));
  CHECK(content(path) == one_line);
  CHECK_FALSE(overwrite(one_line.size() - 1));
  CHECK(content(path) == "old");
}

TEST_CASE("log file: of a file that takes no more it is said whether anything is in it") {
  const Folder folder;
  {
    const auto file = created("/dev/full");
    CHECK(write(*file));
    CHECK_FALSE(file->flush());
    CHECK(file->failure().what == "cannot write /dev/full: No space left on device");
    CHECK(file->failure().remedy == std::string{"free some space; "} + nothing_kept);
    CHECK_FALSE(file->finish());
  }
  {
    const std::string path = folder.file("nothing.log");
    const auto file = created(path);
    bool taken = false, finished = false;
    {
      const Limited limited{0};
      taken = write(*file);
      finished = file->finish();
    }
    CHECK(taken);
    CHECK_FALSE(finished);
    CHECK(file->failure().what == "cannot write " + path + ": File too large");
    CHECK(file->failure().remedy == nothing_kept);
    CHECK_FALSE(fs::exists(path));  // the next try finds the name free
  }
  for (const std::size_t room : {one_line.size(), 2 * one_line.size() - 1}) {
    const std::string path = folder.file("some" + std::to_string(room) + ".log");
    const auto file = created(path);
    bool first = false, second = false;
    {
      const Limited limited{room};
      first = write(*file) && file->flush();
      second = write(*file) && file->flush();
    }
    CHECK(first);
    CHECK_FALSE(second);
    CHECK(file->size() == one_line.size());
    CHECK(file->failure().remedy == can_be_read);
    CHECK_FALSE(file->finish());
    CHECK(content(path) == one_line);  // a whole record
  }
}

TEST_CASE("log file: one that is finished is left alone, also what has its descriptor now") {
  const Folder folder;
  const std::string first = folder.file("first.log"), second = folder.file("second.log");
  auto file = created(first);
  CHECK(file->finish());
  CHECK(file->finish());  // it is
  const auto other = created(second);
  file.reset();
  CHECK(write(*other));
  CHECK(other->finish());
  CHECK(content(second) == one_line);
  CHECK(fs::exists(first));
  CHECK(content(first).empty());
}

TEST_CASE("log file: it is written to as a file that blocks, a pipe too") {
  const Folder folder;
  // Far from the numbers that fcntl has for what it does.
  const int low = ::open("/dev/null", O_RDONLY | O_CLOEXEC);
  const int high = ::fcntl(low, F_DUPFD_CLOEXEC, 100);
  REQUIRE(high >= 100);
  std::vector<int> filled;
  while (next_descriptor() < high) {
    filled.push_back(::open("/dev/null", O_RDONLY | O_CLOEXEC));
    REQUIRE(filled.back() >= 0);
  }
  const std::string pipe = folder.file("pipe"), plain = folder.file("plain.log");
  REQUIRE(::mkfifo(pipe.c_str(), 0600) == 0);
  const int reader = ::open(pipe.c_str(), O_RDONLY | O_NONBLOCK | O_CLOEXEC);
  std::ofstream{plain} << "old";
  for (const auto& path : {pipe, plain}) {
    const int descriptor = next_descriptor();
    const auto file = created(path, Existing::overwrite);
    CHECK((::fcntl(descriptor, F_GETFL) & (O_ACCMODE | O_NONBLOCK | O_APPEND | O_ASYNC)) == O_WRONLY);
    CHECK(write(*file));
    CHECK(file->finish());
  }
  std::array<char, 100> text{};
  CHECK(::read(reader, text.data(), text.size()) == static_cast<ssize_t>(one_line.size()));
  CHECK(content(plain) == one_line);
  for (const int each : {low, high, reader}) ::close(each);
  for (const int each : filled) ::close(each);
}

TEST_CASE("log file: a file that another one writes is refused, and no other, whatever failed before") {
  const Folder folder;
  const std::string path = folder.file("a.log");
  {
    errno = EWOULDBLOCK;
    const auto file = created(path);
    CHECK(cli::logs::is_being_written(path));
    for (const auto existing : {Existing::refuse, Existing::overwrite, Existing::claimed}) {
      const auto again =
          LogFile::create(path, *cli::logs::find_format("candump"), amiro::catalogue, existing);
      REQUIRE_FALSE(again);
      CHECK(again.error.what == "another program writes " + path + " now");
      CHECK(again.error.remedy == "end it, or give another name");
    }
    CHECK(write(*file));
    CHECK(file->finish());
  }
  errno = EWOULDBLOCK;
  CHECK_FALSE(cli::logs::is_being_written(path));
  const auto there =
      LogFile::create(path, *cli::logs::find_format("candump"), amiro::catalogue, Existing::refuse);
  REQUIRE_FALSE(there);
  CHECK(there.error.what == path + " is there already");
  CHECK_FALSE(cli::logs::is_being_written(path));  // who was refused does not keep it
  CHECK(content(path) == one_line);
}

TEST_CASE("log file: it is where its name is, or elsewhere, deleted or emptied") {
  using cli::logs::Place;
  const Folder folder;
  const std::string path = folder.file("a.log"), other = folder.file("b.log");
  const auto file = created(path);
  CHECK(file->place() == Place::as_named);
  CHECK(write(*file));
  CHECK(file->flush());
  CHECK(file->place() == Place::as_named);
  fs::rename(path, other);
  CHECK(file->place() == Place::elsewhere);
  std::ofstream{path} << "another file";
  CHECK(file->place() == Place::elsewhere);
  fs::rename(other, path);
  CHECK(file->place() == Place::as_named);
  fs::resize_file(path, one_line.size() - 1);
  CHECK(file->place() == Place::emptied);
  fs::remove(path);
  CHECK(file->place() == Place::deleted);
  CHECK(file->finish());
  CHECK(created("/dev/null")->place() == Place::as_named);
}

TEST_CASE("log file: one that took nothing is deleted, and no other that has its name now") {
  const Folder folder;
  const std::string path = folder.file("a.log"), other = folder.file("b.log");
  {
    const auto file = created(path);
    CHECK(file->discard());
    CHECK_FALSE(fs::exists(path));
  }
  {
    const auto file = created(path);
    fs::rename(path, other);
    std::ofstream{path} << "another file";
    CHECK(file->discard());
  }
  CHECK(content(path) == "another file");
  CHECK(content(other).empty());
  CHECK(created(path, Existing::overwrite)->discard());  // as it was before
  CHECK(content(path) == "another file");
  {
    const auto file = created(other, Existing::claimed);
    CHECK(file->discard());
    CHECK_FALSE(fs::exists(other));
  }
}

TEST_CASE("log file: whether the disk has room is asked, and none is taken") {
  const Folder folder;
  const std::string path = folder.file("a.log");
  const auto file = created(path);
  CHECK(write(*file));
  CHECK(file->flush());
  const auto blocks = [&path] {
    struct stat status {};
    REQUIRE(::stat(path.c_str(), &status) == 0);
    return status.st_blocks;
  };
  const auto before = blocks();
  CHECK(file->has_room());
  CHECK(blocks() - before < 256);  // of 512 bytes, and it was asked for 256 KiB
  CHECK(file->finish());
  CHECK(content(path) == one_line);
}

/// A writer whose memory may run out in the middle of what it appends.
class Hungry final : public log::Writer {
 public:
  static inline bool has_memory = true;
  void write(log::Bytes& out, std::span<const log::Entry>, const log::Interfaces&) override {
    append(out, "written\n");
  }
  void flush(log::Bytes& out) override { append(out, "flushed\n"); }
  void recorded(log::Bytes& out, std::span<const log::Recorded>) override { append(out, "recorded\n"); }
  void finish(log::Bytes& out) override { append(out, "finished\n"); }

 private:
  static void append(log::Bytes& out, std::string_view text) {
    out.append(text.substr(0, 3));
    if (!has_memory) throw std::bad_alloc{};
    out.append(text.substr(3));
  }
};

std::unique_ptr<log::Writer> make_hungry(const protocol::Catalogue&) {
  return std::make_unique<Hungry>();
}

TEST_CASE("log file: where memory runs out, what was whole before is written, and no more is taken") {
  const Folder folder;
  const std::string path = folder.file("a.hungry");
  const cli::logs::LogFormat format{"hungry", ".hungry", "", nullptr, nullptr, make_hungry};
  const log::Interfaces interfaces{};
  const auto fresh = [&] {
    auto made = LogFile::create(path, format, amiro::catalogue, Existing::overwrite);
    REQUIRE(made);
    return std::move(*made);
  };
  const std::function<bool(LogFile&)> writes = [&](LogFile& file) { return file.write({}, interfaces); };
  const std::function<bool(LogFile&)> records = [](LogFile& file) { return file.recorded({}); };
  const std::function<bool(LogFile&)> flushes = [](LogFile& file) { return file.flush(); };
  const std::function<bool(LogFile&)> finishes = [](LogFile& file) { return file.finish(); };
  for (const auto& act : {writes, records, flushes, finishes}) {
    const auto file = fresh();
    CHECK(writes(*file));
    Hungry::has_memory = false;
    CHECK_THROWS_AS(act(*file), std::bad_alloc);
    Hungry::has_memory = true;
    for (const auto& later : {writes, records, flushes}) CHECK_THROWS_AS(later(*file), std::bad_alloc);
    CHECK(file->finish());
    CHECK(content(path) == "written\n");
  }
  {
    const auto file = fresh();
    CHECK(writes(*file));
    CHECK(records(*file));
    CHECK(flushes(*file));
    CHECK(content(path) == "written\nrecorded\nflushed\n");
    CHECK(file->finish());
  }
  CHECK(content(path) == "written\nrecorded\nflushed\nfinished\n");
}

TEST_CASE("log file: what another program has cut off stays so where nothing more is taken") {
  const Folder folder;
  const std::string path = folder.file("a.log");
  const auto file = created(path);
  CHECK(write(*file));
  CHECK(file->flush());
  fs::resize_file(path, 3);
  bool taken = true;
  {
    const Limited limited{one_line.size()};
    taken = write(*file) && file->flush();
  }
  CHECK_FALSE(taken);
  CHECK(content(path) == one_line.substr(0, 3));
  CHECK_FALSE(file->finish());
}

TEST_CASE(
    "log file: of a longer file that it takes the place of nothing is left, and what it wrote itself stays") {
  const Folder folder;
  const std::string path = folder.file("a.log"), old(1000, 'x');
  std::ofstream{path} << old;
  const auto file = created(path, Existing::overwrite);
  CHECK(write(*file));
  CHECK(content(path) == old);
  CHECK(file->flush());
  CHECK(content(path) == one_line);
  CHECK(write(*file));
  CHECK(file->finish());
  CHECK(content(path) == std::string{one_line} + std::string{one_line});
  CHECK(file->size() == 2 * one_line.size());
}

TEST_CASE("log file: what cannot be made is refused, and nothing is made behind a link") {
  const Folder folder;
  const auto refused = [](const std::string& path, std::string_view format, Existing existing) {
    const auto made = LogFile::create(path, *cli::logs::find_format(format), amiro::catalogue, existing);
    REQUIRE_FALSE(made);
    return made.error.what + "; " + made.error.remedy;
  };
  const std::string path = folder.file("a.log"), nowhere = folder.file("none/a.log"),
                    link = folder.file("link.log");
  CHECK(refused(path, "blf", Existing::refuse) == "blf is read only; --to names another format");
  CHECK_FALSE(fs::exists(path));
  CHECK(refused(nowhere, "candump", Existing::overwrite) ==
        "cannot write " + nowhere +
            ": No such file or directory; name a folder that exists and can be written to");
  fs::create_symlink(path, link);
  CHECK(refused(link, "candump", Existing::refuse) ==
        "cannot write " + link +
            ": No such file or directory; name a folder that exists and can be written to");
  CHECK_FALSE(fs::exists(path));
  {
    const auto file = created(link, Existing::overwrite);
    CHECK(write(*file));
    CHECK(file->finish());
  }
  CHECK(content(path) == one_line);
}

TEST_CASE("log file: a new one is opened once, whatever failed before") {
  const Folder folder;
  const std::string path = folder.file("a.log");
  const int descriptor = next_descriptor();
  errno = EEXIST;
  const auto file = created(path);
  CHECK(file->finish());
  CHECK(next_descriptor() == descriptor);
}

TEST_CASE("log file: a disk that is full has no room, and one that cannot say has some") {
  const Folder folder;
  const auto file = created(folder.file("a.log"));
  for (const int error : {ENOSPC, EDQUOT, EOPNOTSUPP, EINTR}) {
    CAPTURE(error);
    const WithoutRoom disk{error};
    CHECK(file->has_room() == (error != ENOSPC && error != EDQUOT));
  }
  const WithoutRoom disk{ENOSPC};
  CHECK(created("/dev/null")->has_room());  // it is on none
}

TEST_CASE("log file: what was there stays where the disk has no room for the new log; a new one is written") {
  const Folder folder;
  const std::string path = folder.file("a.log"), fresh = folder.file("b.log");
  std::ofstream{path} << "old";
  {
    const auto file = created(path, Existing::overwrite);
    CHECK(write(*file));
    const WithoutRoom disk{ENOSPC};
    CHECK_FALSE(file->finish());
    CHECK(file->failure().what == "cannot write " + path + ": No space left on device");
    CHECK(file->failure().remedy == std::string{"free some space; "} + nothing_kept);
  }
  CHECK(content(path) == "old");
  {
    const auto file = created(fresh);
    CHECK(write(*file));
    const WithoutRoom disk{ENOSPC};
    CHECK(file->finish());
  }
  CHECK(content(fresh) == one_line);
}

/// In which pieces a log of so many lines goes to the standard output, which keeps them apart.
std::vector<std::size_t> pieces(int lines, bool without_signals) {
  const test::WrittenPieces pieces;
  std::fflush(nullptr);
  const int kept = ::dup(STDOUT_FILENO);
  ::dup2(pieces.descriptor(), STDOUT_FILENO);
  bool whole = false;
  if (auto made =
          LogFile::create("-", *cli::logs::find_format("candump"), amiro::catalogue, Existing::refuse)) {
    LogFile& file = **made;
    if (without_signals) file.without_signals();
    whole = true;
    for (int i = 0; i < lines; ++i) whole = write(file) && whole;
    whole = file.finish() && whole;
  }
  ::dup2(kept, STDOUT_FILENO);
  ::close(kept);
  CHECK(whole);
  return pieces.sizes(static_cast<std::size_t>(lines) * one_line.size() + 1);
}

TEST_CASE("log file: a thread that no signal reaches writes to a pipe page by page, others all at once") {
  REQUIRE(cli::interrupted() == 0);
  const std::size_t size = 200 * one_line.size();
  CHECK(pieces(200, false) == std::vector<std::size_t>{size});
  CHECK(pieces(200, true) == std::vector<std::size_t>{PIPE_BUF, size - PIPE_BUF});
}

/// What becomes of a log in a process that a signal has reached, and reaches again each millisecond: the exit
/// code with which that ends; 0: it is made; 1: it is refused in words.
int behind_a_signal(const std::string& path) {
  return test::in_child([&path] {
    ::dup2(::open("/dev/null", O_WRONLY | O_CLOEXEC), STDERR_FILENO);  // what is waited for is said there
    cli::catch_interrupts();
    ::raise(SIGTERM);
    struct sigaction action {};
    action.sa_handler = [](int) { ::raise(SIGTERM); };
    ::sigaction(SIGALRM, &action, nullptr);
    const itimerval each_millisecond{{0, 1000}, {0, 1000}};
    ::setitimer(ITIMER_REAL, &each_millisecond, nullptr);
    try {
      const auto made =
          LogFile::create(path, *cli::logs::find_format("candump"), amiro::catalogue, Existing::refuse);
      return made ? 0 : 1;
    } catch (const cli::Exit& exit) {
      return exit.code;
    }
  });
}

TEST_CASE(
    "log file: a signal ends the wait for a pipe's reader, and what cannot be made is refused as ever") {
  const Folder folder;
  const std::string pipe = folder.file("pipe");
  REQUIRE(::mkfifo(pipe.c_str(), 0600) == 0);
  CHECK(behind_a_signal(pipe) == 128 + SIGTERM);
  CHECK(behind_a_signal(folder.file("none/a.log")) == 1);
  CHECK(behind_a_signal(folder.file("a.log")) == 0);
}

}  // namespace tool_output_log_file_test

// What is asked of the disk is answered here; its own answer comes from the kernel itself, as in
// tests/unit/transport/played_kernel.hpp.
extern "C" int fallocate(int file, int how, off_t from, off_t size) {
  using tool_output_log_file_test::WithoutRoom;
  if (WithoutRoom::error == 0) return static_cast<int>(::syscall(SYS_fallocate, file, how, from, size));
  errno = WithoutRoom::error;
  return -1;
}
