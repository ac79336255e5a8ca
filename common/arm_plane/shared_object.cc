#include "common/arm_plane/shared_object.h"

#include <fcntl.h>
#include <grp.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <optional>
#include <sstream>

#include "common/config_error.h"
#include "common/local_address.h"

namespace limber {
namespace {

[[noreturn]] void refuse_memory(const std::string& name, const std::string& problem) {
  throw ConfigError("arm plane shm:" + name + ": " + problem);
}
[[noreturn]] void refuse_object(const SharedMemoryAddress& address, const std::string& problem) {
  refuse_memory(address.name, address.path() + " " + problem +
                                  "; use another name, or remove it while nobody has it: rm " +
                                  address.path());
}

/// Of the address's group; nothing without one.
std::optional<gid_t> group_of(const SharedMemoryAddress& address) {
  if (address.group.empty()) return std::nullopt;
  const group* found = getgrnam(address.group.c_str());
  if (found == nullptr) refuse_memory(address.name, "there is no group '" + address.group + "'");
  return found->gr_gid;
}

/// Has its name when it has its size, its group and its permissions: nobody sees it without them.
void make_object(const SharedMemoryAddress& address, std::optional<gid_t> group) {
  const FileDescriptor file(open("/dev/shm", O_TMPFILE | O_RDWR | O_CLOEXEC, 0600));
  const std::string link = "/proc/self/fd/" + std::to_string(file.get());
  if (file.get() < 0 || ftruncate(file.get(), sizeof(SharedMemory)) != 0 ||
      (group && fchown(file.get(), static_cast<uid_t>(-1), *group) != 0) ||
      fchmod(file.get(), group ? 0660 : 0600) != 0 ||
      (linkat(AT_FDCWD, link.c_str(), AT_FDCWD, address.path().c_str(), AT_SYMLINK_FOLLOW) != 0 &&
       errno != EEXIST))
    refuse_memory(address.name, "cannot make " + address.path() + ": " + std::strerror(errno));
}

FileDescriptor open_object(const SharedMemoryAddress& address, std::optional<gid_t> group) {
  constexpr int kHow = O_RDWR | O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC;
  FileDescriptor file(open(address.path().c_str(), kHow));
  if (file.get() < 0 && errno == ENOENT) {
    make_object(address, group);
    file = FileDescriptor(open(address.path().c_str(), kHow));
  }
  if (file.get() < 0)
    refuse_object(address, std::string("cannot be opened: ") + std::strerror(errno));
  return file;
}

void check_object(const SharedMemoryAddress& address, int file, std::optional<gid_t> group) {
  struct stat details {};
  if (fstat(file, &details) != 0 || !S_ISREG(details.st_mode))
    refuse_object(address, "is no shared memory");
  const bool of_group = group && details.st_gid == *group;
  if (details.st_uid != geteuid() && details.st_uid != 0 && !of_group)
    refuse_object(address, "belongs to user " + std::to_string(details.st_uid));
  if ((details.st_mode & S_IWOTH) != 0 || ((details.st_mode & S_IWGRP) != 0 && !of_group))
    refuse_object(address, "is writable for others, who could move the arm");
  if (details.st_size != sizeof(SharedMemory))
    refuse_object(address, "was made by another version of limber");
}

const char* name_of(ArmPlaneEnd end) {
  return end == ArmPlaneEnd::kDriver ? "driver" : "controller";
}

}  // namespace

SharedMemoryAddress parse_shared_memory_address(const std::string& url) {
  const auto is_allowed = [](unsigned char c) {
    return std::isalnum(c) != 0 || c == '-' || c == '_';
  };
  const auto question = std::min(url.find('?'), url.size());
  SharedMemoryAddress address;
  address.name = url.substr(kSharedMemoryScheme.size(), question - kSharedMemoryScheme.size());
  if (address.name.empty() || address.name.size() > 64 ||
      !std::all_of(address.name.begin(), address.name.end(), is_allowed))
    refuse_memory(address.name,
                  "a name has 1 to 64 letters, digits, '-' and '_', as in shm:openarm");
  constexpr std::string_view kGroup = "group=";
  std::istringstream options(url.substr(std::min(question + 1, url.size())));
  for (std::string option; std::getline(options, option, '&');) {
    if (option == "poll") {
      address.poll = true;
    } else if (option.starts_with(kGroup) && option.size() > kGroup.size()) {
      address.group = option.substr(kGroup.size());
    } else {
      refuse_memory(address.name, "option '" + option + "' is not known; poll and group=GROUP are");
    }
  }
  return address;
}

SharedObject::SharedObject(const SharedMemoryAddress& address, ArmPlaneEnd end) {
  const std::optional<gid_t> group = group_of(address);
  file_ = open_object(address, group);
  check_object(address, file_.get(), group);
  void* memory = mmap(nullptr, sizeof(SharedMemory), PROT_READ | PROT_WRITE,
                      MAP_SHARED | MAP_POPULATE, file_.get(), 0);
  if (memory == MAP_FAILED)
    refuse_object(address, std::string("cannot be mapped: ") + std::strerror(errno));
  memory_ = static_cast<SharedMemory*>(memory);
  // A lock on one byte for each end. Unlike RunLock's names it is the object's, not the network's.
  const auto number = static_cast<std::size_t>(end);
  flock lock{};
  lock.l_type = F_WRLCK;
  lock.l_whence = SEEK_SET;
  lock.l_start = static_cast<off_t>(number);
  lock.l_len = 1;
  std::atomic<std::uint32_t>& holder = memory_->holders[number];
  if (fcntl(file_.get(), F_OFD_SETLK, &lock) != 0) {
    const std::string process = std::to_string(holder.load());
    munmap(memory_, sizeof(SharedMemory));
    throw ConfigError(std::string("there is already a ") + name_of(end) +
                      " at shm:" + address.name + " on this machine (process " + process +
                      "); stop it first, or give this one a name of its own");
  }
  holder.store(static_cast<std::uint32_t>(getpid()));
}

SharedObject::~SharedObject() { munmap(memory_, sizeof(SharedMemory)); }

}  // namespace limber
