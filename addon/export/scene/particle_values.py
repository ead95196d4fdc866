# SPDX-License-Identifier: GPL-3.0-or-later
"""What Particle Info asks of the particles that instances stand for.

Four numbers by a key, as of `instance_values`.  What no particle makes, and children of particles, have zeros, as in
Cycles.
"""

import numpy as np

# Outputs of the node.
PARTICLE_KEYS = {
    "Index": "PARTICLE",
    "Random": "PARTICLE",
    "Age": "PARTICLE",
    "Lifetime": "PARTICLE",
    "Size": "PARTICLE",
    "Location": "PARTICLE LOCATION",
    "Velocity": "PARTICLE VELOCITY",
    "Angular Velocity": "PARTICLE ANGULAR VELOCITY",
}
_VECTORS = {
    "PARTICLE LOCATION": "location",
    "PARTICLE VELOCITY": "velocity",
    "PARTICLE ANGULAR VELOCITY": "angular_velocity",
}


def particle_values(prototype, key, frame):
    """[systems of what instances it] of float32 [particles, 4]; None where it has none.

    Args:
        prototype: living InstancePrototype.
        key: of PARTICLE_KEYS: PARTICLE is index, age and lifetime in frames, size.
        frame: whole and part, of the depsgraph.
    """
    parent = prototype.parent
    if parent is None or not len(parent.particle_systems):
        return None
    return [_read(system.particles, key, frame) for system in parent.particle_systems]


def _read(particles, key, frame):
    count = len(particles)

    def column(name, width=1):
        values = np.empty(count * width, dtype=np.float32)
        particles.foreach_get(name, values)
        return values.reshape(count, width)

    if key in _VECTORS:
        return np.hstack([column(_VECTORS[key], 3), np.ones((count, 1), dtype=np.float32)])
    index = np.arange(count, dtype=np.float32)[:, None]
    age = np.float32(frame) - column("birth_time")
    return np.hstack([index, age, column("lifetime"), column("size")])
