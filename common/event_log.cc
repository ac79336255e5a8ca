#include "common/event_log.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <sys/statvfs.h>
#include <unistd.h>
#include <zstd.h>

#include <array>
#include <cerrno>
#include <memory>
#include <stdexcept>
#include <system_error>

#include "common/config_error.h"

namespace limber {
namespace {

using std::chrono::milliseconds;

constexpr std::uint32_t kSyncWord = 0xEDA1DA01;
constexpr std::size_t kHeaderBytes = 28;
constexpr std::size_t kBlockBytes = 256U << 10U;
constexpr milliseconds kOldestBlock{250};
constexpr milliseconds kBetweenSyncs{1000};

void put(std::uint8_t*& to, std::uint64_t value, int bytes) {
  for (int i = bytes - 1; i >= 0; --i) *to++ = static_cast<std::uint8_t>(value >> (8 * i));
}

/// Nothing that is there already is overwritten, but a device such as /dev/null may be given.
int open_new(const std::string& path) {
  const int file = open(path.c_str(), O_CREAT | O_EXCL | O_WRONLY | O_CLOEXEC, 0644);
  if (file >= 0 || errno != EEXIST) return file;
  struct stat status {};
  if (stat(path.c_str(), &status) != 0 || S_ISREG(status.st_mode)) {
    throw ConfigError::at(
        path, 0, "",
        "exists already, and logs are not overwritten: give another name, or remove it");
  }
  return open(path.c_str(), O_WRONLY | O_CLOEXEC);
}

/// Makes a frame of a block.
class Compressor {
 public:
  Compressor() {
    ZSTD_CCtx_setParameter(context_.get(), ZSTD_c_checksumFlag, 1);
    // Higher levels take longer and find 1 % more in a log: what is left is noise of doubles.
    ZSTD_CCtx_setParameter(context_.get(), ZSTD_c_compressionLevel, 1);
  }

  const std::vector<std::uint8_t>& operator()(const std::vector<std::uint8_t>& block) {
    frame_.resize(ZSTD_compressBound(block.size()));
    const std::size_t size =
        ZSTD_compress2(context_.get(), frame_.data(), frame_.size(), block.data(), block.size());
    if (ZSTD_isError(size) != 0) throw std::runtime_error(ZSTD_getErrorName(size));
    frame_.resize(size);
    return frame_;
  }

