// SPDX-License-Identifier: MIT
#pragma once

#include "mdhcal/port/flash.hpp"

namespace mdhcal {

/// A region of flash in a file, for controllers that run an operating system. Plain data; one owner.
struct PosixFlash {
  Flash flash = {};     ///< what the store is given; its context points at this object, which must stay where it is
  int descriptor = -1;  ///< -1 while closed
};

/// Opens a file as a flash of `geometry`. A file that is not there is made erased, beside its name, and gets the
/// name when it is whole and on the disk, so that no cut leaves a short one. Every program and erase returns after the data is on the
/// disk. An exclusive lock keeps a second process out. Returns ok, flash_geometry (unusable, or the file has another
/// size), flash_read (cannot be opened or locked) or flash_program (cannot be made).
Status open_posix_flash(const char* path, const FlashGeometry& geometry, PosixFlash& out) noexcept;

/// Closes the file. Nothing happens on a closed one.
void close_posix_flash(PosixFlash& open) noexcept;

}  // namespace mdhcal
