// SPDX-License-Identifier: GPL-3.0-or-later
// Exceptions of the library.  Nothing below native/python exits, aborts or prints: it throws one of
// these and python/errors.cpp translates it once.
#pragma once

#include <stdexcept>
#include <string>

namespace granita {

class Error : public std::runtime_error {
  public:
    using std::runtime_error::runtime_error;
};

/// The scene is at fault.  `datablock` is Blender's name of the thing to look at, e.g. "mesh
/// 'Cube'".
class SceneError : public Error {
  public:
    SceneError(std::string datablock, const std::string& message)
        : Error(datablock + ": " + message), m_datablock(std::move(datablock)) {}
    const std::string& datablock() const { return m_datablock; }

  private:
    std::string m_datablock;
};

/// The library is at fault: a broken invariant (see check.h).
class InternalError : public Error {
  public:
    using Error::Error;
};

/// OpenGL or EGL is at fault or absent.
class GlError : public Error {
  public:
    using Error::Error;
};

/// The artist asked to stop.  Not a failure.
class Cancelled : public Error {
  public:
    Cancelled() : Error("cancelled") {}
};

}  // namespace granita
