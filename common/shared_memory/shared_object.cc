#include "common/shared_memory/shared_object.h"

#include <fcntl.h>
#include <grp.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <optional>

#include "common/config_error.h"

namespace limber {
namespace {

[[noreturn]] void refuse_place(const SharedPlace& place, const std::string& problem) {
  throw ConfigError(place.what + ": " + problem);
}
[[noreturn]] void refuse_object(const SharedPlace& place, const std::string& problem) {
  refuse_place(place, place.path + " " + problem +
                          "; use another name, or remove it while nobody has it: rm " + place.path);
}

/// Of the place's group; nothing without one.
std::optional<gid_t> group_of(const SharedPlace& place) {
  if (place.group.empty()) return std::nullopt;
  const group* found = getgrnam(place.group.c_str());
  if (found == nullptr) refuse_place(place, "there is no group '" + place.group + "'");
  return found->gr_gid;
}

/// Has its name when it has its size, its group and its permissions: nobody sees it without them.
void make_object(const SharedPlace& place, std::size_t bytes, std::optional<gid_t> group) {
  const FileDescriptor file(open("/dev/shm", O_TMPFILE | O_RDWR | O_CLOEXEC, 0600));
  const std::string link = "/proc/self/fd/" + std::to_string(file.get());
  if (file.get() < 0 || ftruncate(file.get(), static_cast<off_t>(bytes)) != 0 ||
      (group && fchown(file.get(), static_cast<uid_t>(-1), *group) != 0) ||
      fchmod(file.get(), group ? 0660 : 0600) != 0 ||
      (linkat(AT_FDCWD, link.c_str(), AT_FDCWD, place.path.c_str(), AT_SYMLINK_FOLLOW) != 0 &&
       errno != EEXIST))
    refuse_place(place, "cannot make " + place.path + ": " + std::strerror(errno));
}

constexpr int kHow = O_RDWR | O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC;

FileDescriptor open_object(const SharedPlace& place, std::size_t bytes,
                           std::optional<gid_t> group) {
  FileDescriptor file(open(place.path.c_str(), kHow));
  if (file.get() < 0 && errno == ENOENT) {
    make_object(place, bytes, group);
    file = FileDescriptor(open(place.path.c_str(), kHow));
  }
  if (file.get() < 0)
    refuse_object(place, std::string("cannot be opened: ") + std::strerror(errno));
  return file;
}

struct stat check_owner(const SharedPlace& place, int file, std::optional<gid_t> group) {
  struct stat details {};
  if (fstat(file, &details) != 0)
    refuse_object(place, std::string("cannot be examined: ") + std::strerror(errno));
  const bool of_group = group && details.st_gid == *group;
  if (details.st_uid != geteuid() && details.st_uid != 0 && !of_group)
    refuse_object(place, "belongs to user " + std::to_string(details.st_uid));
  if ((details.st_mode & S_IWOTH) != 0 || ((details.st_mode & S_IWGRP) != 0 && !of_group))
    refuse_object(place, "is writable for others, who could move the arm");
  return details;
}

}  // namespace

SharedObject::SharedObject(const SharedPlace& place, std::size_t bytes) : bytes_(bytes) {
  const std::optional<gid_t> group = group_of(place);
  file_ = open_object(place, bytes, group);
  const struct stat details = check_owner(place, file_.get(), group);
  if (!S_ISREG(details.st_mode)) refuse_object(place, "is no shared memory");
  if (details.st_size != static_cast<off_t>(bytes))
    refuse_object(place, "was made by another version of limber");
  memory_ = mmap(nullptr, bytes, PROT_READ | PROT_WRITE, MAP_SHARED | MAP_POPULATE, file_.get(), 0);
  if (memory_ == MAP_FAILED)
    refuse_object(place, std::string("cannot be mapped: ") + std::strerror(errno));
}

SharedObject::~SharedObject() { munmap(memory_, bytes_); }

// A lock on one byte for each end. Unlike RunLock's names it is the object's, not the network's.
bool SharedObject::take(int end) const {
  struct flock lock {};
  lock.l_type = F_WRLCK;
  lock.l_whence = SEEK_SET;
  lock.l_start = end;
  lock.l_len = 1;
  return fcntl(file_.get(), F_OFD_SETLK, &lock) == 0;
}

FileDescriptor open_shared_fifo(const SharedPlace& place) {
  if (mkfifo(place.path.c_str(), 0600) != 0 && errno != EEXIST)
    refuse_place(place, "cannot make " + place.path + ": " + std::strerror(errno));
  FileDescriptor fifo(open(place.path.c_str(), kHow));
  if (fifo.get() < 0)
    refuse_object(place, std::string("cannot be opened: ") + std::strerror(errno));
  if (!S_ISFIFO(check_owner(place, fifo.get(), std::nullopt).st_mode))
    refuse_object(place, "is no FIFO");
  return fifo;
}

}  // namespace limber