 private:
  struct Free {
    void operator()(ZSTD_CCtx* context) const { ZSTD_freeCCtx(context); }
  };
  std::unique_ptr<ZSTD_CCtx, Free> context_{ZSTD_createCCtx()};
  std::vector<std::uint8_t> frame_;
};

std::string reason() { return std::generic_category().message(errno); }

}  // namespace

EventLog::EventLog(std::string path, std::int64_t least_free_bytes)
    : path_(std::move(path)),
      compressed_(path_.ends_with(".zst")),
      least_free_bytes_(least_free_bytes),
      file_(open_new(path_)) {
  if (file_.get() < 0) throw ConfigError::at(path_, 0, "", "cannot be written: " + reason());
  try {
    check_free_space();
  } catch (const std::runtime_error& error) {
    unlink(path_.c_str());
    throw ConfigError(error.what());
  }
  thread_ = std::thread([this] { run(); });
}

EventLog::~EventLog() {
  try {
    close();
  } catch (const std::runtime_error&) {
    return;  // who wants to know calls close()
  }
}

bool EventLog::offer(std::int64_t time_us, std::string_view channel, const void* data,
                     std::int32_t size) {
  const std::scoped_lock lock(mutex_);
  if (waiting_bytes_ >= kMostWaiting_bytes || !failure_.empty()) return false;
  append(time_us, channel, data, size);
  return true;
}

void EventLog::write(std::int64_t time_us, std::string_view channel, const void* data,
                     std::int32_t size) {
  std::unique_lock lock(mutex_);
  emptied_.wait(lock, [this] { return has_room(); });
  if (!failure_.empty()) throw std::runtime_error(failure_);
  append(time_us, channel, data, size);
}

void EventLog::append(std::int64_t time_us, std::string_view channel, const void* data,
                      std::int32_t size) {
  if (blocks_.empty() || blocks_.back().size() >= kBlockBytes) {
    blocks_.emplace_back().reserve(kBlockBytes + (4U << 10U));
  }
  std::array<std::uint8_t, kHeaderBytes> header{};
  std::uint8_t* to = header.data();
  put(to, kSyncWord, 4);
  put(to, static_cast<std::uint64_t>(events_++), 8);
  put(to, static_cast<std::uint64_t>(time_us), 8);
  put(to, channel.size(), 4);
  put(to, static_cast<std::uint64_t>(size), 4);
  Block& block = blocks_.back();
  const auto* bytes = static_cast<const std::uint8_t*>(data);
  block.insert(block.end(), header.begin(), header.end());
  block.insert(block.end(), channel.begin(), channel.end());
  block.insert(block.end(), bytes, bytes + size);
  const std::size_t bytes_taken = kHeaderBytes + channel.size() + static_cast<std::size_t>(size);
  waiting_bytes_ += bytes_taken;
  taken_bytes_ += static_cast<std::int64_t>(bytes_taken);
  if (block.size() >= kBlockBytes) filled_.notify_one();
}

std::int64_t EventLog::hurry() {
  const std::scoped_lock lock(mutex_);
  hurried_bytes_ = taken_bytes_;
  filled_.notify_one();
  return hurried_bytes_;
}

bool EventLog::stored(std::int64_t number) const {
  const std::scoped_lock lock(mutex_);
  return stored_bytes_ >= number;
}

void EventLog::close() {
  {
    const std::scoped_lock lock(mutex_);
    ends_ = true;
  }
  filled_.notify_one();
  if (thread_.joinable()) thread_.join();
  const std::string told = failure();
  if (!told.empty()) throw std::runtime_error(told);
}

std::string EventLog::failure() const {
  const std::scoped_lock lock(mutex_);
  return failure_;
}

std::int64_t EventLog::bytes_on_disk() const {
  const std::scoped_lock lock(mutex_);
  return bytes_on_disk_;
}

void EventLog::run() {
  Compressor frame_of;
  std::unique_lock lock(mutex_);
  const auto full = [this] { return !blocks_.empty() && blocks_.front().size() >= kBlockBytes; };
  while (failure_.empty()) {
    filled_.wait_for(lock, kOldestBlock,
                     [&] { return ends_ || stored_bytes_ < hurried_bytes_ || full(); });
    if (blocks_.empty()) {
      if (ends_) break;
      continue;
    }
    const Block block = std::move(blocks_.front());
    blocks_.pop_front();
    lock.unlock();
    std::string failure;
    try {
      store(compressed_ ? frame_of(block) : block, block.size());
    } catch (const std::runtime_error& error) {
      failure = error.what();
    }
    lock.lock();
    waiting_bytes_ -= block.size();
    failure_ = failure;
    emptied_.notify_all();
  }
  lock.unlock();
  sync();
}

void EventLog::store(const Block& block, std::size_t taken_bytes) {
  check_free_space();
  for (std::size_t written = 0; written < block.size();) {
    const ssize_t size = ::write(file_.get(), block.data() + written, block.size() - written);
    if (size < 0 && errno == EINTR) continue;
    if (size <= 0)
      throw std::runtime_error(path_ + ": write failed: " + reason() + "; is the disk full?");
    written += static_cast<std::size_t>(size);
  }
  {
    const std::scoped_lock lock(mutex_);
    bytes_on_disk_ += static_cast<std::int64_t>(block.size());
    stored_bytes_ += static_cast<std::int64_t>(taken_bytes);
  }
  if (std::chrono::steady_clock::now() - synced_ > kBetweenSyncs) sync();
}

void EventLog::check_free_space() const {
  struct stat status {};
  struct statvfs disk {};
  if (fstat(file_.get(), &status) != 0 || !S_ISREG(status.st_mode)) return;  // a device, a pipe
  if (fstatvfs(file_.get(), &disk) != 0) return;
  const std::int64_t free_bytes =
      static_cast<std::int64_t>(disk.f_bavail) * static_cast<std::int64_t>(disk.f_frsize);
  if (free_bytes >= least_free_bytes_) return;
  throw std::runtime_error(fmt::format(
      "{}: {} MB are free on its disk, {} MB have to stay free: recording ends here; make "
      "room, or record to another disk",
      path_, free_bytes / 1'000'000, least_free_bytes_ / 1'000'000));
}

void EventLog::sync() {
  fdatasync(file_.get());  // what a device refuses here, such as a pipe, it needs not
  synced_ = std::chrono::steady_clock::now();
}

}  // namespace limber
