// SPDX-License-Identifier: MIT
// What GoogleTest calls and newlib on bare metal lacks. Every path is said to be a directory, so that GoogleTest does not
// try to create the parents of an XML file without end.
#include <sys/stat.h>

int mkdir(const char* path, mode_t mode) {
  (void)path;
  (void)mode;
  return 0;
}

int stat(const char* path, struct stat* result) {
  (void)path;
  result->st_mode = S_IFDIR;
  return 0;
}
