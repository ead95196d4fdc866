// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

namespace granita {

/// What a ray is traced for: materials and worlds tell it by the node Light Path.  Light of the
/// world is asked for by the lobe that reflects it, Singular by mirrors.
enum class RayType { Camera, Shadow, Diffuse, Glossy, Singular };

}  // namespace granita
